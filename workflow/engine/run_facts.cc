#include "workflow/engine/run_facts.h"

#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/engine/engine_core.h"
#include "workflow/engine/run_results.h"

namespace docent::engine {
namespace {

Term Decimal(double value) {
  std::string text = absl::StrFormat("%.2f", value);
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  return Term::Literal(text, std::string(kXsdDecimal));
}

class Writer {
 public:
  explicit Writer(RunTerms* terms)
      : terms_(*terms), dictionary_(terms->dictionary()), graph_(terms->Of(RunTerm::kRunsGraph)) {}

  void About(TermId subject) { subject_ = subject; }
  void Say(RunTerm predicate, TermId object) {
    quads_.push_back({subject_, terms_.Of(predicate), object, graph_});
  }
  void Say(RunTerm predicate, RunTerm object) { Say(predicate, terms_.Of(object)); }
  void SayText(RunTerm predicate, std::string_view text) {
    if (!text.empty()) SayTerm(predicate, Term::Literal(std::string(text)));
  }
  void SayTerm(RunTerm predicate, const Term& term) { Say(predicate, dictionary_.Intern(term)); }
  void SayState(RunTerm predicate, WorkState state) { Say(predicate, terms_.Of(state)); }
  void SayTime(RunTerm predicate, TimeMicros time_us) { Say(predicate, Time(time_us)); }
  TermId Iri(std::string_view iri) { return dictionary_.InternIri(iri); }
  std::vector<Quad> Take() {
    std::sort(quads_.begin(), quads_.end());
    quads_.erase(std::unique(quads_.begin(), quads_.end()), quads_.end());
    return std::move(quads_);
  }

 private:
  TermId Time(TimeMicros time_us) {
    if (time_us != time_us_ || time_.IsNone()) {  // most are that of the turn
      time_us_ = time_us;
      time_ = dictionary_.Intern(DateTimeTerm(time_us));
    }
    return time_;
  }

  RunTerms& terms_;
  Dictionary& dictionary_;
  const TermId graph_;
  TermId subject_;
  TimeMicros time_us_ = 0;
  TermId time_;
  std::vector<Quad> quads_;
};

// How far an invocation is: the steps of its plan that have ended, and the one under way as far as the robot says.
double ProgressOf(const InvocationState& invocation) {
  if (!invocation.handler) return invocation.progress;
  using StepState = rsel::InstructionHandler::StepState;
  const int steps = static_cast<int>(invocation.handler->plan().steps.size());
  double ended = 0;
  for (int step = 1; step <= steps; ++step) {
    const StepState state = invocation.handler->step_state(step);
    if (state == StepState::kDone || state == StepState::kFailed) ++ended;
  }
  if (!invocation.commands.empty()) ended += invocation.progress;
  return std::min(1.0, ended / steps);
}

// The steps of a service of several steps, as far as they have come.
void WriteSteps(const InvocationState& invocation, Writer* out) {
  if (!invocation.handler || invocation.handler->plan().steps.size() < 2) return;
  using StepState = rsel::InstructionHandler::StepState;
  for (int step = 1; step <= static_cast<int>(invocation.handler->plan().steps.size()); ++step) {
    const StepState state = invocation.handler->step_state(step);
    if (state == StepState::kDone) out->SayText(RunTerm::kStepDone, invocation.handler->Label(step));
    if (state == StepState::kFailed) out->SayText(RunTerm::kStepFailed, invocation.handler->Label(step));
    if (state == StepState::kRunning) out->SayText(RunTerm::kStepRunning, invocation.handler->Label(step));
  }
}

// A variable of the run stands with the run.
void WriteWantedRobot(const InvocationState& invocation, Writer* out) {
  for (const TermBinding* given : {&invocation.inputs, &invocation.binding}) {
    const auto robot = given->find("robot");
    if (robot == given->end()) continue;
    if (robot->second.IsIri()) out->SayTerm(RunTerm::kWantedRobot, robot->second);
    return;
  }
}

// Why it goes as it goes. A command that is to stop is under way until its robot has said how it ended.
std::string ReasonOf(const InvocationState& invocation) {
  for (const OpenCommand& open : invocation.commands) {
    if (open.stopped == Stopped::kNo) continue;
    return Concat("asked to stop, and its robot has not yet confirmed it: ", ToString(open.stopped),
                  invocation.reason.empty() ? "" : "; ", invocation.reason);
  }
  return invocation.reason;
}

void WriteInvocation(const InvocationState& invocation, const cawl::Node& node, const std::string& iri,
                     TermId of_node, Writer* out) {
  const cawl::Invoke& invoke = node.invokes[invocation.invoke];
  out->About(out->Iri(iri));
  out->Say(RunTerm::kType, RunTerm::kInvocation);
  out->Say(RunTerm::kOfNode, of_node);
  const bool by_class = invoke.capability.given();
  out->SayText(RunTerm::kOperation, by_class && invocation.handler
                                        ? invocation.handler->plan().steps[0].operation
                                    : invoke.operation.value.empty() ? invoke.subflow.value
                                                                     : invoke.operation.value);
  if (by_class)
    out->Say(RunTerm::kWantedCapability, out->Iri(std::string(*CapabilityOf(invoke.operation.value))));
  out->SayState(RunTerm::kInvocationState, invocation.state);
  if (invocation.state == WorkState::kPending && invoke.subflow.empty()) WriteWantedRobot(invocation, out);
  if (!invocation.robot.empty()) out->Say(RunTerm::kRobot, out->Iri(invocation.robot.value()));
  if (!invocation.child.empty()) out->Say(RunTerm::kChildRun, out->Iri(RunIri(invocation.child)));
  for (const OpenCommand& open : invocation.commands)
    out->SayText(RunTerm::kCommand, open.command.id.value());
  out->SayText(RunTerm::kStep, invocation.step);
  if (invocation.not_before_us) out->SayTime(RunTerm::kNotBefore, *invocation.not_before_us);
  WriteSteps(invocation, out);
  if (invocation.state == WorkState::kRunning)
    out->SayTerm(RunTerm::kProgress, Decimal(ProgressOf(invocation)));
  out->SayText(RunTerm::kReason, ReasonOf(invocation));
  for (const std::string& name : node.for_each) {
    const auto value = invocation.binding.find(name);
    if (value == invocation.binding.end()) continue;
    const TermId variable = out->Iri(absl::StrCat(iri, "/$", IriSegment(name)));
    out->About(out->Iri(iri));
    out->Say(RunTerm::kForValue, variable);
    out->About(variable);
    out->SayText(RunTerm::kVariableName, name);
    out->SayTerm(RunTerm::kVariableValue, value->second);
  }
}

// What its condition, or what has to hold while it runs, is not so of: the ASK; empty: the node does not wait for that.
const std::string& WaitsFor(const NodeState& node) {
  if (node.state != WorkState::kRunning) return node.waits_for;
  for (const InvocationState& invocation : node.invocations) {
    if (invocation.state != WorkState::kPending) continue;
    if (node.hold && invocation.reason == kHoldsNot) return node.hold->armed.ask.ask;
    if (node.guard && invocation.reason.ends_with(kCeasedToHold)) return node.guard->armed.ask.ask;
  }
  return node.waits_for;
}

// When the condition that it waits for will have held for long enough, if nothing changes.
std::optional<TimeMicros> OpensAt(const NodeState& node, const ConditionView& conditions) {
  std::optional<TimeMicros> first;
  for (const ArmedCondition& armed : node.armed) {
    const std::optional<TimeMicros> opens = conditions.OpensAt(armed.handle);
    if (opens) first = std::min(first.value_or(*opens), *opens);
  }
  return first;
}

void WriteNode(const Run& run, const std::string& run_iri, TermId of_run, size_t index,
               const ConditionView* conditions, Writer* out) {
  const NodeState& state = run.nodes[index];
  const cawl::Node& node = run.Flow().nodes[index];
  const std::string iri = absl::StrCat(run_iri, "/", IriSegment(node.name.value));
  const TermId id = out->Iri(iri);
  out->About(id);
  out->Say(RunTerm::kType, RunTerm::kNodeInstance);
  out->Say(RunTerm::kOfRun, of_run);
  out->SayText(RunTerm::kNodeName, node.name.value);
  out->SayTerm(RunTerm::kPosition, Term::Integer(static_cast<int64_t>(node.position)));
  out->SayState(RunTerm::kNodeState, state.state);
  out->SayText(RunTerm::kWaitsFor, WaitsFor(state));
  if (conditions != nullptr && state.state == WorkState::kWaiting) {
    if (const auto opens = OpensAt(state, *conditions)) out->SayTime(RunTerm::kOpensAt, *opens);
  }
  out->SayText(RunTerm::kFiredBecause, state.fired_because);
  if (state.fired_us != 0) out->SayTime(RunTerm::kFiredAt, state.fired_us);
  if (state.since_us != 0) out->SayTime(RunTerm::kSince, state.since_us);
  out->SayText(RunTerm::kReason, state.reason);
  for (size_t i = 0; i < state.invocations.size(); ++i) {
    WriteInvocation(state.invocations[i], node, absl::StrCat(iri, "/", i), id, out);
  }
}

}  // namespace

std::vector<Quad> RunFacts(const Run& run, RunTerms* terms, const ConditionView* conditions) {
  Writer out(terms);
  const std::string run_iri = RunIri(run.id);
  const TermId id = out.Iri(run_iri);
  out.About(id);
  out.Say(RunTerm::kType, RunTerm::kRun);
  out.SayText(RunTerm::kWorkflow, run.document->name.value);
  out.SayText(RunTerm::kFlow, run.Flow().name.value);
  out.SayState(RunTerm::kRunState, run.state);
  out.SayText(RunTerm::kReason, run.reason);
  out.SayTime(RunTerm::kStartedAtTime, run.started_us);
  if (run.ended_us != 0) out.SayTime(RunTerm::kEndedAtTime, run.ended_us);
  if (!run.parent.empty()) out.Say(RunTerm::kParentRun, out.Iri(RunIri(run.parent)));
  if (run.paused() && run.state == WorkState::kRunning) {
    out.SayTime(RunTerm::kPausedAt, run.paused_since_us);
    if (run.pause) out.SayText(RunTerm::kPauseReason, *run.pause);
  }
  if (run.state == WorkState::kRunning) {
    for (const RobotId& robot : run.robots) out.Say(RunTerm::kUsesRobot, out.Iri(robot.value()));
  }
  for (const auto& [name, value] : run.variables) {
    const TermId variable = out.Iri(absl::StrCat(run_iri, "/$", IriSegment(name)));
    out.About(id);
    out.Say(RunTerm::kHasVariable, variable);
    out.About(variable);
    out.SayText(RunTerm::kVariableName, name);
    out.SayTerm(RunTerm::kVariableValue, value);
  }
  if (run.state == WorkState::kDone) {
    for (const auto& [name, value] : FlowResults(run)) {
      const TermId result = out.Iri(absl::StrCat(run_iri, "/=", IriSegment(name)));
      out.About(id);
      out.Say(RunTerm::kHasResult, result);
      out.About(result);
      out.SayText(RunTerm::kVariableName, name);
      out.SayTerm(RunTerm::kVariableValue, value);
    }
  }
  for (size_t i = 0; i < run.nodes.size(); ++i) WriteNode(run, run_iri, id, i, conditions, &out);
  return out.Take();
}

void DiffFacts(const std::vector<Quad>& before, const std::vector<Quad>& after, std::vector<Quad>* add,
               std::vector<Quad>* remove) {
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(*add));
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(*remove));
}

}  // namespace docent::engine
