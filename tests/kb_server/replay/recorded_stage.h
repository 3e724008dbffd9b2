// A server's life at random, recorded: robots, workflows, operators, times, other documents, kills and restarts. Made of the parts of
// the simulation of robots (tests/kb_server/turn). Each seed makes the same life.
#ifndef DOCENT_TESTS_KB_SERVER_REPLAY_RECORDED_STAGE_H_
#define DOCENT_TESTS_KB_SERVER_REPLAY_RECORDED_STAGE_H_

#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/log/record_codec.h"
#include "graph/rdf/docent_iris.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "kb_server/robots/reservations.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/recovery.h"
#include "kb_server/writer/server_state.h"
#include "tests/kb_server/replay/stage_documents.h"
#include "tests/kb_server/turn/random_documents.h"
#include "tests/kb_server/turn/robot_simulation.h"
#include "tests/kb_server/turn/simulated_world.h"
#include "tests/kb_server/writer_node.h"

namespace docent::server::test {

// A log that keeps snapshots, too.
class SnapshotLog final : public FakeLog {
 public:
  absl::Status SnapshotPut(uint64_t offset, std::string_view data) override {
    snapshots_[offset] = std::string(data);
    return absl::OkStatus();
  }
  absl::StatusOr<std::optional<log::LogSnapshot>> SnapshotGet(uint64_t at_most) override {
    const auto after = snapshots_.upper_bound(at_most);
    if (after == snapshots_.begin()) return std::nullopt;
    return log::LogSnapshot{std::prev(after)->first, std::prev(after)->second};
  }
  absl::StatusOr<std::vector<uint64_t>> SnapshotOffsets() override {
    std::vector<uint64_t> offsets;
    for (const auto& [offset, data] : snapshots_) offsets.push_back(offset);
    return offsets;
  }

 private:
  std::map<uint64_t, std::string> snapshots_;
};

class RecordedStage {
 public:
  static constexpr int kSteps = 70;

  RecordedStage(uint32_t seed, bool tells)
      : tells_(tells), dice_(seed), fleet_(&dice_), documents_(&dice_), postman_(&dice_) {
    Restore();
  }

  void Play() {
    Begin(fleet_.Joins());
    Begin(WorldFacts());
    Turn(documents_.Services());
    for (int number : {2, 1, 0}) Turn(documents_.Workflow(number));  // some of them are refused
    for (const std::string& text : StageWorkflows()) Begin(Put(Document::Kind::kCawl, "x.cawl.xml", text));
    for (int i = 0; i < kSteps && !::testing::Test::HasFailure(); ++i) {
      dice_.Begin(static_cast<uint32_t>(i) + 1);
      if (!dice_.Plays(i)) continue;
      Note(absl::StrCat("step ", i));
      const bool down = dice_.OneIn(12, "down");
      now_us_ += dice_.Below(2500) * TimeMicros{1000};
      if (dice_.OneIn(10, "snapshot")) Snapshot();
      if (down) {
        now_us_ += dice_.Below(40'000) * TimeMicros{1000};
        Restore();
      }
      Deliver();
      Turn(Anything());
      LookAtClock();
    }
  }

  SnapshotLog* log() { return &log_; }
  const Dictionary& dictionary() const { return *dictionary_; }
  const sparql::FunctionRegistry& functions() const { return functions_; }
  GraphVersionPtr Newest() { return stages_->writer.Freeze(Revision(log_.size())); }
  // Runs of workflows that are nested in none, and of which the graph still knows.
  std::vector<RunId> Runs() {
    const GraphVersionPtr version = Newest();
    const GraphReader graph(*dictionary_, *version);
    std::vector<RunId> runs;
    for (const std::string& run : graph.Subjects(kRdfType, Term::Iri(DocentIri("Run")))) {
      const std::string workflow = graph.Object(run, DocentIri("workflow"));
      const bool of_service = workflow.empty() || workflow.starts_with("service ");
      if (!of_service && graph.Object(run, DocentIri("parentRun")).empty()) runs.push_back(*RunOfIri(run));
    }
    return runs;
  }
  Dice* dice() { return &dice_; }

 private:
  void Note(const std::string& text) const {
    if (tells_) std::cout << log_.size() << "  " << now_us_ << "  " << text << "\n";
  }
  template <typename Items>
  const auto& OneOf(const Items& items) {
    return items[static_cast<size_t>(dice_.Below(static_cast<int>(items.size())))];
  }

  // The process is killed, and begins again from what the log has.
  void Restore() {
    Note("begins");
    auto dictionary = std::make_unique<Dictionary>();
    auto state = FindStart(&log_, log_.size(), dictionary.get(), &functions_, limits_);
    ASSERT_TRUE(state.ok()) << state.status();
    const absl::Status replayed = ReplayTurns(&log_, state->offset + 1, log_.size(), state->stages.get(),
                                              [](const TurnResult&, size_t) { return absl::OkStatus(); });
    ASSERT_TRUE(replayed.ok()) << replayed;
    stages_ = std::move(state->stages);
    stages_->freezes = false;
    stages_->cancellation = &cancellation_;
    dictionary_ = std::move(dictionary);
  }
  void Snapshot() {
    const auto bytes = EncodeState(TakeState(*stages_, RequestMemory(0), Newest(), now_us_), *dictionary_);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    ASSERT_TRUE(log_.SnapshotPut(log_.size(), *bytes).ok());
  }

  void Begin(WriteBatch batch) {
    const uint64_t before = log_.size();
    Turn(std::move(batch));
    EXPECT_EQ(log_.size(), before + 1) << refused_;
  }
  void Turn(WriteBatch batch) {
    if (batch.OperationCount() == 0 && !batch.clock_tick) return;
    batch.time_us = now_us_;
    std::string bytes;
    const auto result = RunTurn(stages_.get(), std::move(batch), log_.size() + 1, &bytes);
    if (!result.ok()) {  // what is asked of something that is gone meanwhile
      refused_ = std::string(result.status().message());
      return Note(absl::StrCat("refused: ", refused_));
    }
    ASSERT_TRUE(log_.Append({bytes}, 1, log_.size()).ok());
    for (const Transition& t : result->record.transitions)
      Note(absl::StrCat(t.subject, "  ", t.from, " → ", t.to, "  ", t.cause));
    for (const RobotCommand& command : result->record.commands) {
      Note(absl::StrCat("command ", command.id.value(), " ", command.operation, " on ",
                        command.robot.value()));
      if (!dice_.OneIn(25, "lost")) fleet_.Send(command, now_us_);
    }
    for (const CommandId& id : result->cancels) fleet_.Cancel(id, now_us_);
    for (const CommandId& id : result->recalls) fleet_.Recall(id);
    for (const Notification& notification : result->notifications) postman_.Send(notification, now_us_);
  }

  void Deliver() {
    for (std::vector<CommandReport> reports : {fleet_.Reports(now_us_), postman_.Reports(now_us_)}) {
      WriteBatch batch;
      batch.reports = std::move(reports);
      Turn(std::move(batch));
    }
    const std::optional<TimeMicros> due = stages_->NextDeadline();
    if (!due || *due > now_us_) return;
    WriteBatch tick;
    tick.clock_tick = true;
    Turn(std::move(tick));
  }
  void LookAtClock() {
    for (int looks = 0; looks < 5; ++looks) {
      WriteBatch told = ClockTells(now_us_, *dictionary_, *Newest());
      if (told.operations.empty()) return;
      Turn(std::move(told));
    }
  }

  WriteBatch Anything() {
    switch (dice_.Below(20)) {
      case 0:
      case 1:
      case 2:
        if (stages_->engine.live_runs() > 15) return {};
        return Start(absl::StrCat("W", dice_.Below(kSimulatedWorkflows)), Arguments());
      case 3:
      case 4:
        return Start(OneOf(StageWorkflowNames()));
      case 5:
        return Invoke();
      case 6:
      case 7:
        return dice_.OneIn(1, "steering") ? Steering() : WriteBatch();
      case 8:
        return dice_.OneIn(1, "documents") ? Documents() : WriteBatch();
      case 9:
        return dice_.OneIn(1, "rules") ? Rules() : WriteBatch();
      case 10:
        return dice_.OneIn(1, "reserve") ? Reserve() : WriteBatch();
      case 11:
      case 12:
        return dice_.OneIn(1, "robot") ? Robot() : WriteBatch();
      case 13:
        return dice_.OneIn(1, "event") ? Ring() : WriteBatch();
      case 14:
        return dice_.OneIn(1, "reading") ? Reading("tag-17") : WriteBatch();
      default:
        return Told();
    }
  }

  std::vector<std::pair<std::string, Term>> Arguments() {
    std::vector<std::pair<std::string, Term>> arguments;
    if (dice_.OneIn(2)) arguments.emplace_back("target", Iri(dice_.OneIn(3) ? "Nothing" : "Thing"));
    if (dice_.OneIn(4)) arguments.emplace_back("count", Term::Integer(dice_.Below(5)));
    return arguments;
  }
  WriteBatch Invoke() {
    WriteBatch batch;
    batch.run_requests.push_back(
        {RunRequest::Kind::kInvokeService, absl::StrCat("service", dice_.Below(2)), Arguments()});
    return batch;
  }

  // Facts of clients: of several sources, for a while or for good, told, told again or withdrawn.
  WriteBatch Told() {
    const int kind = dice_.Below(4);
    TermQuad fact = kind == 0   ? Fact("Door", "is", dice_.OneIn(2) ? "Open" : "Shut")  // a state property
                    : kind == 1 ? Fact("Job", "is", "Ready")
                    : kind == 2 ? Fact("Way", "blocked", Term::Boolean(true))
                                : Fact(absl::StrCat("P", dice_.Below(3)),
                                       absl::StrCat("wants", dice_.Below(kSimulatedWords)), "Thing");
    WriteBatch batch = dice_.OneIn(3) ? Tell({}, {fact}) : Tell({fact});
    if (dice_.OneIn(3, "source")) batch.source = absl::StrCat("urn:w:Source", dice_.Below(2));
    if (dice_.OneIn(4, "lifetime")) batch.lifetime_ms = 500 + static_cast<uint64_t>(dice_.Below(9000));
    if (dice_.OneIn(6, "load")) batch.mode = WriteBatch::Mode::kLoad;
    if (batch.mode == WriteBatch::Mode::kLoad) batch.lifetime_ms = 0;
    return batch;
  }
  WriteBatch Ring() {
    const Term event = dice_.OneIn(2) ? Term::Blank("b1") : Iri("bell");
    return Tell({{event, Iri("a"), Iri("docent:Event"), Term()},
                 {event, Iri("docent:operation"),
                  Term::Literal(absl::StrCat("ring", dice_.Below(kSimulatedWorkflows))), Term()}});
  }
  WriteBatch Robot() {
    const int robot = dice_.Below(SimulatedRobots());
    const std::string name = Fleet::Robot(robot);
    static constexpr const char* kStatuses[] = {"Standby", "Standby", "Busy", "Charging", "Offline"};
    switch (dice_.Below(4)) {
      case 0:
        if (!dice_.OneIn(2, "die")) return WriteBatch();
        if (!fleet_.IsGone(robot)) fleet_.Die(robot, now_us_);
        return fleet_.Join(robot, now_us_);
      case 1: {
        const TermQuad out = Fact(name, "docent:outOfService", Term::Literal("a wheel"));
        if (!dice_.OneIn(2)) return Tell({}, {out});
        WriteBatch batch = Tell({out});
        if (!dice_.OneIn(2)) return batch;
        RunRequest cancel;
        cancel.kind = RunRequest::Kind::kCancelCommands;
        cancel.target = Name(name);
        batch.run_requests.push_back(std::move(cancel));
        return batch;
      }
      default:
        return Tell({Fact(name, "docent:status", absl::StrCat("docent:", kStatuses[dice_.Below(5)]))});
    }
  }

  std::vector<std::string> Live() {
    const GraphVersionPtr version = Newest();
    std::vector<std::string> live;
    for (const std::string& run :
         GraphReader(*dictionary_, *version).Subjects(DocentIri("runState"), Term::Literal("running")))
      live.push_back(RunOfIri(run)->value());
    return live;
  }
  WriteBatch Steering() {
    using Kind = RunRequest::Kind;
    WriteBatch batch;
    RunRequest request;
    request.cancels_commands = dice_.OneIn(2);
    const std::vector<std::string> live = Live();
    if (!live.empty()) request.target = OneOf(live);
    switch (dice_.Below(8)) {
      case 0:
        request.kind = Kind::kPause;
        break;
      case 1:
      case 2:
        request.kind = Kind::kResume;
        break;
      case 3:
        request.kind = dice_.OneIn(2) ? Kind::kPauseWorkflow : Kind::kResumeWorkflow;
        request.target = absl::StrCat("W", dice_.Below(kSimulatedWorkflows));
        break;
      case 4:
        request.kind = Kind::kSetVariable;
        request.arguments = Arguments();
        break;
      case 5:
        request.kind = Kind::kCancel;
        request.compensates = dice_.OneIn(2);
        break;
      default: {
        const GraphVersionPtr version = Newest();
        const GraphReader graph(*dictionary_, *version);
        const std::vector<std::string> incidents =
            graph.Subjects(DocentIri("nodeState"), Term::Literal("incident"));
        if (incidents.empty()) return batch;
        const std::string& node = OneOf(incidents);
        request.target = RunOfIri(graph.Object(node, DocentIri("ofRun")))->value();
        request.node = graph.Object(node, DocentIri("nodeName"));
        static constexpr Kind kHow[] = {Kind::kRetryNode, Kind::kRetryNode, Kind::kSkipNode, Kind::kFailNode};
        request.kind = kHow[dice_.Below(4)];
      }
    }
    if (!request.target.empty()) batch.run_requests.push_back(std::move(request));
    return batch;
  }

  WriteBatch Reserve() {
    WriteBatch batch;
    const GraphVersionPtr version = Newest();
    ReservationRequest request;
    request.robots.push_back(Name(Fleet::Robot(dice_.Below(SimulatedRobots()))));
    request.priority = dice_.Below(4) - 1;
    request.lasting_ms = 1000 + static_cast<uint64_t>(dice_.Below(15000));
    const std::vector<std::string> live = Live();
    if (!live.empty() && dice_.OneIn(2)) request.kept_for = OneOf(live);
    engine::Reservation made;
    const absl::Status may = MakeReservation(request, *dictionary_, *version, now_us_, &batch, &made);
    return may.ok() ? batch : WriteBatch();
  }

  WriteBatch Documents() {
    const int number = dice_.Below(kSimulatedWorkflows);
    WriteBatch batch;
    static constexpr const char* kHow[] = {"", kRemovesRuns, kRemovesStarts, kRemovesDisablement,
                                           kRemovesDisablement};
    switch (dice_.Below(4)) {
      case 0:
        return documents_.Again(number);
      case 1:
        return dice_.OneIn(1, "edit") ? documents_.Workflow(number) : WriteBatch();
      case 2:
        batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove,
                                   OneOf(StageWorkflowNames()), kHow[dice_.Below(5)]});
        return batch;
      default:
        batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove,
                                   absl::StrCat("W", number), kHow[dice_.Below(5)]});
        return batch;
    }
  }
  // Who is at the place of a thing wants it; and what of that is a rule of today.
  WriteBatch Rules() {
    if (dice_.OneIn(3)) {
      WriteBatch batch;
      batch.documents.push_back({Document::Kind::kRules, Document::Action::kRemove, "wants", ""});
      return batch;
    }
    WriteBatch batch =
        Put(Document::Kind::kRules, "wants",
            absl::StrCat("PREFIX w: <urn:w:>\nRULE { ?who w:wants", dice_.Below(kSimulatedWords),
                         " w:Thing } WHERE { ?who w:wants", dice_.Below(kSimulatedWords), " ?what }\n"));
    return batch;
  }
  static WriteBatch WorldFacts() {
    WriteBatch batch = test::WorldFacts();
    batch.request_id.clear();
    std::erase_if(batch.operations, [](const QuadOperation& operation) {
      return operation.quad.subject == Iri("R1");  // one of the fleet
    });
    batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("is", "a", "docent:StateProperty")});
    return batch;
  }

  const bool tells_;
  const Limits limits_;
  Dice dice_;
  Fleet fleet_;
  RandomDocuments documents_;
  Postman postman_;
  SnapshotLog log_;
  sparql::FunctionRegistry functions_;
  Cancellation cancellation_;
  std::unique_ptr<Dictionary> dictionary_;
  std::unique_ptr<Stages> stages_;
  std::string refused_;
  TimeMicros now_us_ = 1'700'000'000'000'000;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_REPLAY_RECORDED_STAGE_H_
