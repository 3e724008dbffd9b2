#include "kb_server/replay/case_player.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/replay/answer_book.h"
#include "kb_server/replay/play_questions.h"
#include "kb_server/replay/played_document.h"
#include "kb_server/replay/run_course.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/turn/turn.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {
namespace {

// A timer that the recorded server noticed with a turn of its own goes off with that turn, which was a little later.
constexpr TimeMicros kLateTurn = 1'000'000;
constexpr size_t kFactsOfTurn = 20000;  // of those before the run

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
        document_(*document),
        options_(options),
        answers_(recorded),
        stages_(&dictionary_, options.functions, options.limits) {
    stages_.freezes = false;
    stages_.cancellation = options.cancellation;
  }

  absl::StatusOr<Play> Run() {
    if (absl::Status ready = SetUp(); !ready.ok()) return ready;
    if (absl::Status begun = Begin(recorded_.turns.front()); !begun.ok()) return begun;
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
  bool GoesOn() const { return tree_.has_value() && !ended_ && play_.stopped.empty(); }

  // Facts and documents before the first turn.
  absl::Status SetUp() {
    if (recorded_.turns.empty()) return absl::InvalidArgumentError("the recorded run has no turns");
    engine::EngineState state;
    state.next_run = recorded_.number;
    stages_.engine.Restore(std::move(state));
    stages_.Commit();
    offset_ = recorded_.turns.front().offset - 1;
    now_us_ = recorded_.turns.front().time_us;
    std::vector<const Document*> rules, others;
    for (const Document& document : recorded_.documents)
      (document.kind == Document::Kind::kRules ? rules : others).push_back(&document);
    if (absl::Status put = PutDocuments(rules); !put.ok()) return put;
    for (const bool modules : {true, false}) {  // ontologies first: rules follow the schema
      if (absl::Status loaded = Load(modules); !loaded.ok()) return loaded;
    }
    if (absl::Status put = PutDocuments(others); !put.ok()) return put;
    WriteBatch own;
    own.documents.push_back({Document::Kind::kCawl, Document::Action::kPut, document_.name.value,
                             document_.source,
                             std::make_shared<const ParsedDocument>(WithoutFiring(document_))});
    if (auto deployed = Turn(std::move(own)); !deployed.ok()) return deployed.status();
    stages_.engine.HoldForOthers(recorded_.held);
    return absl::OkStatus();
  }

  // Facts of modules of ontology, or the others, in turns of a bounded length.
  absl::Status Load(bool modules) {
    WriteBatch batch;
    const auto load = [&] {
      batch.mode = WriteBatch::Mode::kLoad;
      return Turn(std::exchange(batch, {})).status();
    };
    for (const TermQuad& fact : recorded_.facts) {
      if (IsModuleGraph(fact.graph.lexical) != modules) continue;
      batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
      if (batch.operations.size() < kFactsOfTurn) continue;
      if (absl::Status loaded = load(); !loaded.ok()) return loaded;
    }
    return batch.operations.empty() ? absl::OkStatus() : load();
  }

  // One after the other: a process may contain one of a document that comes later.
  absl::Status PutDocuments(std::vector<const Document*> left) {
    std::erase_if(left, [this](const Document* document) {
      return document->kind == Document::Kind::kCawl && document->name == document_.name.value;
    });
    absl::Status refused;
    for (size_t before = left.size() + 1; !left.empty() && left.size() < before;) {
      before = left.size();
      std::erase_if(left, [&](const Document* document) {
        WriteBatch batch;
        absl::StatusOr<Document> played = Played(*document);
        if (played.ok()) batch.documents.push_back(*std::move(played));
        refused = played.status();
        if (refused.ok()) refused = Turn(std::move(batch)).status();
        return refused.ok();
      });
      if (absl::Status over = options_.cancellation->CheckNow(); !over.ok()) return over;
    }
    return left.empty() ? absl::OkStatus() : refused;
  }

  absl::StatusOr<Document> Played(const Document& document) const {
    Document played = document;
    if (document.kind != Document::Kind::kCawl || document.action != Document::Action::kPut) return played;
    auto parsed = ParseWorkflow(document.text, document.name, options_.limits);
    if (!parsed.ok()) return parsed.status();
    played.parsed = std::make_shared<const ParsedDocument>(WithoutFiring(**parsed));
    return played;
  }

  // The facts of the first turn, then the run on them.
  absl::Status Begin(const CaseTurn& first) {
    offset_ = first.offset;
    if (absl::Status told = PlayWorld(first, {}); !told.ok()) return told;
    RunRequest start;
    start.kind = RunRequest::Kind::kStart;
    std::string flow = recorded_.flow;
    if (recorded_.asked) {
      start.arguments = recorded_.values;
    } else {
      absl::StatusOr<Activation> activation = Activate();
      if (!activation.ok()) return activation.status();
      if (!activation->note.empty()) play_.notes.push_back(activation->note);
      if (!activation->fires) {
        Stop(kActivator, activation->why_not);
        activation_ask_ = activation->ask;
        return absl::OkStatus();
      }
      start.arguments.assign(activation->values.begin(), activation->values.end());
      flow = document_.activator->flow.value;
    }
    if (simulated() && document_.activator && flow == document_.activator->flow.value) {
      if (absl::Status found = FindValues(&start.arguments); !found.ok()) return found;
    }
    start.target = absl::StrCat(document_.name.value, "/", flow);
    WriteBatch batch;
    batch.run_requests.push_back(std::move(start));
    absl::StatusOr<TurnResult> result = Turn(std::move(batch));
    if (!result.ok()) return result.status();
    root_ = result->started.at(0);
    tree_.emplace(root_, &dictionary_);
    return Take(*result);
  }

  // Of a simulation: the values with which the activator fires, if it does.
  absl::Status FindValues(NamedTerms* values) {
    const absl::StatusOr<Activation> activation =
        FindActivation(&stages_, document_, recorded_.values, now_us_);
    if (!activation.ok()) return activation.status();
    if (activation->fires) {
      values->assign(activation->values.begin(), activation->values.end());
      return absl::OkStatus();
    }
    PlayQuestions questions(&stages_, stages_.writer.Freeze(Revision(offset_)), now_us_,
                            options_.cancellation);
    play_.waits.push_back({kActivator, activation->ask, questions.Missing(activation->ask)});
    play_.notes.push_back(absl::StrCat("activator ", document_.activator->name.value,
                                       " does not fire on these facts; the run is started all the same"));
    return absl::OkStatus();
  }

  // What the activator makes of the recorded key. A firing that waited for another run (ext:mode="queued") started the run in a
  // turn in which its condition need not hold: then not that of the document that ran does either.
  absl::StatusOr<Activation> Activate() {
    absl::StatusOr<Activation> activation = FindActivation(&stages_, document_, recorded_.values, now_us_);
    if (!activation.ok() || activation->fires || !document_.activator) return activation;
    const auto ran = ParseWorkflow(recorded_.document.text, recorded_.document.name, options_.limits);
    if (!ran.ok()) return activation;
    const absl::StatusOr<Activation> of_ran = FindActivation(&stages_, **ran, recorded_.values, now_us_);
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
    return PlayWorld(turn, DueNow());
  }

  absl::Status PlayWorld(const CaseTurn& turn, std::vector<CommandReport> reports) {
    WriteBatch batch;
    batch.mode = simulated() ? WriteBatch::Mode::kAssert : WriteBatch::Mode::kLoad;
    batch.operations = turn.changes;
    batch.reports = std::move(reports);
    for (const Document& document : turn.documents) {
      if (document.kind == Document::Kind::kCawl && document.name == document_.name.value) continue;
      absl::StatusOr<Document> played = Played(document);
      if (!played.ok()) return played.status();
      if (document.kind == Document::Kind::kCawl && ParseName(*played) == document_.name.value) continue;
      batch.documents.push_back(*std::move(played));
    }
    for (const CaseRequest& request : turn.requests) AddRequest(request, &batch);
    if (turn.held) stages_.engine.HoldForOthers(*turn.held);
    return Take(Turn(std::move(batch)));
  }

  static std::string ParseName(const Document& document) {
    const auto* parsed = dynamic_cast<const ParsedDocument*>(document.parsed.get());
    return parsed == nullptr ? "" : parsed->cawl->name.value;
  }

  // What an operator asked of the recorded run, where it can be asked of this one.
  void AddRequest(const CaseRequest& request, WriteBatch* batch) {
    using Kind = RunRequest::Kind;
    RunRequest played = request.request;
    if (played.kind == Kind::kPauseWorkflow || played.kind == Kind::kResumeWorkflow) {
      played.target = document_.name.value;
    } else if (played.kind != Kind::kCancelCommands) {
      const std::optional<RunId> run = tree_ ? tree_->RunAt(request.run) : std::nullopt;
      if (run) played.target = run->value();
    }
    const absl::Status possible = stages_.engine.CheckRequest(played);
    if (possible.ok())
      batch->run_requests.push_back(std::move(played));
    else
      play_.notes.push_back(
          absl::StrCat("turn ", offset_, ": what an operator asked then is left out: ", possible.message()));
  }

  // Turns of the replay's own before `until_us`: answers that come at other times than they were recorded, and timers.
  absl::Status PlayUntil(TimeMicros until_us) {
    while (GoesOn()) {
      std::optional<TimeMicros> next;
      for (const DueReport& due : due_) {
        if (due.offset == 0 && due.time_us < until_us && (!next || due.time_us < *next)) next = due.time_us;
      }
      if (!moves_.empty() && moves_.begin()->first < until_us)
        next = std::min(next.value_or(moves_.begin()->first), moves_.begin()->first);
      if (const std::optional<TimeMicros> timer = stages_.NextDeadline()) {
        const TimeMicros at = std::max(*timer, now_us_);
        if (at < until_us - kLateTurn && (!next || at < *next)) next = at;
      }
      if (!next) break;
      if (absl::Status played = PlayOwnTurn(*next); !played.ok()) return played;
    }
    return absl::OkStatus();
  }

  absl::Status PlayOwnTurn(TimeMicros at_us) {
    if (++own_turns_ > options_.replay_limits.replay_turns) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the replay has more than ", options_.replay_limits.replay_turns,
                       " turns between those that were recorded; the limit is replay_turns"));
    }
    now_us_ = std::max(now_us_, at_us);
    WriteBatch batch;
    batch.operations = MovesNow();
    batch.reports = DueNow();
    batch.clock_tick = batch.reports.empty() && batch.operations.empty();
    return Take(Turn(std::move(batch)));
  }

  // A simulation behind what it was told.
  absl::Status PlayOut() {
    if (absl::Status played = PlayUntil(options_.simulated_until_us); !played.ok()) return played;
    if (GoesOn() && (!due_.empty() || !moves_.empty())) {
      play_.stopped = "the simulation has come to its end, and the run goes on";
      play_.stopped_turn = offset_;
    }
    return absl::OkStatus();
  }

  // Behind the last recorded turn: answers that are still to come, and the timers before the last of them.
  absl::Status PlayRest() {
    while (GoesOn() && !due_.empty()) {
      TimeMicros last = 0;
      for (DueReport& due : due_) {
        due.offset = 0;
        last = std::max(last, due.time_us);
      }
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
      const bool is_due = due.offset != 0 ? due.offset <= offset_ : due.time_us <= now_us_;
      if (!is_due) return false;
      const bool cancelled = due.report.outcome == CommandReport::Outcome::kCancelled;
      if (cancelled && answers_.WasCancelled(due.report.command) &&
          !cancelled_.contains(due.report.command)) {
        if (!options_.assume_done) {
          Stop(nodes_[due.report.command],
               "the recorded run cancelled its command, which this one does not: how it would end is not "
               "known");
          return true;
        }
        due.report.outcome = CommandReport::Outcome::kSucceeded;
      }
      now.push_back(std::move(due.report));
      return true;
    });
    return now;
  }

  absl::StatusOr<TurnResult> Turn(WriteBatch batch) {
    if (absl::Status over = options_.cancellation->CheckNow(); !over.ok()) return over;
    batch.time_us = now_us_;
    absl::StatusOr<TurnResult> result = RunTurn(&stages_, std::move(batch), offset_);
    if (result.ok()) return result;
    const absl::Status& status = result.status();
    if (status.code() == absl::StatusCode::kCancelled || status.code() == absl::StatusCode::kDeadlineExceeded)
      return status;
    return absl::Status(status.code(), absl::StrCat("turn ", offset_, " of the replay: ", status.message()));
  }

  absl::Status Take(const absl::StatusOr<TurnResult>& result) {
    if (!result.ok()) return result.status();
    return Take(*result);
  }

  // What the turn decided: commands are answered from what was recorded.
  absl::Status Take(const TurnResult& result) {
    if (!tree_) return absl::OkStatus();
    tree_->Observe(result.delta);
    std::vector<Decision> decisions;
    AddDecisions(result, offset_, *tree_, &decisions);
    for (Decision& decision : decisions) {
      if (decision.kind == Decision::Kind::kCommand) Answer(decision);
      if (decision.kind == Decision::Kind::kCancel) Cancel(decision.command);
      if (decision.kind == Decision::Kind::kState && decision.node.empty())
        ended_ = IsFinalState(decision.to);
      play_.course.decisions.push_back(std::move(decision));
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
    due_.push_back({0, now_us_, std::move(done)});
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
      simulated = SimulateCommand(command, dictionary_, stages_.writer.current());
    for (const SimulatedPose& pose : simulated.poses) moves_.emplace(pose.time_us, pose);
    due_.push_back({0, simulated.ends_us, std::move(done)});
  }

  void Cancel(const CommandId& command) {
    std::erase_if(moves_, [&command](const auto& move) { return move.second.command == command; });
    cancelled_.insert(command);
    if (answers_.WasCancelled(command)) return;
    const size_t open =
        std::erase_if(due_, [&](const DueReport& due) { return due.report.command == command; });
    if (open == 0) return;
    CommandReport report;
    report.command = command;
    report.outcome = CommandReport::Outcome::kCancelled;
    due_.push_back({0, now_us_, std::move(report)});
  }

  void Stop(const std::string& node, std::string why) {
    if (!play_.stopped.empty()) return;
    play_.stopped = std::move(why);
    play_.stopped_node = node;
    play_.stopped_turn = offset_;
  }

  absl::StatusOr<Play> End() {
    const GraphVersionPtr version = stages_.writer.Freeze(Revision(offset_));
    if (tree_) ReadEnd(dictionary_, *version, root_, &play_.course);
    PlayQuestions questions(&stages_, version, now_us_, options_.cancellation);
    if (!activation_ask_.empty())
      play_.waits.push_back({kActivator, activation_ask_, questions.Missing(activation_ask_)});
    if (tree_ && !ended_) {
      questions.AddWaits(*tree_, &play_.waits);
      play_.pending = questions.Pending(*tree_);
    }
    return std::move(play_);
  }

  const RunCase& recorded_;
  const cawl::Document& document_;
  const PlayOptions& options_;
  AnswerBook answers_;
  Dictionary dictionary_;
  Stages stages_;
  RunId root_;
  std::optional<RunTree> tree_;
  std::vector<DueReport> due_;
  std::multimap<TimeMicros, SimulatedPose> moves_;
  std::map<CommandId, std::string> nodes_;
  std::set<CommandId> cancelled_;
  std::string activation_ask_;
  uint64_t offset_ = 0;
  TimeMicros now_us_ = 0;
  size_t own_turns_ = 0;
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

absl::StatusOr<Play> PlayCase(const RunCase& recorded, const cawl::DocumentPtr& document,
                              const PlayOptions& options) {
  if (absl::Status fits = CheckFits(recorded, *document); !fits.ok()) return fits;
  return Player(recorded, document, options).Run();
}

}  // namespace docent::server
