// Compensation: what done nodes did is undone by their ext:compensate, the last first, when the run fails or is cancelled so.
// It begins when it is known how the run's commands have ended: what succeeds all the same, after it was cancelled, is done.
// Each step is a run of its own, nested in this one, so it waits for its robot and holds it as all others. One that fails is
// noted, and the others go on.
#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"

namespace docent::engine {
namespace {

constexpr char kRobotVariable[] = "robot";

std::string Shown(const std::string& place, const std::string& operation) {
  return absl::StrCat(place, " (", operation, ")");
}

bool IsLate(const InvocationState& invocation) {
  return invocation.state != WorkState::kDone && !invocation.late.empty();
}

// What the invocations of one binding did, with the operation that undoes it if they are all done. nullopt: nothing, as far as
// it is known.
std::optional<DoneStep> StepOf(const std::string& place, const std::string& operation,
                               const TermBinding& variables, std::span<const InvocationState> invocations) {
  DoneStep step;
  bool all = true, some = false, unknown = false;
  for (const InvocationState& invocation : invocations) {
    const bool done = invocation.state == WorkState::kDone;
    all = all && done;
    some = some || IsPartlyDone(invocation);
    unknown = unknown || (!done && invocation.unknown);
  }
  if (!some && !unknown) return std::nullopt;
  if (all)
    step.operation = operation;
  else
    step.stays = unknown ? "how it ended is unknown" : "only a part of it was done";
  step.place = place;
  step.variables = variables;
  for (const InvocationState& invocation : invocations) {
    for (const auto& [name, value] : GivenTo(invocation)) step.variables[name] = value;
    for (const auto& [name, value] : invocation.results) step.variables[name] = value;
  }
  std::erase_if(step.variables, [](const auto& variable) { return variable.second == kNoValue; });
  if (!invocations.front().robot.empty())
    step.variables[kRobotVariable] = Term::Iri(invocations.front().robot.value());
  return step;
}

// Names of nodes that are told at most.
constexpr size_t kNodesShown = 5;

// "Grip, Look: no ext:compensate"
void AddStaying(const std::set<std::string>& nodes, const char* why, std::vector<std::string>* not_undone) {
  if (nodes.empty()) return;
  std::vector<std::string> names(nodes.begin(), nodes.end());
  if (names.size() > kNodesShown) {
    names.resize(kNodesShown);
    names.push_back(absl::StrCat(nodes.size() - kNodesShown, " more"));
  }
  not_undone->push_back(absl::StrCat(absl::StrJoin(names, ", "), ": ", why));
}

}  // namespace

bool IsPartlyDone(const InvocationState& invocation) {
  if (invocation.state == WorkState::kDone || invocation.partly_done) return true;
  if (!invocation.handler) return false;
  for (int step = 1; step <= static_cast<int>(invocation.handler->plan().steps.size()); ++step) {
    if (invocation.handler->step_state(step) == rsel::InstructionHandler::StepState::kDone) return true;
  }
  return false;
}

// What the node did, once: when it is done, and when it comes to another end. For each binding of forEach whose invocations are
// all done there is something to undo. Where some of them are done and others not, it is only noted that this is not undone; where
// commands of it are ending, that is known when they have ended. Of a node that an operator skipped there is nothing to undo.
// `late_only`: only the latter.
void RunStepper::NoteDone(size_t index, bool late_only) {
  const cawl::Node& syntax = flow_.nodes[index];
  const std::span<InvocationState> all = run_.nodes[index].invocations;
  if (syntax.compensate.value.empty() || syntax.invokes.empty()) {
    const bool did_something = std::any_of(all.begin(), all.end(), [&](const InvocationState& invocation) {
      return !syntax.invokes[invocation.invoke].operation.value.empty() &&
             (IsPartlyDone(invocation) || invocation.unknown);
    });
    if (did_something) run_.not_compensated.insert(syntax.name.value);
    return;
  }
  for (size_t first = 0; first + syntax.invokes.size() <= all.size(); first += syntax.invokes.size()) {
    const std::span<InvocationState> of_one = all.subspan(first, syntax.invokes.size());
    if (std::any_of(of_one.begin(), of_one.end(), IsLate)) {
      run_.late_steps.push_back({syntax.name.value,
                                 syntax.compensate.value,
                                 run_.variables,
                                 {of_one.begin(), of_one.end()},
                                 run_.document,
                                 run_.flow,
                                 index});
      for (InvocationState& invocation : of_one) invocation.late.clear();
    } else if (!late_only) {
      auto step = StepOf(syntax.name.value, syntax.compensate.value, run_.variables, of_one);
      if (!step) continue;
      step->done_us = core_.input->now_us;
      run_.done_steps.push_back(*std::move(step));
    }
  }
}

// The command is one that an invocation here no longer waited for, and `report` is its final one: what succeeded all the same is
// done. False: it is of none.
bool RunStepper::TakeLate(const EndingCommand& ended, const CommandReport& report) {
  const CommandOwner& sender = ended.owners.front();
  const auto take = [&](InvocationState& invocation) {
    const auto late = std::find_if(invocation.late.begin(), invocation.late.end(),
                                   [&](const LateCommand& each) { return each.id == report.command; });
    if (late == invocation.late.end()) return false;
    const int step = late->step;
    invocation.late.erase(late);
    if (report.outcome == CommandReport::Outcome::kUnknown) invocation.unknown = true;
    const bool goes_on = invocation.state == WorkState::kRunning && invocation.overdue.empty();
    if (report.outcome == CommandReport::Outcome::kSucceeded && invocation.handler && !goes_on) {
      invocation.handler->SucceededLate(step, {report.results.begin(), report.results.end()});
      invocation.partly_done = true;
    }
    return true;
  };
  const auto is_done = [](const InvocationState& invocation) {
    return invocation.state != WorkState::kDone && invocation.handler &&
           invocation.handler->state() == rsel::InstructionHandler::State::kDone;
  };
  for (auto step = run_.late_steps.begin(); step != run_.late_steps.end(); ++step) {
    const auto found = std::find_if(step->invocations.begin(), step->invocations.end(), take);
    if (found == step->invocations.end()) continue;
    if (is_done(*found)) {
      const rsel::Arguments given = found->handler->Results();
      found->state = WorkState::kDone;
      found->robot = ended.command.robot;
      std::string note;
      found->results = ResultsAt({*step->document, step->document->flows[step->flow],
                                  &step->document->flows[step->flow].nodes[step->node]},
                                 found->invoke, TermBinding(given.begin(), given.end()), &note);
      if (!note.empty()) core_.Say(ended.invocation, "ending", "ending", note);
    }
    SettleLate(step);
    return true;
  }
  if (sender.run != run_.id || sender.node >= run_.nodes.size() ||
      sender.invocation >= run_.nodes[sender.node].invocations.size())
    return false;
  NodeState& node = run_.nodes[sender.node];
  InvocationState& invocation = node.invocations[sender.invocation];
  if (!take(invocation)) return false;
  // An attempt whose end is waited for sees it itself (BeginAgain).
  if (!IsLive(node.state) || !invocation.overdue.empty() || !is_done(invocation)) return true;
  invocation.robot = ended.command.robot;
  const rsel::Arguments given = invocation.handler->Results();
  std::string note;
  const TermBinding results =
      ResultsOf(sender.node, sender.invocation, TermBinding(given.begin(), given.end()), &note);
  SetInvocation(sender.node, sender.invocation, WorkState::kDone,
                Concat("it succeeded all the same", note.empty() ? "" : "; ", note));
  if (node.state == WorkState::kRunning) SetVariables(results);  // last: it may end the run
  return true;
}

// When all commands of the step have ended, it becomes a done step, or nothing of it was done.
void RunStepper::SettleLate(std::vector<LateStep>::iterator late) {
  if (std::any_of(late->invocations.begin(), late->invocations.end(), IsLate)) return;
  auto step = StepOf(late->place, late->operation, late->variables, late->invocations);
  run_.late_steps.erase(late);
  if (!step) return;
  step->done_us = core_.input->now_us;
  (run_.undoing ? run_.undoing->left : run_.done_steps).push_back(*std::move(step));
}

// Whether commands of the run are ending whose outcome may be known soon: what is undone is undone after them. A robot that is
// out of reach is not waited for. `*until_us`: when that has been long enough.
bool RunStepper::AwaitsOutcomes(TimeMicros* until_us) const {
  bool awaits = false;
  for (const auto& [id, ending] : core_.ledger.ending()) {
    const bool of_run =
        std::any_of(ending.owners.begin(), ending.owners.end(), [this](const CommandOwner& owner) {
          return owner.run == run_.id && owner.node < run_.nodes.size();  // those that undo have no node
        });
    if (!of_run) continue;
    const TimeMicros until = ending.since_us + core_.limits.default_step_timeout_ms * int64_t{1000};
    if (until <= core_.input->now_us) continue;
    *until_us = awaits ? std::min(*until_us, until) : until;
    const RobotOffer* offer = core_.OfferOf(ending.command.operation, ending.command.robot);
    awaits = awaits || (offer != nullptr && !offer->offline);
  }
  return awaits;
}

// Those of a sub-flow that ended, and that were not undone with it.
void RunStepper::TakeDoneSteps(const RunId& id) {
  Run* child = core_.Mutable(id);
  for (DoneStep& step : std::exchange(child->done_steps, {})) {
    step.place = absl::StrCat(id.value(), "/", step.place);
    run_.done_steps.push_back(std::move(step));
  }
  for (LateStep& step : std::exchange(child->late_steps, {})) {
    step.place = absl::StrCat(id.value(), "/", step.place);
    run_.late_steps.push_back(std::move(step));
  }
  if (child->parent_node >= flow_.nodes.size()) return;  // it undid something
  const cawl::Node& caller = flow_.nodes[child->parent_node];
  for (const std::string& node : child->told_for_good)
    run_.told_for_good.insert(absl::StrCat(caller.name.value, "/", node));
  if (!caller.compensate.value.empty()) return;
  for (const std::string& node : child->not_compensated)
    run_.not_compensated.insert(absl::StrCat(caller.name.value, "/", node));
}

// This run has those of the runs that are nested in it, which keep none.
void RunStepper::GatherDoneSteps() {
  const auto nested = core_.nested.find(run_.id);
  for (const RunId& id : nested == core_.nested.end() ? std::set<RunId>() : nested->second) {
    RunStepper(&core_, core_.Mutable(id)).GatherDoneSteps();
    TakeDoneSteps(id);
  }
  std::stable_sort(run_.done_steps.begin(), run_.done_steps.end(),
                   [](const DoneStep& a, const DoneStep& b) { return a.done_us < b.done_us; });
}

// What is under way is cancelled, and what is done is undone; then the run ends as `outcome`. False: there is nothing to undo.
bool RunStepper::BeginUndo(WorkState outcome, const std::string& reason) {
  run_.undoing = Undoing{outcome, reason, {}, {}, {}, {}};  // first: what is cancelled below must not go on
  for (size_t i = 0; i < run_.nodes.size(); ++i) CancelNode(i, reason);
  GatherDoneSteps();
  if (run_.done_steps.empty() && run_.late_steps.empty()) {
    run_.undoing.reset();
    return false;
  }
  run_.undoing->left = std::exchange(run_.done_steps, {});
  run_.reason = absl::StrCat(reason, "; what it did is being undone");
  core_.Say(run_.id.value(), "running", "running", run_.reason);
  core_.touched.insert(run_.id);
  return true;
}

void RunStepper::EndAndUndo(WorkState outcome, const std::string& reason) {
  if (GoesOn() && !BeginUndo(outcome, reason)) End(outcome, reason);
}

// The next step to be undone, if none is under way.
void RunStepper::Undo() {
  Undoing& undoing = *run_.undoing;
  TimeMicros until_us = 0;
  if (run_.paused() || !undoing.child.empty() || AwaitsOutcomes(&until_us)) return;
  core_.advanced.insert(run_.id);
  for (; !undoing.left.empty() && undoing.left.back().operation.empty(); undoing.left.pop_back()) {
    const DoneStep& step = undoing.left.back();
    undoing.failed.push_back(
        absl::StrCat(step.place, ": ", step.stays.empty() ? "only a part of it was done" : step.stays));
  }
  if (undoing.left.empty()) return End(undoing.outcome, std::string(undoing.reason));
  const DoneStep step = std::move(undoing.left.back());
  undoing.left.pop_back();
  undoing.current = Shown(step.place, step.operation);
  const CommandOwner owner{run_.id, run_.nodes.size(), 0};  // no node of the flow
  const RunId child = core_.Start(ServiceWorkflow(step.operation), 0, step.variables,
                                  absl::StrCat("undoes ", run_.id.value(), "/", step.place), &owner);
  run_.undoing->child = child;
}

// True if the child was a step that undoes something.
bool RunStepper::StepUndone(const Run& child) {
  if (!run_.undoing) return false;
  Undoing& undoing = *run_.undoing;
  if (undoing.child != child.id) return true;  // it was cancelled with this run
  if (child.state == WorkState::kDone)
    undoing.undid = true;
  else
    undoing.failed.push_back(absl::StrCat(undoing.current, ": ", child.reason));
  undoing.child = RunId();
  undoing.current.clear();
  return true;
}

// What could not be undone is told with the reason of the run's end. The run that it is nested in knows of it, and of what was
// not tried.
std::string RunStepper::EndUndoing(const std::string& reason) {
  Undoing undoing = *std::move(run_.undoing);
  run_.undoing.reset();
  if (!undoing.child.empty()) core_.Cancel(undoing.child, reason);
  std::vector<std::string> not_undone = std::move(undoing.failed);
  if (!undoing.current.empty()) not_undone.push_back(absl::StrCat(undoing.current, ": it was cancelled"));
  for (const std::string& failed : not_undone) {
    const size_t end = failed.find(": ");
    DoneStep step;
    step.place = failed.substr(0, end);
    step.stays = failed.substr(end + 2);
    step.done_us = core_.input->now_us;
    run_.done_steps.push_back(std::move(step));
  }
  for (auto step = undoing.left.rbegin(); step != undoing.left.rend(); ++step)
    not_undone.push_back(step->operation.empty()
                             ? absl::StrCat(step->place, ": ", step->stays)
                             : absl::StrCat(Shown(step->place, step->operation), ": it was not tried"));
  std::move(undoing.left.begin(), undoing.left.end(), std::back_inserter(run_.done_steps));
  for (const LateStep& late : run_.late_steps)
    not_undone.push_back(absl::StrCat(Shown(late.place, late.operation), ": how it ends is not known yet"));
  if (undoing.undid || !not_undone.empty()) {
    AddStaying(run_.not_compensated, "no ext:compensate", &not_undone);
    AddStaying(run_.told_for_good, "what was told, withdrawn or notified stays so", &not_undone);
  }
  if (!not_undone.empty()) return absl::StrCat(reason, "; not undone: ", absl::StrJoin(not_undone, "; "));
  return undoing.undid ? absl::StrCat(reason, "; what it did was undone") : reason;
}

}  // namespace docent::engine
