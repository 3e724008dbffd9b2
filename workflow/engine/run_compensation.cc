// Compensation: what done nodes did is undone by their ext:compensate, the last first, when the run fails or is cancelled so.
// Each step is a run of its own, nested in this one, so it waits for its robot and holds it as all others. One that fails is
// noted, and the others go on.
#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"

namespace docent::engine {
namespace {

constexpr char kRobotVariable[] = "robot";

std::string Shown(const DoneStep& step) {
  return absl::StrCat(step.place, " (", step.operation, ")");
}

}  // namespace

// Once for each binding of forEach whose invocations are all done. Of a node that an operator skipped there is nothing to undo.
// Where some of them are done and others not, it is only noted that this is not undone.
void RunStepper::NoteDone(size_t index) {
  const cawl::Node& syntax = flow_.nodes[index];
  if (syntax.compensate.value.empty()) return;
  const std::vector<InvocationState>& invocations = run_.nodes[index].invocations;
  for (size_t first = 0; first < invocations.size(); first += syntax.invokes.size()) {
    const auto begin = invocations.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = begin + static_cast<std::ptrdiff_t>(syntax.invokes.size());
    const auto done = std::count_if(
        begin, end, [](const InvocationState& invocation) { return invocation.state == WorkState::kDone; });
    if (done == 0) continue;
    DoneStep step;
    step.place = syntax.name.value;
    if (done == end - begin) step.operation = syntax.compensate.value;
    step.variables = run_.variables;
    for (auto invocation = begin; invocation != end; ++invocation) {
      for (const auto& [name, value] : GivenTo(*invocation)) step.variables[name] = value;
      for (const auto& [name, value] : invocation->results) step.variables[name] = value;
    }
    std::erase_if(step.variables, [](const auto& variable) { return variable.second == kNoValue; });
    if (!invocations[first].robot.empty())
      step.variables[kRobotVariable] = Term::Iri(invocations[first].robot.value());
    step.done_us = core_.input->now_us;
    run_.done_steps.push_back(std::move(step));
  }
}

// What is done of nodes that are under way, in this run and in those that are nested in it.
void RunStepper::NoteDoneOfRunning() {
  for (size_t i = 0; i < run_.nodes.size(); ++i) {
    if (run_.nodes[i].state == WorkState::kRunning) NoteDone(i);
  }
  const auto nested = core_.nested.find(run_.id);
  for (const RunId& id : nested == core_.nested.end() ? std::set<RunId>() : nested->second)
    RunStepper(&core_, core_.Mutable(id)).NoteDoneOfRunning();
}

// Those of a sub-flow that ended, and that were not undone with it.
void RunStepper::TakeDoneSteps(const RunId& id) {
  Run* child = core_.Mutable(id);
  for (DoneStep& step : std::exchange(child->done_steps, {})) {
    step.place = absl::StrCat(id.value(), "/", step.place);
    run_.done_steps.push_back(std::move(step));
  }
}

// Of this run and of those that are nested in it, which keep none.
std::vector<DoneStep> RunStepper::DrainDoneSteps() {
  std::vector<DoneStep> steps = std::move(run_.done_steps);
  run_.done_steps.clear();
  const auto nested = core_.nested.find(run_.id);
  for (const RunId& id : nested == core_.nested.end() ? std::set<RunId>() : nested->second) {
    for (DoneStep& step : RunStepper(&core_, core_.Mutable(id)).DrainDoneSteps()) {
      step.place = absl::StrCat(id.value(), "/", step.place);
      steps.push_back(std::move(step));
    }
  }
  std::stable_sort(steps.begin(), steps.end(),
                   [](const DoneStep& a, const DoneStep& b) { return a.done_us < b.done_us; });
  return steps;
}

// What is under way is cancelled, and what is done is undone; then the run ends as `outcome`. False: there is nothing to undo.
bool RunStepper::BeginUndo(WorkState outcome, const std::string& reason) {
  NoteDoneOfRunning();
  std::vector<DoneStep> steps = DrainDoneSteps();
  if (steps.empty()) return false;
  run_.undoing = Undoing{outcome, reason, std::move(steps), {}, {}, {}};
  for (size_t i = 0; i < run_.nodes.size(); ++i) CancelNode(i, reason);
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
  if (run_.paused() || !undoing.child.empty()) return;
  core_.advanced.insert(run_.id);
  for (; !undoing.left.empty() && undoing.left.back().operation.empty(); undoing.left.pop_back())
    undoing.failed.push_back(absl::StrCat(undoing.left.back().place, ": only a part of it was done"));
  if (undoing.left.empty()) return End(undoing.outcome, std::string(undoing.reason));
  const DoneStep step = std::move(undoing.left.back());
  undoing.left.pop_back();
  undoing.current = Shown(step);
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
  if (child.state != WorkState::kDone)
    undoing.failed.push_back(absl::StrCat(undoing.current, ": ", child.reason));
  undoing.child = RunId();
  undoing.current.clear();
  return true;
}

// What could not be undone is told with the reason of the run's end.
std::string RunStepper::EndUndoing(const std::string& reason) {
  Undoing undoing = *std::move(run_.undoing);
  run_.undoing.reset();
  if (!undoing.child.empty()) core_.Cancel(undoing.child, reason);
  std::vector<std::string> not_undone = std::move(undoing.failed);
  if (!undoing.current.empty()) not_undone.push_back(absl::StrCat(undoing.current, ": it was cancelled"));
  for (auto step = undoing.left.rbegin(); step != undoing.left.rend(); ++step)
    not_undone.push_back(absl::StrCat(Shown(*step), ": it was not tried"));
  if (not_undone.empty()) return absl::StrCat(reason, "; what it did was undone");
  return absl::StrCat(reason, "; not undone: ", absl::StrJoin(not_undone, "; "));
}

}  // namespace docent::engine
