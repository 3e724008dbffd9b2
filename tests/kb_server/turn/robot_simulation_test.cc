// Plays the simulation of robot_simulation.h and checks after every turn what an operator relies on:
//   - no two commands under way occupy the same part of a robot, and all of a robot are of the run that holds it;
//   - no attempt begins before the end of the one before it is known, and no time of a node either;
//   - a robot is free exactly when its last holder and all of its commands have ended;
//   - no command goes to a robot that takes none or is out of service, or whose node's condition did not hold at its
//     guard_revision, or of a run that is paused;
//   - no node goes on when what has to hold while it runs has fallen since it began something;
//   - each command, also one that is sent again, is meant for the adapter that the graph has when it is decided;
//   - no command goes to a robot that is reserved for others, unless its run is of a higher priority or held a robot of the
//     reservation before; what waits for a reserved robot goes on when the reservation has ended;
//   - who asks for a class of operations gets one of this class;
//   - every live run waits for a thing that Workflows.Explain names;
//   - an activator fires once for each event and each occurrence of its time, and not without one;
//   - what was told for as long as a run lives is gone when it has ended; a variable has only values of its type;
//   - no command begins at its robot when its time is over, its run has ended or is paused, it was cancelled, or the robot takes
//     none any more; each cancel is heard, also where the robot was out of reach and the server began again in between;
//   - a notification is decided once, and kept until its answer comes;
//   - what a run says that it has undone is undone, also what a robot did after it was to stop;
//   - the log, replayed, comes to the same decisions and the same graph, whatever restarts there were.
// DOCENT_SIMULATION_SEEDS=10000 plays more seeds, from DOCENT_SIMULATION_FIRST on; DOCENT_SIMULATION_SEED=17 plays one, and
// tells its course. simulation_dice.h says how to leave parts of it out; `scripts/soak simulation` does that to a failing one.
#include <algorithm>
#include <array>
#include <iostream>
#include <iterator>
#include <memory>
#include <tuple>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "graph/rdf/docent_iris.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/run_waits.h"
#include "kb_server/robots/reservations.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/server_state.h"
#include "tests/kb_server/random_world.h"
#include "tests/kb_server/turn/attempt_model.h"
#include "tests/kb_server/turn/firing_model.h"
#include "tests/kb_server/turn/random_documents.h"
#include "tests/kb_server/turn/robot_simulation.h"
#include "tests/kb_server/turn/simulated_world.h"
#include "tests/kb_server/turn/undo_model.h"

namespace docent::server {
namespace {

using test::Dice;
using test::Fact;
using test::Fleet;
using test::Iri;
using test::Tell;

bool IsFinal(CommandReport::Outcome outcome) {
  using Outcome = CommandReport::Outcome;
  return outcome == Outcome::kSucceeded || outcome == Outcome::kFailed || outcome == Outcome::kCancelled ||
         outcome == Outcome::kUnknown || outcome == Outcome::kNotBegun;
}

// run/node/iteration/invocation.attempt/step/attempt@time
struct IdParts {
  explicit IdParts(const CommandId& id) {
    const std::vector<std::string> parts = absl::StrSplit(id.value(), '/');
    run = parts[0];
    node = parts[1];
    const std::vector<std::string> invocation = absl::StrSplit(parts[3], '.');
    place = absl::StrCat(run, "/", node, "/", parts[2], "/", invocation[0]);
    attempt = invocation[1];
    step = parts[4];
  }
  std::string flow() const { return run.substr(0, run.find('-')); }
  std::string run, node, place, attempt, step;
};

class Simulation {
 public:
  Simulation(uint32_t seed, bool tells)
      : tells_(tells),
        dice_(seed),
        fleet_(&dice_),
        documents_(&dice_),
        postman_(&dice_),
        stages_(NewStages(&dictionary_)) {}

  void Play() {
    Turn(fleet_.Joins());
    Turn(documents_.Services());
    for (int number : {2, 1, 0}) Turn(documents_.Workflow(number));
    for (int i = 0; i < kSteps && !Failed(); ++i) {
      dice_.Begin(static_cast<uint32_t>(i) + 1);
      if (!dice_.Plays(i)) continue;
      Note(absl::StrCat("step ", i));
      now_us_ += dice_.Below(2500) * TimeMicros{1000};
      const bool restarts = dice_.OneIn(12, "restart");
      Deliver();
      Turn(Anything());
      if (restarts && !Failed()) Restart();
    }
    dice_.Begin(kSteps + 1);
    if (!Failed()) Drain();
    if (!Failed()) Replay();
  }

  static bool Failed() { return ::testing::Test::HasFailure(); }
  size_t commands() const { return commands_; }
  size_t preempted() const { return preempted_; }
  size_t barred() const { return barred_; }
  size_t by_class() const { return by_class_; }
  size_t fallen() const { return fallen_; }
  size_t timed_out() const { return attempts_.timed_out(); }
  size_t undone() const { return undoing_.checked(); }
  size_t not_begun() const { return not_begun_; }
  size_t reborn() const { return reborn_; }

 private:
  static constexpr int kSteps = 70;
  struct UnderWay {
    RobotCommand command;
    std::string root;
    std::set<std::string> runs;  // its own, and those that it is nested in
  };

  std::unique_ptr<Stages> NewStages(Dictionary* dictionary) {
    auto stages = std::make_unique<Stages>(dictionary, &functions_, limits_);
    stages->freezes = false;
    return stages;
  }
  GraphReader* Graph() {
    reader_.reset();
    version_ = stages_->writer.Freeze(Revision(log_.size()));
    reader_ = std::make_unique<GraphReader>(dictionary_, *version_);
    return reader_.get();
  }
  void Note(const std::string& text) const {
    if (tells_) std::cout << log_.size() << "  " << text << "\n";
  }

  void Deliver() {
    std::vector<CommandReport> reports = fleet_.Reports(now_us_);
    for (const RobotCommand& command : fleet_.TakeBegun()) CheckBegin(command);
    const size_t split =
        reports.empty() ? 0 : static_cast<size_t>(dice_.Below(static_cast<int>(reports.size())));
    for (auto part : {std::make_pair(size_t{0}, split), std::make_pair(split, reports.size())}) {
      if (part.first == part.second) continue;
      WriteBatch batch;
      batch.reports.assign(reports.begin() + static_cast<long>(part.first),
                           reports.begin() + static_cast<long>(part.second));
      Turn(std::move(batch));
    }
    if (std::vector<CommandReport> answers = postman_.Reports(now_us_); !answers.empty()) {
      WriteBatch batch;
      batch.reports = std::move(answers);
      Turn(std::move(batch));
    }
    const std::optional<TimeMicros> due = stages_->NextDeadline();
    if (due && *due <= now_us_) {
      WriteBatch tick;
      tick.clock_tick = true;
      Turn(std::move(tick));
    }
    for (int looks = 0; looks < 5 && !Failed(); ++looks) {
      Graph();
      WriteBatch told = test::ClockTells(now_us_, dictionary_, *version_);
      if (told.operations.empty()) return;
      Turn(std::move(told));
    }
    if (!Failed()) ADD_FAILURE() << "the clock always has something to tell";
  }

  WriteBatch Anything() {
    const int robot = dice_.Below(test::SimulatedRobots());
    for (int r = 0; r < test::SimulatedRobots(); ++r) {
      if (fleet_.IsGone(r) && dice_.OneIn(4)) return fleet_.Join(r, now_us_);
    }
    if (dice_.OneIn(4)) return dice_.OneIn(1, "steering") ? Steering() : WriteBatch();
    if (dice_.OneIn(10)) return dice_.OneIn(1, "reserve") ? Reservation() : WriteBatch();
    switch (dice_.Below(18)) {
      case 0:
      case 1:
      case 2:
        if (stages_->engine.live_runs() < 15)
          return test::Start(absl::StrCat("W", dice_.Below(test::kSimulatedWorkflows)), Arguments());
        return WriteBatch();
      case 3: {
        WriteBatch batch;
        if (stages_->engine.live_runs() < 15)
          batch.run_requests.push_back(
              {RunRequest::Kind::kInvokeService, absl::StrCat("service", dice_.Below(2)), Arguments()});
        return batch;
      }
      case 14:
      case 15:
        return dice_.OneIn(1, "event") ? Ring() : WriteBatch();
      case 16: {
        const int number = dice_.Below(test::kSimulatedWorkflows);
        return dice_.OneIn(3, "again") ? documents_.Again(number) : WriteBatch();
      }
      case 4:
      case 5: {
        WriteBatch batch;
        const std::vector<std::string> live = LiveRuns();
        if (live.empty()) return batch;
        RunRequest cancel;
        cancel.kind = RunRequest::Kind::kCancel;
        cancel.target = live[static_cast<size_t>(dice_.Below(static_cast<int>(live.size())))];
        cancel.compensates = dice_.OneIn(2);
        batch.run_requests.push_back(std::move(cancel));
        return batch;
      }
      case 6:
      case 7: {
        static constexpr const char* kStatuses[] = {"Standby",  "Standby",     "Busy",
                                                    "Charging", "Maintenance", "Offline"};
        return Tell(
            {Fact(Fleet::Robot(robot), "docent:status", absl::StrCat("docent:", kStatuses[dice_.Below(6)]))});
      }
      case 8:
        if (dice_.OneIn(2, "die")) fleet_.Die(robot, now_us_);
        return WriteBatch();
      case 9: {
        WriteBatch batch;
        static constexpr const char* kHow[] = {"", kRemovesRuns, kRemovesStarts, kRemovesDisablement,
                                               kRemovesDisablement};
        const std::string workflow = absl::StrCat("W", dice_.Below(test::kSimulatedWorkflows));
        const char* how = kHow[dice_.Below(5)];
        if (dice_.OneIn(2, "remove"))
          batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, workflow, how});
        return batch;
      }
      default: {
        if (dice_.OneIn(3, "fall")) return Fall();
        const TermQuad fact = Fact(absl::StrCat("P", dice_.Below(3)),
                                   absl::StrCat("wants", dice_.Below(test::kSimulatedWords)), "Thing");
        return dice_.OneIn(2) ? Tell({}, {fact}) : Tell({fact});
      }
    }
  }

  // What has to hold while a node runs that has begun something is withdrawn, but for what runs told.
  WriteBatch Fall() {
    std::vector<int> words;
    for (const std::string& node : begun_) {
      const std::string flow = node.substr(0, node.find('-'));
      const int word = test::RandomDocuments::WordOf(documents_.holds, flow + node.substr(node.find('/')));
      if (word >= 0) words.push_back(word);
    }
    if (words.empty()) return WriteBatch();
    const int word = words[static_cast<size_t>(dice_.Below(static_cast<int>(words.size())))];
    std::vector<TermQuad> facts;
    for (int person = 0; person < 3; ++person)
      facts.push_back(Fact(absl::StrCat("P", person), absl::StrCat("wants", word), "Thing"));
    return Tell({}, facts);
  }

  std::vector<std::pair<std::string, Term>> Arguments() {
    std::vector<std::pair<std::string, Term>> arguments;
    if (dice_.OneIn(2)) arguments.emplace_back("target", Iri(dice_.OneIn(3) ? "Nothing" : "Thing"));
    if (dice_.OneIn(4)) arguments.emplace_back("count", Term::Integer(dice_.Below(5)));
    return arguments;
  }

  // An event, told in one of many ways.
  WriteBatch Ring() {
    const Term event = dice_.OneIn(2) ? Term::Blank("b1") : Iri("bell");
    WriteBatch batch;
    for (const TermQuad& fact :
         {TermQuad{event, Iri("a"), Iri("docent:Event"), Term()},
          TermQuad{event, Iri("docent:operation"),
                   Term::Literal(absl::StrCat("ring", dice_.Below(test::kSimulatedWorkflows))), Term()}})
      batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
    if (dice_.OneIn(3)) batch.source = "urn:w:Bell";
    if (dice_.OneIn(3)) batch.mode = WriteBatch::Mode::kLoad;
    return batch;
  }

  // What an operator asks for: some of it twice, or of what is not in the state for it.
  WriteBatch Steering() {
    using Kind = RunRequest::Kind;
    WriteBatch batch;
    const std::vector<std::string> live = LiveRuns();
    RunRequest request;
    request.cancels_commands = dice_.OneIn(2);
    if (!live.empty()) request.target = live[static_cast<size_t>(dice_.Below(static_cast<int>(live.size())))];
    const auto workflow = [&] { request.target = absl::StrCat("W", dice_.Below(test::kSimulatedWorkflows)); };
    switch (dice_.Below(10)) {
      case 0:
        return OutOfService(dice_.Below(test::SimulatedRobots()), true);
      case 1:
      case 2:
        return OutOfService(dice_.Below(test::SimulatedRobots()), false);
      case 3:
        request.kind = Kind::kPause;
        break;
      case 4:
      case 5:
        request.kind = Kind::kResume;
        break;
      case 6:
        request.kind = dice_.OneIn(3) ? Kind::kPauseWorkflow : Kind::kResumeWorkflow;
        workflow();
        break;
      case 7:
        request.kind = Kind::kSetVariable;
        request.arguments = Arguments();
        break;
      default: {
        const std::vector<std::string> incidents =
            Graph()->Subjects(DocentIri("nodeState"), Term::Literal("incident"));
        if (incidents.empty()) return batch;
        const std::string& node =
            incidents[static_cast<size_t>(dice_.Below(static_cast<int>(incidents.size())))];
        request.target = RunOfIri(Graph()->Object(node, DocentIri("ofRun")))->value();
        request.node = Graph()->Object(node, DocentIri("nodeName"));
        static constexpr Kind kHow[] = {Kind::kRetryNode, Kind::kRetryNode, Kind::kSkipNode, Kind::kFailNode};
        request.kind = kHow[dice_.Below(4)];
        if (request.kind == Kind::kRetryNode && dice_.OneIn(2))
          request.robot = test::Name(Fleet::Robot(dice_.Below(test::SimulatedRobots())));
      }
    }
    if (!request.target.empty()) batch.run_requests.push_back(std::move(request));
    return batch;
  }

  // An operator keeps robots for a run, a workflow or none, or gives some back.
  WriteBatch Reservation() {
    WriteBatch batch;
    Graph();
    if (!reservations_.empty() && dice_.OneIn(3)) {
      const auto& one =
          reservations_[static_cast<size_t>(dice_.Below(static_cast<int>(reservations_.size())))];
      EXPECT_TRUE(ReleaseReservation(one.iri, dictionary_, *version_, &batch).ok());
      return batch;
    }
    ReservationRequest request;
    for (int r = 0; r < test::SimulatedRobots(); ++r) {
      if (request.robots.empty() || dice_.OneIn(2))
        request.robots.push_back(test::Name(Fleet::Robot((r + dice_.Below(2)) % test::SimulatedRobots())));
    }
    request.priority = dice_.Below(5) - 1;
    request.lasting_ms = 1000 + static_cast<uint64_t>(dice_.Below(15000));
    const std::vector<std::string> live = LiveRuns();
    if (!live.empty() && dice_.OneIn(2)) {
      request.kept_for = live[static_cast<size_t>(dice_.Below(static_cast<int>(live.size())))];
      if (dice_.OneIn(2)) request.lasting_ms = 0;
    } else if (dice_.OneIn(2)) {
      request.kept_for = absl::StrCat("W", dice_.Below(test::kSimulatedWorkflows));
    }
    engine::Reservation made;
    const absl::Status status = MakeReservation(request, dictionary_, *version_, now_us_, &batch, &made);
    EXPECT_TRUE(status.ok() || absl::IsNotFound(status)) << status;
    if (!status.ok()) return WriteBatch();
    asked_now_ = {made};
    return batch;
  }

  WriteBatch OutOfService(int robot, bool out) {
    const TermQuad fact = Fact(Fleet::Robot(robot), "docent:outOfService", Term::Literal("a wheel"));
    WriteBatch batch = out ? Tell({fact}) : Tell({}, {fact});
    if (out && dice_.OneIn(2)) {
      RunRequest cancel;
      cancel.kind = RunRequest::Kind::kCancelCommands;
      cancel.target = test::Name(Fleet::Robot(robot));
      batch.run_requests.push_back(std::move(cancel));
    }
    return batch;
  }

  std::vector<std::string> LiveRuns() {
    std::vector<std::string> live;
    for (const std::string& run : Graph()->Subjects(DocentIri("runState"), Term::Literal("running")))
      live.push_back(RunOfIri(run)->value());
    return live;
  }

  void Turn(WriteBatch batch) {
    batch.time_us = now_us_;
    const std::vector<engine::Reservation> reserved_before = reservations_;
    const std::vector<engine::Reservation> asked = std::exchange(asked_now_, {});
    const std::map<RobotId, std::string> held_before = Holders();
    const auto result = RunTurn(stages_.get(), batch, log_.size() + 1);
    if (!result.ok()) {
      Note(absl::StrCat("refused: ", std::string(result.status().message())));
      // what asks for something that is gone meanwhile may be refused, and nothing else
      EXPECT_TRUE(!batch.run_requests.empty() || !batch.documents.empty()) << result.status();
      return;
    }
    log_.push_back(result->record);
    firings_.Check(batch, result->record.transitions, documents_.activators);
    for (const CommandReport& report : batch.reports) {
      if (report.outcome != CommandReport::Outcome::kSucceeded || !under_way_.contains(report.command))
        continue;
      const IdParts id(report.command);
      undoing_.Succeeded(id.run, id.node,
                         documents_.compensated.contains(absl::StrCat(id.flow(), "/", id.node)));
    }
    undoing_.Take(result->record.transitions);
    for (const Transition& t : result->record.transitions)
      Note(absl::StrCat(t.subject, "  ", t.from, " → ", t.to, "  ", t.cause));
    for (const CommandReport& report : batch.reports) {
      Note(absl::StrCat("report ", report.command.value(), " ", static_cast<int>(report.outcome)));
      if (!IsFinal(report.outcome)) continue;
      not_begun_ += report.outcome == CommandReport::Outcome::kNotBegun ? 1 : 0;
      under_way_.erase(report.command);
      attempts_.Ended(report.command, now_us_);
    }
    std::vector<CommandId> under_way;
    for (const auto& [id, command] : under_way_) under_way.push_back(id);
    attempts_.Take(result->record.transitions, under_way, now_us_);
    GraphReader* graph = Graph();
    Remember(*graph, result->record.transitions);
    reservations_ = ReadReservations(dictionary_, *version_);
    for (const Notification& notification : result->notifications) postman_.Send(notification, now_us_);
    // Runs whose reservations changed in the turn: what was reserved for them when a command was decided is not seen after it.
    std::set<std::string> reserving;
    for (const Transition& t : result->record.transitions) {
      if (t.cause.starts_with("reserved "))
        reserving.insert(RootOf(*graph, t.subject.substr(0, t.subject.find('/'))));
    }
    for (const RobotCommand& command : result->record.commands) {
      // one that is cancelled in the turn that decided it is ended before the robot begins it
      const bool stays =
          std::find(result->cancels.begin(), result->cancels.end(), command.id) == result->cancels.end();
      CheckCommand(*graph, command, stays);
      const std::string root = RootOf(*graph, IdParts(command.id).run);
      if (!reserving.contains(root)) CheckReserved(command, root, reserved_before, asked, held_before);
      under_way_[command.id] = {command, RootOf(*graph, IdParts(command.id).run),
                                RunAndParents(*graph, IdParts(command.id).run)};
    }
    CheckHolds(*graph);
    CheckHeld(*graph);
    CheckWrites(*graph);
    if (log_.size() % 4 == 0) CheckWaits();
    for (const RobotCommand& command : result->record.commands) fleet_.Send(command, now_us_);
    for (const CommandId& id : result->recalls) fleet_.Recall(id);
    for (const CommandId& id : result->cancels) {
      cancelled_.insert(id);
      fleet_.Cancel(id, now_us_);
    }
    commands_ += result->record.commands.size();
    for (const Transition& transition : result->record.transitions)
      preempted_ += transition.cause.starts_with("pre-empted") ? 1 : 0;
  }

  // What is wanted after the turn, and who wrote in it: RUN/NODE, or a RUN that ended.
  void Remember(const GraphReader& graph, const std::vector<Transition>& transitions) {
    writers_.resize(log_.size() + 1);
    for (const Transition& t : transitions) {
      const bool writes = t.cause.starts_with("told ") || t.cause.starts_with("withdrew ");
      const bool ends = !absl::StrContains(t.subject, '/') && t.from == "running" && t.to != "running";
      if (writes || ends) writers_.back().insert(t.subject);
      if (t.from == "waiting") wrote_.erase(t.subject);
      if (writes) wrote_.insert(t.subject);
      const std::vector<std::string> parts = absl::StrSplit(t.subject, '/');
      if (parts.size() == 2 && t.from != t.to) begun_.erase(t.subject);
      if (parts.size() == 3 && t.from == "pending" && t.to == "running")
        begun_.insert(absl::StrCat(parts[0], "/", parts[1]));
    }
    std::array<bool, test::kSimulatedWords> wanted{};
    for (int word = 0; word < test::kSimulatedWords; ++word)
      wanted[static_cast<size_t>(word)] =
          !graph.Subjects(test::Name(absl::StrCat("wants", word)), Iri("Thing")).empty();
    wanted_.resize(log_.size() + 1);
    wanted_[log_.size()] = wanted;
  }

  static std::set<std::string> RunAndParents(const GraphReader& graph, const std::string& run) {
    std::set<std::string> runs;
    for (std::string iri = RunIri(RunId(run)); !iri.empty(); iri = graph.Object(iri, DocentIri("parentRun")))
      runs.insert(iri);
    return runs;
  }

  static std::string RootOf(const GraphReader& graph, const std::string& run) {
    std::string iri = RunIri(RunId(run));
    for (std::string parent; !(parent = graph.Object(iri, DocentIri("parentRun"))).empty();) iri = parent;
    return RunOfIri(iri)->value();
  }

  void CheckCommand(const GraphReader& graph, const RobotCommand& command, bool stays) {
    const IdParts id(command.id);
    Note(absl::StrCat("command ", command.id.value(), " ", command.operation, " on ", command.robot.value()));
    const std::string root = RootOf(graph, id.run);
    bool robot_has_command = false;
    for (const auto& [other_id, other] : under_way_) {
      const IdParts before(other_id);
      if (before.place == id.place) {
        EXPECT_TRUE(before.attempt == id.attempt && before.step != id.step)
            << command.id.value() << " begins before the end of " << other_id.value() << " is known";
      }
      if (other.command.robot != command.robot) continue;
      robot_has_command = true;
      EXPECT_EQ(other.root, root) << "two runs have " << command.robot.value();
      const engine::Occupation& a = test::OperationNamed(command.operation).occupies;
      const engine::Occupation& b = test::OperationNamed(other.command.operation).occupies;
      const bool share =
          std::any_of(a.begin(), a.end(), [&b](const std::string& r) { return b.contains(r); });
      EXPECT_FALSE(a.empty() || b.empty() || share)
          << command.id.value() << " beside " << other_id.value() << " on " << command.robot.value();
    }
    EXPECT_EQ(graph.Object(RunIri(RunId(id.run)), DocentIri("pausedAt")), "")
        << command.id.value() << " of a run that is paused";
    EXPECT_EQ(graph.Object(command.robot.value(), DocentIri("outOfService")), "")
        << command.id.value() << " to a robot that is out of service";
    const std::string status = graph.Object(command.robot.value(), DocentIri("status"));
    EXPECT_TRUE(status == DocentIri("Standby") || (status == DocentIri("Busy") && robot_has_command))
        << command.id.value() << " to a robot that is " << status;
    const std::string lives = graph.Object(command.robot.value(), DocentIri("incarnation"));
    meant_for_[command.id.value()] = lives;
    // the id of one that is sent again goes on where that of the one before ends
    const auto before = meant_for_.find(command.id.value().substr(0, command.id.value().rfind('.')));
    reborn_ += before != meant_for_.end() && before->second != lives ? 1 : 0;
    EXPECT_TRUE(command.expected_incarnation == lives ||
                (command.idempotent && command.expected_incarnation.empty()))
        << command.id.value() << " is meant for " << command.expected_incarnation << ", and " << lives
        << " is there";
    if (stays) CheckGuard(command, id);
    CheckClass(command, id);
  }

  // A robot begins the command now: after the turns before, of which nothing may be lost on the way.
  void CheckBegin(const RobotCommand& command) {
    Note(absl::StrCat("begins ", command.id.value()));
    const GraphReader& graph = *Graph();
    const std::string run = RunIri(RunId(IdParts(command.id).run));
    EXPECT_FALSE(cancelled_.contains(command.id)) << command.id.value() << " was cancelled";
    EXPECT_EQ(graph.Object(run, DocentIri("runState")), "running")
        << command.id.value() << " of a run that has ended";
    EXPECT_EQ(graph.Object(run, DocentIri("pausedAt")), "")
        << command.id.value() << " of a run that is paused";
    EXPECT_EQ(graph.Object(command.robot.value(), DocentIri("outOfService")), "")
        << command.id.value() << " at a robot that is out of service";
    if (command.deadline_us != 0) {
      EXPECT_GT(command.deadline_us, now_us_) << command.id.value() << " after its time";
    }
  }

  std::map<RobotId, std::string> Holders() const {
    std::map<RobotId, std::string> holders;
    for (int r = 0; r < test::SimulatedRobots(); ++r) {
      const RobotId robot(test::Name(Fleet::Robot(r)));
      if (const RunId* holder = stages_->engine.HolderOf(robot)) holders[robot] = holder->value();
    }
    return holders;
  }

  // Reservations that were there before this turn and after it were there when the command was decided. One that was asked for in this
  // turn allowed the command, also where its run ended in the turn and took it away.
  void CheckReserved(const RobotCommand& command, const std::string& root,
                     const std::vector<engine::Reservation>& before,
                     const std::vector<engine::Reservation>& asked,
                     const std::map<RobotId, std::string>& held_before) {
    const std::string flow = root.substr(0, root.find('-'));
    const auto priority = documents_.priorities.find(flow);
    const int rank = priority == documents_.priorities.end() ? 0 : priority->second;
    const auto is_own = [&](const engine::Reservation& reservation) {
      return reservation.kept_for == RunIri(RunId(root)) ||
             reservation.kept_for == WorkflowIri("W" + flow.substr(1));
    };
    const auto in_order = [](const engine::Reservation& a, const engine::Reservation& b) {
      return std::tie(b.priority, a.since_us, a.iri) < std::tie(a.priority, b.since_us, b.iri);
    };
    for (const engine::Reservation& one : before) {
      const auto same =
          std::find_if(reservations_.begin(), reservations_.end(), [&](const engine::Reservation& other) {
            return other.iri == one.iri && other.since_us == one.since_us && other.priority == one.priority;
          });
      if (same == reservations_.end() || !one.robots.contains(command.robot) || is_own(one)) continue;
      bool may = rank > one.priority;
      for (const auto* list : {&before, &asked, &std::as_const(reservations_)}) {
        for (const engine::Reservation& own : *list)
          may = may || (is_own(own) && own.robots.contains(command.robot) && in_order(own, one));
      }
      for (const RobotId& robot : one.robots) {
        const auto holder = held_before.find(robot);
        may = may || (holder != held_before.end() && holder->second == root);
      }
      for (const auto& [id, other] : under_way_)  // also what it got before in this turn
        may = may || (other.root == root && one.robots.contains(other.command.robot));
      EXPECT_TRUE(may) << command.id.value() << " of run " << root << ", of priority " << rank << ", to "
                       << command.robot.value() << ", which is kept by " << one.iri << " for " << one.kept_for
                       << ", with priority " << one.priority << ", until " << one.until_us << " of "
                       << now_us_ << ", with " << one.robots.size() << " robots";
    }
  }

  void CheckClass(const RobotCommand& command, const IdParts& id) {
    const auto wanted = documents_.classes.find(absl::StrCat(id.flow(), "/", id.node));
    if (wanted == documents_.classes.end() || wanted->second.empty()) return;
    size_t invocation = 0;
    ASSERT_TRUE(absl::SimpleAtoi(id.place.substr(id.place.rfind('/') + 1), &invocation));
    const std::string& of_class = wanted->second[invocation % wanted->second.size()];
    if (of_class.empty()) return;
    ++by_class_;
    EXPECT_TRUE(test::SimulatedClasses().at(of_class).contains(command.operation))
        << command.operation << " is not of class " << of_class;
  }

  // What was written in the turn may have made it fall right after it was asked. What the node itself writes when it opens does not
  // close its guard.
  void CheckGuard(const RobotCommand& command, const IdParts& id) {
    if (!writers_.at(command.guard_revision.value()).empty()) return;
    if (wrote_.contains(absl::StrCat(id.run, "/", id.node))) return;
    const std::string place = absl::StrCat(id.flow(), "/", id.node);
    if (const auto word = documents_.words.find(place); word != documents_.words.end()) {
      const uint64_t at = command.guard_revision.value();
      ASSERT_LT(at, wanted_.size());
      EXPECT_TRUE(wanted_[at][static_cast<size_t>(word->second)])
          << command.id.value() << ": its condition did not hold at revision " << at;
    }
    if (const auto word = documents_.holds.find(place); word != documents_.holds.end()) {
      EXPECT_TRUE(wanted_.back()[static_cast<size_t>(word->second)])
          << command.id.value() << ": what has to hold does not";
    }
  }

  void CheckHolds(const GraphReader& graph) {
    for (int r = 0; r < test::SimulatedRobots(); ++r) {
      const RobotId robot(test::Name(Fleet::Robot(r)));
      const RunId* holder = stages_->engine.HolderOf(robot);
      const std::string told = graph.Object(robot.value(), DocentIri("heldBy"));
      EXPECT_EQ(told, holder == nullptr ? "" : RunIri(*holder));
      bool has_command = false;
      for (const auto& [id, other] : under_way_) {
        if (other.command.robot != robot) continue;
        has_command = true;
        ASSERT_NE(holder, nullptr) << robot.value() << " is free while " << id.value() << " is under way";
        EXPECT_EQ(holder->value(), other.root) << id.value();
      }
      if (holder == nullptr || has_command) continue;
      EXPECT_EQ(graph.Object(RunIri(*holder), DocentIri("runState")), "running")
          << robot.value() << " is held by a run that has ended with all its commands";
    }
    EXPECT_EQ(stages_->engine.OpenCommands().size(), under_way_.size());
  }

  // What has to hold while a node runs has to from its first command until it is done, also between attempts.
  void CheckHeld(const GraphReader& graph) {
    for (const std::string& node : begun_) {
      const size_t slash = node.find('/');
      const std::string run = node.substr(0, slash);
      const std::string place = absl::StrCat(run.substr(0, run.find('-')), node.substr(slash));
      const auto word = documents_.holds.find(place);
      if (word == documents_.holds.end() || wanted_.back()[static_cast<size_t>(word->second)]) continue;
      // what the node itself writes when it opens does not close its guard
      if (documents_.holding_conditions.contains(place) && wrote_.contains(node)) continue;
      v1::Run state;
      ASSERT_TRUE(ReadRun(graph, run, &state));
      for (const v1::Node& one : state.nodes()) {
        if (absl::StrCat(run, "/", one.name()) != node || one.state() != "running") continue;
        const bool goes_on =
            std::any_of(one.invocations().begin(), one.invocations().end(), [](const auto& invocation) {
              return invocation.state() == "pending" || invocation.state() == "running";
            });
        fallen_ += absl::StartsWith(one.reason(), "interrupted: ") ? 1 : 0;
        EXPECT_TRUE(!goes_on || absl::StartsWith(one.reason(), "interrupted: "))
            << node << " goes on, and what has to hold does not\n"
            << one.DebugString();
      }
    }
  }

  // Whether a command of the run, or of one that is nested in it, is under way.
  bool HasCommand(const std::string& run_iri) const {
    return std::any_of(under_way_.begin(), under_way_.end(),
                       [&](const auto& command) { return command.second.runs.contains(run_iri); });
  }

  // What runs wrote.
  void CheckWrites(const GraphReader& graph) {
    const auto mark = dictionary_.FindIri(test::Name("mark"));
    if (mark) {
      version_->ForEach({{}, *mark, {}, {}}, [&](const Quad& quad) {
        const std::string source = dictionary_.Decode(quad.graph).lexical;
        if (graph.Object(source, DocentIri("runState")) == "running") return true;
        EXPECT_TRUE(HasCommand(source))
            << source << " has ended with all its commands, and what it told for its life is still there";
        return true;
      });
    }
    for (const std::string& variable : graph.Subjects(DocentIri("variableName"), Term::Literal("count"))) {
      if (!variable.starts_with("urn:docent:run:F")) continue;  // a service's, which says no type
      for (const Term& value : graph.Objects(variable, DocentIri("variableValue")))
        EXPECT_EQ(value.datatype, "http://www.w3.org/2001/XMLSchema#integer")
            << variable << " is " << value.lexical;
    }
    postman_.Check(stages_->engine.OpenNotifications());
  }

  // Each live run waits for a thing that can be named; a command that it is said to wait for is under way.
  void CheckWaits() {
    const std::vector<std::string> live = LiveRuns();
    const GraphReader& graph = *reader_;
    for (const std::string& id : live) {
      v1::Run run;
      ASSERT_TRUE(ReadRun(graph, id, &run));
      v1::ExplainRunReply reply;
      AddWaits({&graph, nullptr, 0, nullptr}, run, "", &reply);
      EXPECT_FALSE(reply.waits().empty()) << "nothing is told of what " << id << " waits for\n"
                                          << run.DebugString();
      for (const v1::Wait& wait : reply.waits()) {
        EXPECT_FALSE(wait.detail().empty());
        if (wait.kind() != "operator" && absl::StrContains(wait.detail(), "is reserved")) {
          ++barred_;
          EXPECT_FALSE(reservations_.empty()) << id << " waits for the end of a reservation that has ended";
        }
        if (wait.kind() != "command") continue;
        const bool under_way = std::any_of(
            under_way_.begin(), under_way_.end(),
            [&wait](const auto& command) { return absl::StrContains(wait.detail(), command.first.value()); });
        EXPECT_TRUE(under_way) << wait.detail();
      }
    }
  }

  // The process ends, and begins from a snapshot.
  void Restart() {
    Note("restart");
    const auto bytes = EncodeState(
        TakeState(*stages_, requests_, stages_->writer.Freeze(Revision(log_.size())), now_us_), dictionary_);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    auto state = DecodeState(*bytes, &dictionary_, &functions_, limits_);
    ASSERT_TRUE(state.ok()) << state.status();
    reader_.reset();
    version_.reset();
    stages_ = std::move(state->stages);
    stages_->freezes = false;
    fleet_.ForgetWishes();
    for (const engine::CommandUnderWay& open : stages_->engine.OpenCommands()) fleet_.Resume(open);
  }

  // All that is under way ends; then every robot has to be free.
  void Drain() {
    for (int r = 0; r < test::SimulatedRobots(); ++r) {
      Turn(fleet_.Join(r, now_us_));
      Turn(OutOfService(r, false));
    }
    for (int w = 0; w < test::kSimulatedWorkflows; ++w) {
      WriteBatch batch;
      batch.run_requests.push_back({RunRequest::Kind::kResumeWorkflow, absl::StrCat("W", w), {}});
      Turn(std::move(batch));
      WriteBatch remove;  // what starts runs by itself
      remove.documents.push_back(
          {Document::Kind::kCawl, Document::Action::kRemove, absl::StrCat("W", w), ""});
      Turn(std::move(remove));
    }
    for (int i = 0; i < 40 && !Failed(); ++i) {
      now_us_ += 1'000'000;
      fleet_.EndAll(now_us_);
      Deliver();
      if (i < 20) continue;
      for (const std::string& run : LiveRuns()) {
        WriteBatch batch;
        batch.run_requests.push_back({RunRequest::Kind::kCancel, run, {}});
        Turn(std::move(batch));
      }
    }
    EXPECT_EQ(stages_->engine.live_runs(), 0u);
    EXPECT_TRUE(stages_->engine.OpenCommands().empty());
    EXPECT_TRUE(reservations_.empty()) << "each ends by time, or with its run";
    EXPECT_TRUE(stages_->engine.OpenNotifications().empty());
    EXPECT_THAT(Graph()->Subjects(kRdfType, Term::Iri(DocentIri("TimeTrigger"))), ::testing::IsEmpty())
        << "a time is asked for though nothing waits for it";
    for (int r = 0; r < test::SimulatedRobots(); ++r)
      EXPECT_EQ(stages_->engine.HolderOf(RobotId(test::Name(Fleet::Robot(r)))), nullptr);
  }

  void Replay() {
    Dictionary dictionary;
    const std::unique_ptr<Stages> stages = NewStages(&dictionary);
    for (const log::TurnRecord& record : log_) {
      const auto again = RunTurn(stages.get(), record.batch, record.offset);
      ASSERT_TRUE(again.ok()) << again.status();
      ASSERT_EQ(log::DecisionDifference(record, again->record).value_or(""), "") << "at " << record.offset;
    }
    const std::vector<std::string> replayed = test::Lines(dictionary, stages->writer.current()),
                                   played = test::Lines(dictionary_, stages_->writer.current());
    std::vector<std::string> differ;
    std::set_symmetric_difference(replayed.begin(), replayed.end(), played.begin(), played.end(),
                                  std::back_inserter(differ));
    EXPECT_THAT(differ, ::testing::IsEmpty());
  }

  const bool tells_;
  const Limits limits_;
  Dice dice_;
  Fleet fleet_;
  test::RandomDocuments documents_;
  test::Postman postman_;
  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  RequestMemory requests_{10};
  std::unique_ptr<Stages> stages_;
  GraphVersionPtr version_;
  std::unique_ptr<GraphReader> reader_;
  TimeMicros now_us_ = 1'700'000'000'000'000;
  std::vector<log::TurnRecord> log_;
  std::vector<std::array<bool, test::kSimulatedWords>> wanted_;  // by revision
  std::set<std::string> wrote_;                                  // RUN/NODE: since it opened
  std::set<std::string> begun_;                                  // RUN/NODE: it has begun something
  std::vector<std::set<std::string>> writers_;                   // by revision: nodes and runs that wrote
  std::map<CommandId, UnderWay> under_way_;
  std::set<CommandId> cancelled_;  // that a turn decided to end
  test::AttemptModel attempts_;
  test::FiringModel firings_;
  test::UndoModel undoing_;
  size_t commands_ = 0;
  size_t not_begun_ = 0;
  size_t reborn_ = 0;                             // commands that were sent again to another adapter
  std::map<std::string, std::string> meant_for_;  // by command: the adapter's incarnation
  size_t preempted_ = 0;
  size_t barred_ = 0;    // invocations that waited for the end of a reservation, when it was looked
  size_t by_class_ = 0;  // commands of those that asked for a class
  size_t fallen_ = 0;    // nodes that were interrupted, and waited for the end of their commands
  std::vector<engine::Reservation> reservations_;
  std::vector<engine::Reservation> asked_now_;  // by the batch that the next turn takes
};

TEST(RobotSimulationTest, OneRobotDoesOneThingAtATimeAndAGuardIsAGuard) {
  const int only = test::NumberFromEnvironment("DOCENT_SIMULATION_SEED", -1);
  const int seeds = only < 0 ? test::NumberFromEnvironment("DOCENT_SIMULATION_SEEDS", 300) : 1;
  const int first = only < 0 ? test::NumberFromEnvironment("DOCENT_SIMULATION_FIRST", 0) : only;
  size_t commands = 0, preempted = 0, barred = 0, by_class = 0, fallen = 0, timed_out = 0, undone = 0,
         not_begun = 0, reborn = 0;
  for (int seed = first; seed < first + seeds; ++seed) {
    SCOPED_TRACE(absl::StrCat("DOCENT_SIMULATION_SEED=", seed));
    Simulation simulation(static_cast<uint32_t>(seed), only >= 0);
    simulation.Play();
    commands += simulation.commands();
    preempted += simulation.preempted();
    barred += simulation.barred();
    by_class += simulation.by_class();
    fallen += simulation.fallen();
    timed_out += simulation.timed_out();
    undone += simulation.undone();
    not_begun += simulation.not_begun();
    reborn += simulation.reborn();
    if (HasFailure()) break;
  }
  if (only < 0 && first == 0 && seeds >= 300) {
    EXPECT_GT(commands, 5u * static_cast<size_t>(seeds)) << "it has to try something";
    EXPECT_GT(preempted, static_cast<size_t>(seeds) / 60) << "of pre-emption, too";
    EXPECT_GT(barred, static_cast<size_t>(seeds) / 30) << "of reservations";
    EXPECT_GT(by_class, static_cast<size_t>(seeds) / 3) << "of classes of operations";
    EXPECT_GT(fallen, static_cast<size_t>(seeds) / 30) << "of what has to hold and falls";
    EXPECT_GT(timed_out, static_cast<size_t>(seeds) / 30) << "of times of nodes";
    EXPECT_GT(undone, static_cast<size_t>(seeds) / 30) << "of what is undone";
    EXPECT_GT(not_begun, static_cast<size_t>(seeds) / 10) << "of what is stopped before it begins";
    EXPECT_GT(reborn, static_cast<size_t>(seeds) / 30) << "of what is sent again to another adapter";
  }
}

}  // namespace
}  // namespace docent::server
