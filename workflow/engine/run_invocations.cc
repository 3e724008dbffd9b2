// The invocations of a run: choosing a robot, sending the steps of a robot service, taking reports.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

constexpr std::string_view kRobotVariable = "robot";
// Of one invocation, after an unknown outcome of an idempotent operation.
constexpr int kResendLimit = 3;

}  // namespace

std::string RunStepper::Subject(size_t node, size_t invocation) const {
  return absl::StrCat(Subject(node), "/", invocation);
}

std::optional<Term> RunStepper::Value(const std::string& name, const TermBinding* overlay) const {
  if (overlay != nullptr) {
    if (auto it = overlay->find(name); it != overlay->end()) return it->second;
  }
  if (auto it = run_.variables.find(name); it != run_.variables.end()) return it->second;
  return std::nullopt;
}

void RunStepper::SetInvocation(size_t node, size_t index, WorkState state, const std::string& cause) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  core_.Say(Subject(node, index), ToString(invocation.state), ToString(state), cause);
  invocation.state = state;
  if (state == WorkState::kFailed || state == WorkState::kCancelled) invocation.reason = cause;
  if (state != WorkState::kPending) core_.waiting.Leave({run_.id, node, index});
  if (IsFinal(state)) invocation.deadline_us.reset();
  if (state == WorkState::kDone) invocation.reason.clear();
}

// What the invocation's robot takes with an operation of its own. What it did not describe is asked of the messages that
// the node sees: of their parts, those that have a value.
std::vector<std::string> RunStepper::InputsOf(size_t node, size_t index) const {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Node& syntax = flow_.nodes[node];
  for (const RobotOffer& offer :
       core_.input->robots->Offers(syntax.invokes[invocation.invoke].operation.value)) {
    if (offer.robot == invocation.robot && offer.inputs) return *offer.inputs;
  }
  std::vector<std::string> inputs;
  for (const std::vector<cawl::Message>* messages :
       {&syntax.messages, &flow_.messages, &run_.document->messages}) {
    for (const cawl::Message& message : *messages) {
      for (const cawl::Part& part : message.parts) {
        const std::string& name = part.name.value;
        if (std::find(inputs.begin(), inputs.end(), name) == inputs.end() && Value(name, &invocation.binding))
          inputs.push_back(name);
      }
    }
  }
  return inputs;
}

// True if something changed: it was sent to a robot, or it failed.
bool RunStepper::TryDispatch(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[invocation.invoke];
  int64_t timeout_ms = invoke.timeout_ms.value_or(core_.limits.default_step_timeout_ms);
  if (!invocation.deadline_us) invocation.deadline_us = core_.input->now_us + timeout_ms * 1000;
  if (!invoke.subflow.value.empty()) return StartSubflow(node, index);

  rsel::PlanPtr plan = core_.PlanOf(invoke.operation.value);
  std::string why_not;
  std::vector<RobotId> robots = core_.RobotsFor(
      *plan, Value(std::string(kRobotVariable), &invocation.binding), core_.RootOf(run_), &why_not);
  if (robots.empty()) {
    invocation.reason = why_not;
    CommandOwner owner{run_.id, node, index};
    core_.waiting.Wait(run_.number, owner, core_.WishOf(run_, owner));
    return false;
  }
  invocation.robot = robots.front();
  if (core_.services.Find(invoke.operation.value) == nullptr)
    plan = rsel::OperationPlan(invoke.operation.value, InputsOf(node, index));
  rsel::Arguments arguments;
  for (const std::string& input : plan->inputs) {
    if (auto value = Value(input, &invocation.binding)) arguments.emplace(input, *value);
  }
  auto handler = rsel::InstructionHandler::Start(plan, arguments);
  if (!handler.ok()) {
    InvocationFailed(node, index, std::string(handler.status().message()));
    return true;
  }
  invocation.handler = *std::move(handler);
  invocation.reason.clear();
  run_.robots.insert(invocation.robot);
  core_.holders.emplace(invocation.robot, core_.RootOf(run_));
  SetInvocation(node, index, WorkState::kRunning,
                absl::StrCat(invoke.operation.value, " on ", ToDisplay(Term::Iri(invocation.robot.value()))));
  SendReady(node, index);
  SettleHandler(node, index);
  return true;
}

bool RunStepper::StartSubflow(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  const std::string& name = flow_.nodes[node].invokes[invocation.invoke].subflow.value;
  auto flow = core_.FindFlow(run_.document, name);
  if (!flow) {
    InvocationFailed(node, index, absl::StrCat("there is no flow or deployed workflow \"", name, "\""));
    return true;
  }
  if (core_.DepthOf(run_) >= core_.limits.subflow_nesting || core_.runs.size() >= core_.limits.runs_live) {
    InvocationFailed(
        node, index,
        absl::StrCat("subflow ", name,
                     " is nested too deep or too many runs are live; the limits are subflow_nesting ",
                     core_.limits.subflow_nesting, " and runs_live ", core_.limits.runs_live));
    return true;
  }
  TermBinding variables = run_.variables;
  for (const auto& [key, value] : invocation.binding) variables[key] = value;
  SetInvocation(node, index, WorkState::kRunning, absl::StrCat("subflow ", name));
  CommandOwner owner{run_.id, node, index};
  // The child is a run of its own and does not touch this one until it ends.
  RunId child = core_.Start(flow->first, flow->second, std::move(variables),
                            absl::StrCat("subflow of ", Subject(node, index)), &owner);
  run_.nodes[node].invocations[index].child = child;
  return true;
}

void RunStepper::SendReady(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  for (const rsel::Instruction& instruction : invocation.handler->TakeReady()) {
    SendInstruction(node, index, instruction);
  }
}

void RunStepper::SendInstruction(size_t node, size_t index, const rsel::Instruction& instruction) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  RobotCommand command;
  // With the time: a server whose older backup was put back counts its runs anew, and an adapter that remembers an id
  // does not execute it again.
  command.id = CommandId(absl::StrCat(Subject(node), "/", run_.nodes[node].iteration, "/", index, ".",
                                      invocation.attempt, "/", instruction.step, "/", instruction.attempt,
                                      "@", core_.input->now_us));
  command.robot = invocation.robot;
  command.operation = instruction.operation;
  command.arguments = instruction.arguments;
  command.guard_revision = core_.input->revision;
  command.deadline_us = *invocation.deadline_us;
  if (instruction.timeout_ms) {
    command.deadline_us = std::min(command.deadline_us, core_.input->now_us + *instruction.timeout_ms * 1000);
  }
  for (const RobotOffer& offer : core_.input->robots->Offers(instruction.operation)) {
    if (offer.robot != invocation.robot) continue;
    command.expected_incarnation = offer.incarnation;
    command.idempotent = offer.idempotent;
  }
  invocation.step = instruction.label;
  invocation.progress = 0;
  core_.commands[command.id.value()] = {run_.id, node, index};
  core_.output->commands.push_back(command);
  invocation.commands.push_back({std::move(command), instruction.step, instruction.attempt});
}

// Once more to the adapter that lives now, under a new id: the one before may know the old id and never tell.
void RunStepper::Resend(size_t node, size_t index, const OpenCommand& lost, const std::string& incarnation) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  ++invocation.resends;
  OpenCommand again = lost;
  again.command.id =
      CommandId(absl::StrCat(lost.command.id.value(), ".", invocation.resends, "@", core_.input->now_us));
  // A proxy that was turned away knows only whom the command was meant for; then any incarnation will do.
  again.command.expected_incarnation = incarnation == lost.command.expected_incarnation ? "" : incarnation;
  again.command.guard_revision = core_.input->revision;
  core_.commands[again.command.id.value()] = {run_.id, node, index};
  core_.output->commands.push_back(again.command);
  invocation.commands.push_back(std::move(again));
}

// The handler may have come to its end.
void RunStepper::SettleHandler(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  switch (invocation.handler->state()) {
    case rsel::InstructionHandler::State::kRunning:
      return;
    case rsel::InstructionHandler::State::kDone: {
      const rsel::Arguments results = invocation.handler->Results();
      SetInvocation(node, index, WorkState::kDone, "");
      SetVariables(TermBinding(results.begin(), results.end()));  // last: it may end the run
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

void RunStepper::InvocationFailed(size_t node, size_t index, const std::string& reason) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[invocation.invoke];
  CancelCommands(&invocation);
  if (!invocation.child.empty()) core_.Cancel(invocation.child, reason);
  if (invocation.retries < invoke.retry) {
    InvocationState fresh;
    fresh.invoke = invocation.invoke;
    fresh.binding = invocation.binding;
    fresh.attempt = invocation.attempt + 1;
    fresh.retries = invocation.retries + 1;
    invocation = std::move(fresh);
    core_.Say(Subject(node, index), "running", "pending",
              absl::StrCat("attempt ", invocation.attempt, " after: ", reason));
    return;
  }
  SetInvocation(node, index, WorkState::kFailed, reason);
}

void RunStepper::CancelInvocation(size_t node, size_t index, const std::string& reason) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (IsFinal(invocation.state)) return;
  if (invocation.handler) invocation.handler->Cancel(reason);
  CancelCommands(&invocation);
  if (!invocation.child.empty()) core_.Cancel(invocation.child, reason);
  SetInvocation(node, index, WorkState::kCancelled, reason);
}

void RunStepper::CancelCommands(InvocationState* invocation) {
  for (const OpenCommand& open : invocation->commands) {
    core_.output->cancels.push_back(open.command.id);
    core_.commands.erase(open.command.id.value());
  }
  invocation->commands.clear();
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
  core_.commands.erase(report.command.value());
  if (report.outcome == Outcome::kSucceeded) {
    rsel::Arguments results(report.results.begin(), report.results.end());
    core_.Say(absl::StrCat(Subject(owner.node, owner.invocation), " ", invocation.handler->Label(done.step)),
              "running", "done", "");
    invocation.handler->Succeeded(done.step, done.attempt, results);
  } else if (report.outcome == Outcome::kUnknown && done.command.idempotent &&
             invocation.resends < kResendLimit) {
    Resend(owner.node, owner.invocation, done, report.incarnation);
    return;
  } else {
    bool may_retry = report.outcome == Outcome::kFailed || done.command.idempotent;
    std::string reason = !report.message.empty()                 ? report.message
                         : report.outcome == Outcome::kCancelled ? "cancelled at the robot"
                                                                 : "the robot gave no reason";
    core_.Say(absl::StrCat(Subject(owner.node, owner.invocation), " ", invocation.handler->Label(done.step)),
              "running", "failed", reason);
    invocation.handler->Failed(done.step, done.attempt, reason, may_retry);
  }
  SendReady(owner.node, owner.invocation);
  SettleHandler(owner.node, owner.invocation);
}

void RunStepper::ChildEnded(const CommandOwner& owner, const Run& child) {
  InvocationState& invocation = run_.nodes[owner.node].invocations[owner.invocation];
  if (invocation.child != child.id || IsFinal(invocation.state)) return;
  if (child.state != WorkState::kDone) {
    invocation.child = RunId();
    InvocationFailed(owner.node, owner.invocation,
                     absl::StrCat("subflow ", child.id.value(), ": ", child.reason));
    return;
  }
  TermBinding results;
  for (const auto& [name, value] : child.variables) {
    if (run_.variables.count(name) == 0) results.emplace(name, value);
  }
  SetInvocation(owner.node, owner.invocation, WorkState::kDone, "");
  SetVariables(results);  // last: it may end the run
}

}  // namespace docent::engine
