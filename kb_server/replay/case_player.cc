#include "kb_server/replay/case_player.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/clock/wait_times.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/replay/answer_book.h"
#include "kb_server/replay/play_outlook.h"
#include "kb_server/replay/play_questions.h"
#include "kb_server/replay/play_stages.h"
#include "kb_server/replay/played_clock.h"
#include "kb_server/replay/played_document.h"
#include "kb_server/replay/recording.h"
#include "kb_server/replay/run_course.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/turn/turn.h"

namespace docent::server {
namespace {

// In a file of an older version, which has no ticks: a timer that the server noticed with a turn of its own goes off with that
// turn, which was a little later.
constexpr TimeMicros kLateTurn = 1'000'000;

bool IsFinalState(const std::string& state) {
  return state == "done" || state == "failed" || state == "cancelled";
}

std::string Show(const Decision& command) {
  return absl::StrCat(command.operation, "(",
                      absl::StrJoin(command.arguments, ", ",
                                    [](std::string* out, const auto& argument) {
                                      absl::StrAppend(out, argument.first, "=", ToDisplay(argument.second));
                                    }),
                      ") to ", ToDisplay(Term::Iri(command.robot.value())));
}

class Player {
 public:
  Player(const RunCase& recorded, const cawl::DocumentPtr& document, const PlayOptions& options)
      : recorded_(recorded),
        given_(document),
        document_(*document),
        options_(options),
        answers_(recorded),
        clock_(ClockOf(recorded)),
        stages_(recorded_, document_, options) {}

  absl::StatusOr<Play> Run() {
    if (absl::Status ready = SetUp(); !ready.ok()) return ready;
    if (absl::Status begun = is_world() ? BeginWorld() : BeginRun(); !begun.ok()) return begun;
    for (size_t i = 1; i < recorded_.turns.size() && GoesOn(); ++i) {
      if (absl::Status until = PlayUntil(recorded_.turns[i].time_us); !until.ok()) return until;
      if (!GoesOn()) break;
      if (absl::Status played = PlayTurn(recorded_.turns[i]); !played.ok()) return played;
    }
    if (absl::Status rest = simulated() ? PlayOut() : PlayRest(); !rest.ok()) return rest;
    return End();
  }

 private:
  bool simulated() const { return options_.simulated_until_us != 0; }
  bool is_world() const { return recorded_.state.empty(); }
  // An old file has what the recorded clock told as changes of facts; what that was not asked is not known.
  static PlayedClock::Tells ClockOf(const RunCase& recorded) {
    if (!recorded.state.empty()) return PlayedClock::Tells::kUnrecorded;
    return recorded.course.decisions.empty() ? PlayedClock::Tells::kAll : PlayedClock::Tells::kNothing;
  }
  bool GoesOn() const { return tree_.has_value() && !ended_ && play_.stopped.empty(); }

  absl::Status SetUp() {
    if (absl::Status ready = stages_.SetUp(); !ready.ok()) return ready;
    offset_ = recorded_.turns.front().offset - 1;
    now_us_ = recorded_.turns.front().time_us;
    clock_.Begin(stages_.dictionary(), stages_->writer.current());
    return absl::OkStatus();
  }

  // A recorded run begins where it did, in its place among all that its first turn does.
  absl::Status BeginRun() {
    engine::PlayedRun played;
    played.number = recorded_.number;
    played.document = given_;
    played.flow = recorded_.flow;
    for (const auto& [run, path] : recorded_.nested) played.nested.push_back(NumberOf(run));
    std::sort(played.nested.begin(), played.nested.end());
    if (!recorded_.asked && !ActivatesAsRecorded()) {
      absl::StatusOr<Activation> activation = TryActivation();
      if (!activation.ok()) return activation.status();
      if (!activation->fires) return DoesNotFire(*activation);
      played.variables = activation->values;
      if (absl::Status again = SetUp(); !again.ok()) return again;
    }
    if (!recorded_.asked) played.flow = document_.activator->flow.value;
    root_ = RunId(absl::StrCat(IriSegment(played.flow), "-", played.number));
    stages_->engine.PlayInstead(std::move(played));
    tree_.emplace(root_);
    if (absl::Status begun = PlayTurn(recorded_.turns.front()); !begun.ok()) return begun;
    if (!begun_) Stop(kActivator, "what started the recorded run does not start it in the replay");
    return absl::OkStatus();
  }

  absl::Status DoesNotFire(const Activation& activation) {
    Stop(kActivator, activation.why_not);
    activation_ask_ = activation.ask;
    return absl::OkStatus();
  }

  // Whether the activator fires as the one that started the run, so that its values are those of then.
  bool ActivatesAsRecorded() const {
    const auto ran = ParseWorkflow(recorded_.document.text, recorded_.document.name, options_.limits);
    return ran.ok() && FiresAlike(**ran, document_, options_.limits);
  }

  // What an edited activator makes of the recorded key, on the facts of the first turn as it was.
  absl::StatusOr<Activation> TryActivation() {
    const CaseTurn& first = recorded_.turns.front();
    const absl::StatusOr<TurnResult> result = stages_.Turn(first.batch, first.offset, first.time_us);
    if (!result.ok()) return result.status();
    absl::StatusOr<Activation> activation = Activate();
    if (activation.ok() && !activation->note.empty()) play_.notes.push_back(activation->note);
    return activation;
  }

  // The facts of the first turn of a world, then the run on them.
  absl::Status BeginWorld() {
    const CaseTurn& first = recorded_.turns.front();
    offset_ = first.offset;
    if (absl::Status told = PlayWorld(first); !told.ok()) return told;
    RunRequest start;
    start.kind = RunRequest::Kind::kStart;
    start.arguments = recorded_.values;
    std::string flow = recorded_.flow;
    if (!recorded_.asked) {
      absl::StatusOr<Activation> activation = Activate();
      if (!activation.ok()) return activation.status();
      if (!activation->note.empty()) play_.notes.push_back(activation->note);
      if (!activation->fires) return DoesNotFire(*activation);
      start.arguments.assign(activation->values.begin(), activation->values.end());
      flow = document_.activator->flow.value;
    }
    if (simulated() && document_.activator && flow == document_.activator->flow.value) {
      if (absl::Status found = FindValues(&start.arguments); !found.ok()) return found;
    }
    start.target = absl::StrCat(document_.name.value, "/", flow);
    WriteBatch batch;
    batch.run_requests.push_back(std::move(start));
    absl::StatusOr<TurnResult> result = stages_.Turn(std::move(batch), offset_, now_us_);
    if (!result.ok()) return result.status();
    root_ = result->started.at(0);
    tree_.emplace(root_);
    if (absl::Status taken = Take(*result); !taken.ok()) return taken;
    return TellTimes();
  }

  // Of a simulation: the values with which the activator fires, if it does.
  absl::Status FindValues(NamedTerms* values) {
    if (absl::Status asked = AskForTimes(); !asked.ok()) return asked;
    const absl::StatusOr<Activation> activation =
        FindActivation(&*stages_, document_, recorded_.values, now_us_, &recorded_.held_since);
    if (!activation.ok()) return activation.status();
    if (activation->fires || activation->fires_us)
      values->assign(activation->values.begin(), activation->values.end());
    if (!activation->fires) NoteThatItDoesNotFire(*activation);
    return absl::OkStatus();
  }

  void NoteThatItDoesNotFire(const Activation& activation) {
    const GraphVersionPtr version = stages_->writer.Freeze(Revision(offset_));
    std::string later, missing;
    if (activation.fires_us) {
      later = absl::StrCat("if they stay so, it fires at ", DateTimeTerm(*activation.fires_us).lexical);
      missing = absl::StrCat("nothing but time: ", NotYetForLong(activation.ask), "; ", later);
    } else {
      const auto comes = NextTime(GraphReader(stages_.dictionary(), *version), activation.ask, now_us_);
      if (comes) later = absl::StrCat("its time comes at ", DateTimeTerm(*comes).lexical);
      missing = PlayQuestions(&*stages_, version, now_us_, options_.cancellation).Missing(activation.ask);
    }
    play_.waits.push_back({kActivator, activation.ask, std::move(missing)});
    play_.notes.push_back(absl::StrCat("activator ", document_.activator->name.value,
                                       " does not fire on these facts; the run is started all the same",
                                       later.empty() ? "" : "; ", later));
  }

  // The times of the activator, which is never armed in a world: the clock tells what is asked for.
  absl::Status AskForTimes() {
    WriteBatch batch;
    batch.mode = WriteBatch::Mode::kLoad;
    for (const std::string& time : TimesOfActivator(document_, options_.limits)) {
      batch.operations.push_back(
          {QuadOperation::Kind::kAdd,
           {Term::Iri(time), Term::Iri(std::string(kRdfType)), Term::Iri(DocentIri("TimeTrigger")),
            Term::Iri(std::string(kClockGraph))}});
    }
    if (batch.operations.empty()) return absl::OkStatus();
    if (auto asked = stages_.Turn(std::move(batch), offset_, now_us_); !asked.ok()) return asked.status();
    return TellTimes();
  }

  // What the activator makes of the recorded key. A firing that waited for another run (ext:mode="queued") started the run in a
  // turn in which its condition need not hold: then not that of the document that ran does either.
  absl::StatusOr<Activation> Activate() {
    absl::StatusOr<Activation> activation = FindActivation(&*stages_, document_, recorded_.values, now_us_);
    if (!activation.ok() || activation->fires || !document_.activator) return activation;
    const auto ran = ParseWorkflow(recorded_.document.text, recorded_.document.name, options_.limits);
    if (!ran.ok()) return activation;
    const absl::StatusOr<Activation> of_ran = FindActivation(&*stages_, **ran, recorded_.values, now_us_);
    if (!of_ran.ok()) return of_ran.status();
    if (of_ran->fires) return activation;
    activation->fires = true;
    activation->values = {recorded_.values.begin(), recorded_.values.end()};
    activation->note = absl::StrCat(
        "the condition of activator ", document_.activator->name.value,
        " did not hold in the turn that started the run, which had waited: it is taken to have held before");
    return activation;
  }

  // A recorded turn, with the reports that are due with it.
  absl::Status PlayTurn(const CaseTurn& turn) {
    offset_ = turn.offset;
    now_us_ = std::max(now_us_, turn.time_us);
    due_us_ = turn.due_us;
    return PlayWorld(turn);
  }

  absl::Status PlayWorld(const CaseTurn& turn) {
    WriteBatch batch = turn.batch;
    clock_.TakeTurn(turn, &batch);
    std::erase_if(batch.reports, [this](CommandReport& report) {
      std::optional<CommandReport> told = answers_.Told(report);
      if (!told || !Comes(&*told)) return true;
      report = *std::move(told);
      return false;
    });
    for (CommandReport& report : DueNow()) batch.reports.push_back(std::move(report));
    std::erase_if(batch.run_requests, [this](RunRequest& request) { return !IsAsked(&request); });
    if (is_world()) {
      if (absl::Status fits = TakeDocuments(&batch); !fits.ok()) return fits;
      if (turn.held) stages_->engine.HoldForOthers(*turn.held);
    }
    if (absl::Status taken = Take(stages_.Turn(std::move(batch), offset_, now_us_)); !taken.ok())
      return taken;
    return tree_ && clock_concerned_ ? TellTimes() : absl::OkStatus();
  }

  // In a world no activator fires, and the document of the run is the one that is tried.
  absl::Status TakeDocuments(WriteBatch* batch) const {
    std::vector<Document> documents;
    for (const Document& document : batch->documents) {
      if (document.kind == Document::Kind::kCawl && document.name == document_.name.value) continue;
      absl::StatusOr<Document> played = stages_.Played(document);
      if (!played.ok()) return played.status();
      if (document.kind == Document::Kind::kCawl && ParseName(*played) == document_.name.value) continue;
      documents.push_back(*std::move(played));
    }
    batch->documents = std::move(documents);
    return absl::OkStatus();
  }

  static std::string ParseName(const Document& document) {
    const auto* parsed = dynamic_cast<const ParsedDocument*>(document.parsed.get());
    return parsed == nullptr ? "" : parsed->cawl->name.value;
  }

  // What an operator or client asked, where it can be asked in the replay: about the run that is at the same place.
  bool IsAsked(RunRequest* request) {
    const bool is_own =
        request->target == recorded_.run.value() || recorded_.nested.contains(RunId(request->target));
    if (is_own) {
      const auto nested = recorded_.nested.find(RunId(request->target));
      const std::optional<RunId> run =
          tree_ ? tree_->RunAt(nested == recorded_.nested.end() ? "" : nested->second) : std::nullopt;
      if (run) request->target = run->value();
    }
    stages_->robots.Refresh(stages_->writer.current(), {});
    const absl::Status possible = stages_->engine.CheckRequest(*request, &stages_->robots);
    if (possible.ok()) return true;
    play_.notes.push_back(
        absl::StrCat("turn ", offset_, ": what an operator asked then is left out: ", possible.message()));
    return false;
  }

  // Turns of the replay's own before `until_us`: answers that come at other times than they were recorded, timers, and times of
  // day.
  absl::Status PlayUntil(TimeMicros until_us) {
    while (GoesOn()) {
      std::optional<TimeMicros> next;
      const auto take = [&](TimeMicros at_us) {
        if (at_us < until_us && (!next || at_us < *next)) next = at_us;
      };
      for (const DueReport& due : due_) take(due.time_us);
      if (!moves_.empty()) take(moves_.begin()->first);
      if (clock_.NextDue()) take(std::max(*clock_.NextDue(), now_us_));
      if (const std::optional<TimeMicros> timer = stages_->NextDeadline(); timer && IsOwn(*timer, until_us))
        take(std::max(*timer, now_us_));
      if (!next) break;
      if (absl::Status played = PlayOwnTurn(*next); !played.ok()) return played;
    }
    return absl::OkStatus();
  }

  // Whether the recorded turns do not take care of it: what was due in the recorded life, too, was done in them, late if the
  // server was down.
  bool IsOwn(TimeMicros timer_us, TimeMicros until_us) const {
    if (is_world()) return simulated() || std::max(timer_us, now_us_) < until_us - kLateTurn;
    return !due_us_ || timer_us < *due_us_;
  }

  absl::Status PlayOwnTurn(TimeMicros at_us) {
    now_us_ = std::max(now_us_, at_us);
    WriteBatch batch;
    batch.operations = MovesNow();
    batch.reports = DueNow();
    const std::optional<TimeMicros> timer = stages_->NextDeadline();
    batch.clock_tick = batch.reports.empty() && batch.operations.empty();
    if (!batch.clock_tick || (timer && *timer <= now_us_)) {
      if (absl::Status played = OwnTurn(std::move(batch)); !played.ok()) return played;
    }
    return TellTimes();
  }

  absl::Status OwnTurn(WriteBatch batch) {
    if (absl::Status few = CountOwn(); !few.ok()) return few;
    return Take(stages_.Turn(std::move(batch), offset_, now_us_));
  }

  absl::Status CountOwn() {
    if (++own_turns_ <= options_.replay_limits.replay_turns) return absl::OkStatus();
    return absl::ResourceExhaustedError(
        absl::StrCat("the replay has more than ", options_.replay_limits.replay_turns,
                     " turns between those that were recorded; the limit is replay_turns"));
  }

  // The clock says what it has to, until it has nothing more: what occurs is told, and taken back.
  absl::Status TellTimes() {
    while (play_.stopped.empty()) {
      if (absl::Status few = CountOwn(); !few.ok()) return few;
      WriteBatch batch;
      batch.source = kClockGraph;
      batch.mode = WriteBatch::Mode::kLoad;
      batch.operations = clock_.Tell(now_us_, stages_.dictionary(), stages_->writer.current());
      if (batch.operations.empty()) break;
      if (absl::Status told = OwnTurn(std::move(batch)); !told.ok()) return told;
    }
    return absl::OkStatus();
  }

  // A simulation behind what it was told.
  absl::Status PlayOut() {
    if (absl::Status played = PlayUntil(options_.simulated_until_us); !played.ok()) return played;
    if (!GoesOn()) return absl::OkStatus();
    std::optional<TimeMicros> next = GoesOnAt(*stages_, clock_);
    for (const DueReport& due : due_) next = std::min(next.value_or(due.time_us), due.time_us);
    if (!moves_.empty()) next = std::min(next.value_or(moves_.begin()->first), moves_.begin()->first);
    if (next) Stop("", OutOfTime(*next));
    return absl::OkStatus();
  }

  // `next_us`: when something happens next.
  std::string OutOfTime(TimeMicros next_us) const {
    const TimeMicros begin_us = recorded_.turns.front().time_us;
    const TimeMicros after_us = next_us - begin_us;
    return absl::StrCat("the simulated time ends after ", Seconds(options_.simulated_until_us - 1 - begin_us),
                        ", and the run goes on: what happens next by itself is at ",
                        DateTimeTerm(next_us).lexical, ", ", Seconds(after_us), " after the begin; ",
                        after_us > kLongestSimulation
                            ? absl::StrCat("a simulation lasts ", Seconds(kLongestSimulation), " at most")
                            : "simulate for longer to see it");
  }
  static std::string Seconds(TimeMicros us) { return absl::FormatDuration(absl::Microseconds(us)); }

  // Behind the last recorded turn: answers that are still to come, and the timers before the last of them.
  absl::Status PlayRest() {
    due_us_.reset();
    while (GoesOn() && !due_.empty()) {
      TimeMicros last = 0;
      for (const DueReport& due : due_) last = std::max(last, due.time_us);
      if (absl::Status played = PlayUntil(last + 1); !played.ok()) return played;
    }
    if (!GoesOn() || !recorded_.ended) return absl::OkStatus();
    play_.stopped =
        absl::StrCat("the recorded facts end with turn ", recorded_.last_turn, ", and the run goes on");
    play_.stopped_turn = recorded_.last_turn;
    return absl::OkStatus();
  }

  // Poses of simulated robots that are due, as these tell them.
  std::vector<QuadOperation> MovesNow() {
    std::vector<QuadOperation> told;
    while (!moves_.empty() && moves_.begin()->first <= now_us_) {
      const SimulatedPose& pose = moves_.begin()->second;
      const Term robot = Term::Iri(pose.robot.value());
      for (const auto& [property, metres] : {std::pair("x", pose.x_m), std::pair("y", pose.y_m)}) {
        const Term value = Term::Literal(absl::StrFormat("%.3f", metres), std::string(kXsdDecimal));
        told.push_back({QuadOperation::Kind::kAdd, {robot, Term::Iri(DocentIri(property)), value, robot}});
      }
      if (!pose.place.empty()) {
        const Term place = Term::Iri(pose.place);
        told.push_back({QuadOperation::Kind::kAdd, {robot, Term::Iri(DocentIri("isAt")), place, robot}});
      }
      play_.poses.push_back(pose);
      moves_.erase(moves_.begin());
    }
    return told;
  }

  // The reports that are due; they are so no longer.
  std::vector<CommandReport> DueNow() {
    std::stable_sort(due_.begin(), due_.end(),
                     [](const DueReport& a, const DueReport& b) { return a.time_us < b.time_us; });
    std::vector<CommandReport> now;
    std::erase_if(due_, [&](DueReport& due) {
      if (due.time_us > now_us_) return false;
      if (Comes(&due.report)) now.push_back(std::move(due.report));
      return true;
    });
    return now;
  }

  // False: the recorded run had cancelled the command, and this one has not.
  bool Comes(CommandReport* report) {
    const bool cancelled = report->outcome == CommandReport::Outcome::kCancelled ||
                           report->outcome == CommandReport::Outcome::kNotBegun;
    if (!cancelled || !answers_.WasCancelled(report->command) || cancelled_.contains(report->command))
      return true;
    if (options_.assume_done) {
      report->outcome = CommandReport::Outcome::kSucceeded;
      return true;
    }
    Stop(nodes_[report->command],
         "the recorded run cancelled its command, which this one does not: how it would end is not known");
    return false;
  }

  absl::Status Take(const absl::StatusOr<TurnResult>& result) {
    if (!result.ok()) return result.status();
    return Take(*result);
  }

  // What the turn decided: commands are answered from what was recorded.
  absl::Status Take(const TurnResult& result) {
    clock_concerned_ = clock_.IsConcerned(now_us_, stages_.dictionary(), result.delta);
    if (!tree_) return absl::OkStatus();
    tree_->Observe(result);
    std::vector<Decision> decisions;
    AddDecisions(result, offset_, *tree_, &decisions);
    for (Decision& decision : decisions) {
      if (decision.kind == Decision::Kind::kCommand) Answer(decision);
      if (decision.kind == Decision::Kind::kCancel) Cancel(decision.command);
      if (decision.kind == Decision::Kind::kState && decision.node.empty()) {
        begun_ = true;
        ended_ = IsFinalState(decision.to);
      }
      play_.course.decisions.push_back(std::move(decision));
    }
    for (const RobotCommand& command : result.record.commands) {
      if (!tree_->PathOf(command.id.value())) answers_.AnswerOther(command, now_us_, &due_);
    }
    return absl::OkStatus();
  }

  void Answer(const Decision& command) {
    nodes_[command.command] = command.node;
    if (simulated()) return Simulate(command);
    if (answers_.Answer(command, &due_)) return;
    if (!options_.assume_done && command.operation != kNotifies) {
      return Stop(command.node, absl::StrCat("there is no recorded report of ", Show(command),
                                             ", which the recorded run did not send; the replay ends here"));
    }
    CommandReport done;
    done.command = command.command;
    done.outcome = CommandReport::Outcome::kSucceeded;
    done.progress = 1;
    due_.push_back({now_us_, std::move(done)});
    if (command.operation != kNotifies)
      play_.notes.push_back(absl::StrCat("turn ", offset_, ": there is no recorded report of ", Show(command),
                                         ", which is taken to have succeeded at once"));
  }

  void Simulate(const Decision& command) {
    CommandReport done;
    done.command = command.command;
    done.outcome = CommandReport::Outcome::kSucceeded;
    done.progress = 1;
    SimulatedCommand simulated;
    simulated.ends_us = now_us_;
    if (command.operation != kNotifies)
      simulated = SimulateCommand(command, stages_.dictionary(), stages_->writer.current());
    for (const SimulatedPose& pose : simulated.poses) moves_.emplace(pose.time_us, pose);
    due_.push_back({simulated.ends_us, std::move(done)});
  }

  void Cancel(const CommandId& command) {
    std::erase_if(moves_, [&command](const auto& move) { return move.second.command == command; });
    cancelled_.insert(command);
    if (answers_.WasCancelled(command)) return;
    answers_.Drop(command);
    std::erase_if(due_, [&](const DueReport& due) { return due.report.command == command; });
    CommandReport report;
    report.command = command;
    report.outcome = CommandReport::Outcome::kCancelled;
    due_.push_back({now_us_, std::move(report)});
  }

  void Stop(const std::string& node, std::string why) {
    if (!play_.stopped.empty()) return;
    play_.stopped = std::move(why);
    play_.stopped_node = node;
    play_.stopped_turn = offset_;
  }

  absl::StatusOr<Play> End() {
    const GraphVersionPtr version = stages_->writer.Freeze(Revision(offset_));
    if (tree_) ReadEnd(stages_.dictionary(), *version, root_, &play_.course);
    PlayQuestions questions(&*stages_, version, now_us_, options_.cancellation);
    if (!activation_ask_.empty())
      play_.waits.push_back({kActivator, activation_ask_, questions.Missing(activation_ask_)});
    if (tree_ && !ended_) {
      questions.AddWaits(*tree_, &play_.waits);
      play_.pending = questions.Pending(*tree_);
    }
    return std::move(play_);
  }

  const RunCase& recorded_;
  const cawl::DocumentPtr given_;
  const cawl::Document& document_;
  const PlayOptions& options_;
  AnswerBook answers_;
  PlayedClock clock_;
  PlayStages stages_;
  RunId root_;
  std::optional<RunTree> tree_;
  std::vector<DueReport> due_;
  std::multimap<TimeMicros, SimulatedPose> moves_;
  std::map<CommandId, std::string> nodes_;
  std::set<CommandId> cancelled_;
  std::string activation_ask_;
  uint64_t offset_ = 0;
  TimeMicros now_us_ = 0;
  std::optional<TimeMicros> due_us_;  // as recorded, after the turn that was played last
  size_t own_turns_ = 0;
  bool clock_concerned_ = false;
  bool begun_ = false;
  bool ended_ = false;
  Play play_;
};

absl::Status CheckFits(const RunCase& recorded, const cawl::Document& document) {
  if (document.name.value != recorded.workflow) {
    return absl::InvalidArgumentError(absl::StrCat("the document is of workflow ", document.name.value,
                                                   ", and run ", recorded.run.value(), " is of ",
                                                   recorded.workflow, "; give a document of that workflow"));
  }
  if (!recorded.asked || document.FindFlow(recorded.flow) != nullptr) return absl::OkStatus();
  std::vector<std::string> flows;
  for (const cawl::Flow& flow : document.flows) flows.push_back(flow.name.value);
  const std::string near = Nearest(recorded.flow, flows);
  return absl::InvalidArgumentError(
      absl::StrCat("workflow ", document.name.value, " has no flow ", recorded.flow, ", which run ",
                   recorded.run.value(), " was asked to run; it has ", absl::StrJoin(flows, ", "),
                   near.empty() ? "" : absl::StrCat("; is it now ", near, "?")));
}

}  // namespace

void AddAlternative(const PlayedWait& wait, std::string* waits_for, std::string* missing) {
  absl::StrAppend(waits_for, waits_for->empty() ? "" : "\n# or\n", wait.ask);
  if (!wait.missing.empty()) absl::StrAppend(missing, missing->empty() ? "" : " or ", wait.missing);
}

absl::StatusOr<Play> PlayCase(const RunCase& recorded, const cawl::DocumentPtr& document,
                              const PlayOptions& options) {
  if (absl::Status fits = CheckFits(recorded, *document); !fits.ok()) return fits;
  return Player(recorded, document, options).Run();
}

}  // namespace docent::server
