// The invocations of a run: choosing a robot, sending the steps of a robot service, taking reports.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/engine/run_results.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/rsel/part_types.h"
#include "workflow/rsel/type_checks.h"

namespace docent::engine {
namespace {

constexpr std::string_view kRobotVariable = "robot";
// Of one invocation, after an unknown outcome of an idempotent operation.
constexpr int kResendLimit = 3;

// Why the robot's operation cannot take an argument; empty: as far as the robot describes types, it can take them all.
std::string ArgumentFault(const RobotOffer& offer, const RobotCommand& command) {
  for (const auto& [name, value] : command.arguments) {
    const auto type = offer.input_types.find(name);
    if (type == offer.input_types.end()) continue;
    if (const std::string fault = rsel::TypeFault(value, type->second); !fault.empty())
      return Concat(command.operation, " cannot take ", ToDisplay(value), " as ", name, ", which ", fault);
  }
  return "";
}

// Whether an operator's stop is why the command has ended without success.
bool IsStopped(const OpenCommand& open, const CommandReport& report) {
  using Outcome = CommandReport::Outcome;
  const bool recalled = open.recalled != Stopped::kNo;  // one that begins all the same is cancelled
  if (report.outcome == Outcome::kNotBegun || (recalled && report.outcome == Outcome::kCancelled))
    return !open.overdue_until_us && (open.stopped != Stopped::kNo || recalled);
  if (open.stopped == Stopped::kNo) return false;
  return report.outcome != Outcome::kUnknown || !open.command.idempotent;
}

}  // namespace

std::string RunStepper::Subject(size_t node, size_t invocation) const {
  return absl::StrCat(Subject(node), "/", invocation);
}

std::optional<Term> RunStepper::Value(const std::string& name, const TermBinding* overlay) const {
  if (overlay != nullptr) {
    if (auto it = overlay->find(name); it != overlay->end())
      return it->second == kNoValue ? std::nullopt : std::make_optional(it->second);
  }
  if (auto it = run_.variables.find(name); it != run_.variables.end()) return it->second;
  return std::nullopt;
}

void RunStepper::SetInvocation(size_t node, size_t index, WorkState state, const std::string& cause) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  core_.bounds.Worked(1);
  core_.Say(Subject(node, index), ToString(invocation.state), ToString(state), cause);
  invocation.state = state;
  if (state == WorkState::kDone || state == WorkState::kFailed || state == WorkState::kCancelled)
    invocation.reason = cause;
  if (state != WorkState::kPending) core_.waiting.Leave({run_.id, node, index});
  if (IsFinal(state)) {
    invocation.deadline_us.reset();
    invocation.overdue.clear();
    LeaveRobot(node, index);
  }
}

// What the invocation's robot takes with an operation of its own. What it did not describe is asked of ext:input and of the
// messages that the node sees: of their parts, those that have a value.
std::vector<std::string> RunStepper::InputsOf(size_t node, size_t index) const {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Node& syntax = flow_.nodes[node];
  const RobotOffer* offer = core_.OfferFor(syntax.invokes[invocation.invoke].operation.value,
                                           invocation.robot, {run_.id, node, index});
  if (offer != nullptr && offer->inputs) return *offer->inputs;
  std::vector<std::string> inputs = PartsWithValue(node, GivenTo(invocation));
  for (const auto& [name, value] : invocation.inputs) {
    const bool named = std::find(inputs.begin(), inputs.end(), name) != inputs.end();
    if (!named && name != kRobotVariable) inputs.push_back(name);
  }
  return inputs;
}

std::vector<std::string> RunStepper::PartsWithValue(size_t node, const TermBinding& given) const {
  const cawl::Node& syntax = flow_.nodes[node];
  std::vector<std::string> inputs;
  for (const std::vector<cawl::Message>* messages :
       {&syntax.messages, &flow_.messages, &run_.document->messages}) {
    for (const cawl::Message& message : *messages) {
      for (const cawl::Part& part : message.parts) {
        const std::string& name = part.name.value;
        if (std::find(inputs.begin(), inputs.end(), name) == inputs.end() && Value(name, &given))
          inputs.push_back(name);
      }
    }
  }
  return inputs;
}

// Its own run holds the robot: it is looked at again when something of that becomes free, or may take commands.
bool RunStepper::WaitForOwnRobot(size_t node, size_t index, std::string_view why) {
  run_.nodes[node].invocations[index].reason = std::string(why);
  return false;
}

void RunStepper::WaitForRobot(size_t node, size_t index, std::string why) {
  WaitForOwnRobot(node, index, why);
  run_.nodes[node].invocations[index].queued = true;
  const CommandOwner owner{run_.id, node, index};
  core_.waiting.Wait(core_.RankOf(run_), owner, core_.WishOf(run_, owner));
  core_.NoteBarred(owner, why);
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const TermBinding given = GivenTo(invocation);
  core_.Covet(run_, flow_.nodes[node].invokes[invocation.invoke].operation.value,
              Value(std::string(kRobotVariable), &given));
}

// ext:sequential: whether an invocation for a binding before its own has not been done.
bool RunStepper::ComesLater(size_t node, size_t index) const {
  if (!flow_.nodes[node].sequential) return false;
  const std::vector<InvocationState>& invocations = run_.nodes[node].invocations;
  const TermBinding& own = invocations[index].binding;
  return std::any_of(invocations.begin(), invocations.begin() + static_cast<std::ptrdiff_t>(index),
                     [&own](const InvocationState& other) {
                       return other.state != WorkState::kDone && other.binding != own;
                     });
}

// What can go on now of an invocation that has not ended. True if something changed.
bool RunStepper::GoOn(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (invocation.state == WorkState::kPending) return TryDispatch(node, index);
  if (invocation.state != WorkState::kRunning) return false;
  if (!invocation.overdue.empty()) {
    const std::string before = invocation.overdue;
    BeginAgain(node, index);
    return run_.nodes[node].invocations[index].overdue != before;
  }
  if (!invocation.handler || !SendReady(node, index)) return false;
  SettleHandler(node, index);
  return true;
}

// True if something changed: it was sent to a robot, or it failed.
bool RunStepper::TryDispatch(size_t node, size_t index, bool opening) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (run_.paused()) return false;
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[invocation.invoke];
  invocation.queued = false;
  core_.waiting.Leave({run_.id, node, index});
  if (invocation.once) {
    InvocationFailed(node, index, invocation.reason);
    return true;
  }
  const bool again = invocation.sent || invocation.attempt > 1 || run_.nodes[node].iteration > 0;
  if (again && !AttemptsEnded(node)) {
    if (!invocation.deadline_us)
      invocation.deadline_us = core_.input->now_us + core_.limits.default_step_timeout_ms * int64_t{1000};
    return WaitForOwnRobot(node, index, kAttemptNotEnded);
  }
  if (IsTooEarly(node, index)) return false;
  if (ComesLater(node, index)) {
    invocation.reason = std::string(kComesLater);
    return false;
  }
  // its time begins now
  if (invocation.reason == kAttemptNotEnded || invocation.reason == kComesLater)
    invocation.deadline_us.reset();
  invocation.reason.clear();
  bool waits_again = false;
  if ((!opening || run_.nodes[node].hold) && !MayBegin(node, index, &waits_again)) {
    if (waits_again) return true;
    if (!invocation.deadline_us) invocation.deadline_us = GivenDeadline(node, index);
    return false;
  }
  if (!invocation.deadline_us) invocation.deadline_us = GivenDeadline(node, index);
  if (!invoke.inputs.empty()) {
    if (WroteInThisRound()) {  // the facts that its expressions see come with the next round
      core_.awaiting.insert(run_.id);
      return false;
    }
    if (const absl::Status taken = TakeInputs(node, index); !taken.ok()) {
      InvocationFailed(node, index, std::string(taken.message()));
      return true;
    }
  }
  if (!invoke.subflow.value.empty()) return StartSubflow(node, index);

  rsel::PlanPtr plan = core_.PlanOf(invoke.operation.value);
  std::string why_not;
  const CommandOwner self{run_.id, node, index};
  const TermBinding given = GivenTo(invocation);
  const std::optional<Term> wanted = Value(std::string(kRobotVariable), &given);
  if (wanted && !wanted->IsIri()) {
    InvocationFailed(node, index,
                     absl::StrCat("it has ", ToDisplay(*wanted), " as its robot, which is no robot"));
    return true;
  }
  std::vector<RobotId> robots = core_.RobotsFor(*plan, wanted, core_.RootOf(run_), self, &why_not);
  LeaveOutFailed(node, index, *plan, &robots, &why_not);
  if (robots.empty()) {
    if (!invocation.deadline_us) invocation.deadline_us = DefaultDeadline(node, index);
    WaitForRobot(node, index, std::move(why_not));
    return false;
  }
  invocation.robot = Preferred(node, index, plan->inputs, std::move(robots));
  invocation.occupies = core_.OccupationOf(*plan, invocation.robot, self);
  std::string operation = invoke.operation.value;
  if (core_.services.Find(operation) == nullptr) {
    if (invoke.capability.given()) operation = core_.OfferFor(operation, invocation.robot, self)->operation;
    plan = rsel::OperationPlan(operation, InputsOf(node, index));
  }
  rsel::Arguments arguments;
  for (const std::string& input : plan->inputs) {
    if (auto value = Value(input, &given)) arguments.emplace(input, *value);
  }
  if (absl::Status fit = rsel::CheckArguments(*plan, plan->input_types, arguments); !fit.ok()) {
    InvocationFailed(node, index, std::string(fit.message()));
    return true;
  }
  auto handler = rsel::InstructionHandler::Start(plan, arguments);
  if (!handler.ok()) {
    InvocationFailed(node, index, std::string(handler.status().message()));
    return true;
  }
  invocation.handler = *std::move(handler);
  invocation.reason.clear();
  invocation.guard_revision = core_.input->revision;
  invocation.sent = true;
  core_.Hold(invocation.robot, run_);
  core_.Used(invocation.robot);
  core_.ledger.Begin(invocation.robot, self, invocation.occupies);
  if (!invoke.timeout_ms) invocation.deadline_us.reset();  // its steps have deadlines of their own
  SetInvocation(node, index, WorkState::kRunning,
                absl::StrCat(operation, " on ", ToDisplay(Term::Iri(invocation.robot.value()))));
  SendReady(node, index);
  SettleHandler(node, index);
  return true;
}

// Of robots that are free, the one that the document or the default query prefers.
RobotId RunStepper::Preferred(size_t node, size_t index, const std::vector<std::string>& inputs,
                              std::vector<RobotId> able) const {
  if (able.size() < 2 || core_.input->ranking == nullptr) return able.front();
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[invocation.invoke];
  // a robot's own operation says itself what it takes
  std::vector<std::string> names = inputs;
  const RobotOffer* offer = core_.OfferFor(invoke.operation.value, able.front(), {run_.id, node, index});
  if (names.empty()) names = offer != nullptr && offer->inputs ? *offer->inputs : InputsOf(node, index);
  return BestOf(invoke.choose, names, GivenTo(invocation), std::move(able));
}

bool RunStepper::StartSubflow(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  const std::string& name = flow_.nodes[node].invokes[invocation.invoke].subflow.value;
  auto flow = core_.FindFlow(run_.document, name);
  if (flow && flow->first != run_.document && core_.IsPaused(*flow->first))
    return WaitForOwnRobot(node, index, kWorkflowPaused);
  if (!flow) {
    InvocationFailed(node, index, absl::StrCat("there is no flow or deployed workflow \"", name, "\""));
    return true;
  }
  if (core_.bounds.spent()) {
    core_.unfinished.insert(run_.id);
    return false;
  }
  std::string why_not = core_.WhyNoRoom(flow->first->flows[flow->second].nodes.size());
  if (core_.DepthOf(run_) >= core_.limits.subflow_nesting) {
    why_not =
        absl::StrCat("it is nested too deep; the limit subflow_nesting is ", core_.limits.subflow_nesting);
  } else if (core_.IsInside(run_, *flow->first, flow->second)) {
    why_not = "it would run inside itself; a flow repeats itself by a link that leads back";
  }
  if (!why_not.empty()) {
    InvocationFailed(node, index, absl::StrCat("subflow ", name, " does not start: ", why_not));
    return true;
  }
  TermBinding variables = run_.variables;
  for (const auto& [key, value] : GivenTo(invocation)) variables[key] = value;
  invocation.sent = true;
  SetInvocation(node, index, WorkState::kRunning, absl::StrCat("subflow ", name));
  CommandOwner owner{run_.id, node, index};
  // The child is a run of its own and does not touch this one until it ends.
  RunId child = core_.Start(flow->first, flow->second, std::move(variables),
                            absl::StrCat("subflow of ", Subject(node, index)), &owner);
  run_.nodes[node].invocations[index].child = child;
  return true;
}

// Whether the operation may begin beside what occupies the robot now: commands of this invocation that are under way, `taken`
// by those that begin with it, and commands that are ending. `*why_not` is set where it may not.
bool RunStepper::MaySend(size_t node, size_t index, const std::string& operation,
                         std::vector<Occupation>* taken, std::string* why_not) const {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const RobotOffer* offer = core_.OfferOf(operation, invocation.robot);
  if (const std::string why = offer == nullptr ? "" : core_.OutOfService(*offer); !why.empty()) {
    *why_not = absl::StrCat(ToDisplay(Term::Iri(invocation.robot.value())), " ", why);
    return false;
  }
  const Occupation occupies = offer == nullptr ? Occupation() : offer->occupies;
  const auto collides = [&occupies](const Occupation& other) { return Collide(occupies, other); };
  const auto in_the_way = [&](const OpenCommand& open) { return collides(open.occupies); };
  if (core_.ledger.Occupied(invocation.robot, occupies, {run_.id, node, index}) ||
      std::any_of(invocation.commands.begin(), invocation.commands.end(), in_the_way) ||
      std::any_of(taken->begin(), taken->end(), collides)) {
    *why_not = std::string(kAtAnotherStep);
    return false;
  }
  taken->push_back(occupies);
  return true;
}

// True if a command was sent, or the handler ended.
bool RunStepper::SendReady(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (!invocation.overdue.empty() || run_.paused() || !HasItsRobot(node, index)) return false;
  std::string why_not;
  std::vector<Occupation> taken;
  bool sent = false;
  for (const OpenCommand& lost : std::exchange(invocation.lost, {})) {
    if (MaySend(node, index, lost.command.operation, &taken, &why_not)) {
      Resend(node, index, lost);
      sent = true;
    } else {
      invocation.lost.push_back(lost);
    }
  }
  const std::vector<rsel::Instruction> ready = invocation.handler->TakeReady(
      [&](const rsel::PlanStep& step) { return MaySend(node, index, step.operation, &taken, &why_not); });
  for (const rsel::Instruction& instruction : ready) SendInstruction(node, index, instruction);
  if (invocation.handler->ended()) return true;
  if (!why_not.empty()) {
    WaitForOwnRobot(node, index, why_not);
  } else if (sent || !ready.empty()) {
    invocation.reason.clear();  // what it waited for has come
  }
  if (flow_.nodes[node].invokes[invocation.invoke].timeout_ms) return sent || !ready.empty();
  if (!invocation.commands.empty())
    invocation.deadline_us.reset();
  else if (!invocation.deadline_us)
    invocation.deadline_us = DefaultDeadline(node, index);
  return sent || !ready.empty();
}

void RunStepper::SendInstruction(size_t node, size_t index, const rsel::Instruction& instruction) {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  OpenCommand open;
  RobotCommand& command = open.command;
  // With the time: a server whose older backup was put back counts its runs anew, and an adapter that remembers an id
  // does not execute it again.
  command.id = CommandId(absl::StrCat(Subject(node), "/", run_.nodes[node].iteration, "/", index, ".",
                                      invocation.attempt, "/", instruction.step, "/", instruction.attempt,
                                      "@", core_.input->now_us));
  command.robot = invocation.robot;
  command.operation = instruction.operation;
  command.arguments = instruction.arguments;
  command.guard_revision = invocation.guard_revision;
  command.deadline_us = StepDeadline(node, index, instruction.timeout_ms).value_or(0);
  open.step = instruction.step;
  open.attempt = instruction.attempt;
  if (!Decide(node, index, std::move(open))) return;
  run_.nodes[node].invocations[index].step = instruction.label;
  run_.nodes[node].invocations[index].progress = 0;
}

// Once more to the adapter that lives now, under a new id: the one before may know the old id and never tell.
void RunStepper::Resend(size_t node, size_t index, const OpenCommand& lost) {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  OpenCommand again = lost;
  again.command.id =
      CommandId(absl::StrCat(lost.command.id.value(), ".", invocation.resends, "@", core_.input->now_us));
  again.overdue_until_us.reset();  // its time begins again, and its end is not waited for yet
  again.stopped = again.recalled = Stopped::kNo;
  const bool was_stopped = lost.stopped != Stopped::kNo || lost.recalled != Stopped::kNo;
  if (was_stopped && again.command.deadline_us != 0) {
    const rsel::PlanStep& step = invocation.handler->plan().steps[static_cast<size_t>(lost.step - 1)];
    again.command.deadline_us = StepDeadline(node, index, step.timeout_ms).value_or(0);
  }
  Decide(node, index, std::move(again), was_stopped ? nullptr : &lost.command.expected_incarnation);
}

// A command goes out, for the first time or again: to the adapter that the graph has now, which may describe the operation
// otherwise than when the invocation began. `gone`: an incarnation that has turned it away; null: none. False: the robot cannot
// take it so, and the step has failed.
bool RunStepper::Decide(size_t node, size_t index, OpenCommand open, const std::string* gone) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  RobotCommand& command = open.command;
  command.expected_incarnation.clear();
  command.idempotent = false;
  open.occupies.clear();
  if (const RobotOffer* offer = core_.OfferOf(command.operation, command.robot)) {
    if (const std::string fault = ArgumentFault(*offer, command); !fault.empty()) {
      core_.Say(absl::StrCat(Subject(node, index), " ", invocation.handler->Label(open.step)), "running",
                "failed", fault);
      invocation.handler->Failed(open.step, open.attempt, fault, false);
      return false;
    }
    command.expected_incarnation = offer->incarnation;
    command.idempotent = offer->idempotent;
    open.occupies = offer->occupies;
  }
  // The graph does not have the one that lives now: any will do.
  if (gone != nullptr && command.idempotent && command.expected_incarnation == *gone)
    command.expected_incarnation.clear();
  // It occupies what its command does.
  invocation.occupies = Both(invocation.occupies, open.occupies);
  core_.ledger.Begin(invocation.robot, {run_.id, node, index}, invocation.occupies);
  core_.commands[command.id.value()] = {run_.id, node, index};
  core_.output->commands.push_back(command);
  invocation.commands.push_back(std::move(open));
  return true;
}

// The handler may have come to its end.
void RunStepper::SettleHandler(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  switch (invocation.handler->state()) {
    case rsel::InstructionHandler::State::kRunning:
      return;
    case rsel::InstructionHandler::State::kDone: {
      const rsel::Arguments given = invocation.handler->Results();
      std::string note;
      const TermBinding results = ResultsOf(node, index, TermBinding(given.begin(), given.end()), &note);
      SetInvocation(node, index, WorkState::kDone, note);
      SetVariables(results);  // last: it may end the run
      return;
    }
    case rsel::InstructionHandler::State::kFailed:
    case rsel::InstructionHandler::State::kCancelled: {
      std::string reason = invocation.handler->reason();
      InvocationFailed(node, index, reason);
      return;
    }
  }
}

void RunStepper::Report(const CommandOwner& owner, const CommandReport& report) {
  InvocationState& invocation = run_.nodes[owner.node].invocations[owner.invocation];
  auto open = std::find_if(invocation.commands.begin(), invocation.commands.end(),
                           [&](const OpenCommand& c) { return c.command.id == report.command; });
  if (open == invocation.commands.end()) return;
  using Outcome = CommandReport::Outcome;
  switch (report.outcome) {
    case Outcome::kAccepted:
      return;
    case Outcome::kProgress:
      invocation.progress = report.progress;
      invocation.reason.clear();  // it can be reached again
      return;
    case Outcome::kUnreachable:
    case Outcome::kRefused:
      invocation.reason = report.message;
      return;
    default:
      break;
  }
  OpenCommand done = *open;
  invocation.commands.erase(open);
  if (report.outcome == Outcome::kUnknown) invocation.unknown = true;
  core_.commands.erase(report.command.value());
  core_.released.insert(done.command.robot);
  core_.changed_robots.insert(done.command.robot);
  if (report.outcome == Outcome::kSucceeded) {
    rsel::Arguments results(report.results.begin(), report.results.end());
    core_.Say(absl::StrCat(Subject(owner.node, owner.invocation), " ", invocation.handler->Label(done.step)),
              "running", "done", "");
    invocation.handler->Succeeded(done.step, done.attempt, results);
  } else if (IsStopped(done, report) && invocation.overdue.empty()) {
    return CommandStopped(owner, std::move(done), report.outcome != Outcome::kNotBegun, report.message);
  } else if (report.outcome == Outcome::kNotBegun && !done.overdue_until_us && invocation.overdue.empty()) {
    // The incarnation that it was meant for is gone, and never got it.
    core_.Say(absl::StrCat(Subject(owner.node, owner.invocation), " ", invocation.handler->Label(done.step)),
              "running", "not begun", report.message);
    invocation.reason = absl::StrCat("not begun: ", report.message, "; it is sent again");
    done.recalled = Stopped::kWithRobot;
    invocation.lost.push_back(std::move(done));
    return;
  } else if (report.outcome == Outcome::kUnknown && done.command.idempotent && !done.overdue_until_us &&
             invocation.resends < kResendLimit) {
    ++invocation.resends;
    invocation.lost.push_back(std::move(done));
    return;
  } else {
    const bool unknown = report.outcome == Outcome::kUnknown && !done.command.idempotent;
    if (unknown) invocation.once = run_.unknown_outcome = true;
    bool may_retry = report.outcome == Outcome::kFailed || report.outcome == Outcome::kNotBegun ||
                     done.command.idempotent || (done.overdue_until_us && !unknown);
    std::string reason = !report.message.empty()                 ? report.message
                         : report.outcome == Outcome::kCancelled ? "cancelled at the robot"
                                                                 : "the robot gave no reason";
    if (report.outcome == Outcome::kUnknown)
      reason =
          absl::StrCat("how it ended is unknown", unknown ? ", so it is not done again: " : ": ", reason);
    core_.Say(absl::StrCat(Subject(owner.node, owner.invocation), " ", invocation.handler->Label(done.step)),
              "running", "failed", reason);
    invocation.handler->Failed(done.step, done.attempt, reason, may_retry);
  }
  if (!invocation.overdue.empty()) return BeginAgain(owner.node, owner.invocation);
  // What comes next is sent as the run advances, when all reports of the turn are known.
  SettleHandler(owner.node, owner.invocation);
}

void RunStepper::ChildEnded(const CommandOwner& owner, const Run& child) {
  if (StepUndone(child)) return;
  TakeDoneSteps(child.id);
  if (owner.node >= run_.nodes.size()) return;  // it undid a step of a run that has ended since
  // its node may have begun again since
  if (owner.invocation >= run_.nodes[owner.node].invocations.size()) return;
  InvocationState& invocation = run_.nodes[owner.node].invocations[owner.invocation];
  if (invocation.child != child.id || IsFinal(invocation.state)) return;
  if (child.state != WorkState::kDone) {
    invocation.child = RunId();
    if (child.unknown_outcome) invocation.once = run_.unknown_outcome = true;
    if (!invocation.overdue.empty()) return BeginAgain(owner.node, owner.invocation);
    InvocationFailed(owner.node, owner.invocation,
                     absl::StrCat("subflow ", child.id.value(), ": ", child.reason));
    return;
  }
  const bool mapped = !flow_.nodes[owner.node].invokes[invocation.invoke].outputs.empty();
  TermBinding given = mapped || !child.Flow().outputs.empty() ? FlowResults(child) : TermBinding();
  if (child.Flow().outputs.empty()) {
    for (const auto& [name, value] : child.variables) {
      const bool is_input = invocation.inputs.contains(name);  // it was given to the sub-flow alone
      if (mapped || (!is_input && run_.variables.count(name) == 0)) given.emplace(name, value);
    }
  }
  std::string note;
  const TermBinding results = ResultsOf(owner.node, owner.invocation, given, &note);
  invocation.overdue.clear();
  SetInvocation(owner.node, owner.invocation, WorkState::kDone, note);
  SetVariables(results);  // last: it may end the run
}

}  // namespace docent::engine
