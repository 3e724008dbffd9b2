// Attempts of invocations: their times, their failures, and the end of all that belongs to one before the next begins.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

std::optional<TimeMicros> EarlierOf(std::optional<TimeMicros> a, std::optional<TimeMicros> b) {
  if (!a || (b && *b < *a)) return b;
  return a;
}

}  // namespace

// The end of this attempt that the document gives: of the invoke or of its node.
std::optional<TimeMicros> RunStepper::GivenDeadline(size_t node, size_t index) const {
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[run_.nodes[node].invocations[index].invoke];
  if (!invoke.timeout_ms) return std::nullopt;
  return core_.input->now_us + *invoke.timeout_ms * 1000;
}

// Where the document gives none, for whatever is waited for from now on; a sub-flow's own steps have theirs.
std::optional<TimeMicros> RunStepper::DefaultDeadline(size_t node, size_t index) const {
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[run_.nodes[node].invocations[index].invoke];
  if (invoke.timeout_ms || flow_.nodes[node].timeout_ms || !invoke.subflow.value.empty()) return std::nullopt;
  return core_.input->now_us + core_.limits.default_step_timeout_ms * int64_t{1000};
}

// The end that the document gives to everything in this invocation.
std::optional<TimeMicros> RunStepper::OuterDeadline(size_t node, size_t index) const {
  const InvocationState& invocation = run_.nodes[node].invocations[index];
  const bool given = flow_.nodes[node].invokes[invocation.invoke].timeout_ms.has_value();
  return EarlierOf(given ? invocation.deadline_us : std::nullopt, run_.nodes[node].deadline_us);
}

// Of a step that begins now; `timeout_ms`: its own.
std::optional<TimeMicros> RunStepper::StepDeadline(size_t node, size_t index,
                                                   std::optional<int64_t> timeout_ms) const {
  std::optional<TimeMicros> own = DefaultDeadline(node, index);
  if (timeout_ms) own = core_.input->now_us + *timeout_ms * 1000;
  return EarlierOf(own, OuterDeadline(node, index));
}

// Whether every command of the node's attempts before has its final report.
bool RunStepper::AttemptsEnded(size_t node) const {
  return !core_.ledger.HasEndingOf(run_.id, node);
}

// The time of a node's attempt begins with it: when all of the attempt before has ended, and its ext:retry-delay.
void RunStepper::BeginTime(size_t node) {
  NodeState& state = run_.nodes[node];
  const std::optional<int64_t>& timeout_ms = flow_.nodes[node].timeout_ms;
  if (!timeout_ms || state.deadline_us || run_.paused() || !AttemptsEnded(node)) return;
  const bool too_early =
      std::any_of(state.invocations.begin(), state.invocations.end(), [this](const InvocationState& each) {
        return each.state == WorkState::kPending && each.not_before_us > core_.input->now_us;
      });
  if (!too_early) state.deadline_us = core_.input->now_us + *timeout_ms * 1000;
}

// The attempt failed. The next one, if there is any, begins when all that belongs to this one has ended.
void RunStepper::InvocationFailed(size_t node, size_t index, const std::string& reason) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[invocation.invoke];
  if (invocation.retries >= invoke.retry || invocation.once) {
    LetCommandsEnd(node, index);
    if (!invocation.child.empty()) core_.Cancel(invocation.child, reason);
    return SetInvocation(node, index, WorkState::kFailed, reason);
  }
  const TimeMicros until_us = core_.input->now_us + core_.limits.default_step_timeout_ms * int64_t{1000};
  for (OpenCommand& open : invocation.commands) {
    if (!open.overdue_until_us) core_.output->cancels.push_back(open.command.id);
    open.overdue_until_us = until_us;
  }
  invocation.overdue = reason.empty() ? "it failed" : reason;
  invocation.deadline_us = until_us;
  invocation.reason = absl::StrCat(reason, "; ", ToAbsl(kAttemptNotEnded));
  if (!invocation.child.empty()) core_.Cancel(invocation.child, reason);
  BeginAgain(node, index);
}

// The attempt after one that failed, if the end of everything in that one is known.
void RunStepper::BeginAgain(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (!invocation.commands.empty() || !invocation.child.empty() ||
      core_.ledger.EndingOf({run_.id, node, index}) > 0)
    return;
  const std::string reason = invocation.overdue;
  if (invocation.handler && invocation.handler->state() == rsel::InstructionHandler::State::kDone) {
    invocation.overdue.clear();
    return SettleHandler(node, index);  // too late, but done: it is not done twice
  }
  if (invocation.once) return SetInvocation(node, index, WorkState::kFailed, reason);
  if (IsInterrupted(node)) return SetInvocation(node, index, WorkState::kCancelled, reason);
  core_.Say(Subject(node, index), ToString(invocation.state), "pending",
            absl::StrCat("attempt ", invocation.attempt + 1, " after: ", reason));
  LeaveRobot(node, index);
  core_.waiting.Leave({run_.id, node, index});  // the next attempt asks for a robot again
  InvocationState fresh;
  fresh.invoke = invocation.invoke;
  fresh.binding = invocation.binding;
  fresh.match = invocation.match;
  fresh.sent = invocation.sent;
  fresh.attempt = invocation.attempt + 1;
  fresh.retries = invocation.retries + 1;
  fresh.failure = reason;
  fresh.partly_done = IsPartlyDone(invocation);
  fresh.unknown = invocation.unknown;
  DelayAttempt(flow_.nodes[node].invokes[invocation.invoke].retry_policy, invocation.retries, invocation,
               &fresh);
  invocation = std::move(fresh);
}

std::optional<TimeMicros> RunStepper::NextDeadline() const {
  std::optional<TimeMicros> next;
  TimeMicros until_us = 0;
  if (run_.undoing && run_.undoing->child.empty() && AwaitsOutcomes(&until_us)) next = until_us;
  auto consider = [&next](const std::optional<TimeMicros>& deadline) {
    if (deadline && (!next || *deadline < *next)) next = deadline;
  };
  for (const NodeState& node : run_.nodes) {
    if (node.state != WorkState::kWaiting && node.state != WorkState::kRunning) continue;
    if (!run_.paused()) consider(node.deadline_us);
    for (size_t i = 0; i < node.armed.size() && node.state == WorkState::kWaiting && !run_.paused(); ++i) {
      const size_t index = static_cast<size_t>(&node - run_.nodes.data());
      if (const auto opens = OpensAt(index, i); opens && *opens > core_.input->now_us) consider(opens);
    }
    for (const InvocationState& invocation : node.invocations) {
      if (IsFinal(invocation.state)) continue;
      if (!run_.paused()) consider(invocation.deadline_us);
      if (!run_.paused() && invocation.not_before_us > core_.input->now_us)
        consider(invocation.not_before_us);
      for (const OpenCommand& open : invocation.commands) consider(open.EndsAt());
    }
  }
  return next;
}

std::string TimeText(int64_t ms) {
  for (const auto& [unit_ms, unit] : {std::pair(3'600'000, " h"), {60'000, " min"}, {1000, " s"}}) {
    if (ms >= unit_ms && ms % unit_ms == 0) return absl::StrCat(ms / unit_ms, unit);
  }
  return absl::StrCat(ms, " ms");
}

// True if a time was over.
bool RunStepper::CheckOverdue(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (IsFinal(invocation.state)) return false;
  const TimeMicros now = core_.input->now_us;
  if (!run_.paused() && invocation.deadline_us && *invocation.deadline_us <= now) {
    if (!invocation.overdue.empty() && IsInterrupted(node)) {
      CancelInvocation(node, index, std::string(invocation.overdue));
      return true;
    }
    if (!invocation.overdue.empty()) {
      invocation.once = true;
      InvocationFailed(node, index, absl::StrCat(invocation.overdue, "; ", ToAbsl(kAttemptNotEnded)));
      return true;
    }
    if (invocation.reason == kAttemptNotEnded) {
      invocation.once = true;  // no further attempt would know it either
      InvocationFailed(node, index, absl::StrCat("timed out: ", ToAbsl(kAttemptNotEnded)));
      return true;
    }
    const std::optional<int64_t>& given = flow_.nodes[node].invokes[invocation.invoke].timeout_ms;
    const std::string within = given ? absl::StrCat(" within ", TimeText(*given)) : "";
    InvocationFailed(node, index, absl::StrCat("timed out: ", NotDone(node, index, within)));
    return true;
  }
  if (!invocation.overdue.empty()) return false;
  for (const OpenCommand& open : invocation.commands) {
    const std::optional<TimeMicros> end_us = open.EndsAt();
    if (!end_us || *end_us > now) continue;
    CommandOverdue(node, index, CommandId(open.command.id));
    return true;
  }
  return false;
}

// A command's time is over: it is cancelled. Where its step has another attempt, its end is waited for; else the step fails.
void RunStepper::CommandOverdue(size_t node, size_t index, const CommandId& command) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  const auto open = std::find_if(invocation.commands.begin(), invocation.commands.end(),
                                 [&](const OpenCommand& c) { return c.command.id == command; });
  const std::string label = invocation.handler->Label(open->step);
  if (!open->overdue_until_us && invocation.handler->HasMoreAttempts(open->step)) {
    core_.output->cancels.push_back(command);
    open->overdue_until_us = core_.input->now_us + core_.limits.default_step_timeout_ms * int64_t{1000};
    invocation.reason = absl::StrCat("timed out: ", label, "; ", ToAbsl(kAttemptNotEnded));
    return;
  }
  const std::string reason = absl::StrCat("timed out: ", label, " did not end before its deadline",
                                          invocation.reason.empty() ? "" : "; ", invocation.reason);
  core_.Say(absl::StrCat(Subject(node, index), " ", label), "running", "failed", reason);
  const OpenCommand late = *open;
  invocation.commands.erase(open);
  LetEnd(node, index, late);
  invocation.handler->Failed(late.step, late.attempt, reason, false);
  SendReady(node, index);
  SettleHandler(node, index);
}

void RunStepper::CancelInvocation(size_t node, size_t index, const std::string& reason) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  if (IsFinal(invocation.state)) return;
  if (invocation.handler) invocation.handler->Cancel(reason);
  LetCommandsEnd(node, index);
  ForgetLost(&invocation);
  if (!invocation.child.empty()) core_.Cancel(invocation.child, reason);
  SetInvocation(node, index, WorkState::kCancelled, reason);
}

// The command is cancelled, and the invocation does not wait for its end.
void RunStepper::LetEnd(size_t node, size_t index, const OpenCommand& open) {
  core_.LetEnd(open, {run_.id, node, index});
  run_.nodes[node].invocations[index].late.push_back({open.command.id, open.step});
}

void RunStepper::LetCommandsEnd(size_t node, size_t index) {
  for (const OpenCommand& open : std::exchange(run_.nodes[node].invocations[index].commands, {}))
    LetEnd(node, index, open);
}

// Commands that are not sent again, though it is not known of them how they ended.
void RunStepper::ForgetLost(InvocationState* invocation) {
  for (const OpenCommand& lost : std::exchange(invocation->lost, {}))
    invocation->unknown =
        invocation->unknown || (lost.stopped == Stopped::kNo && lost.recalled == Stopped::kNo);
}

// The robot is no longer occupied by this invocation; what it sent may still be ending.
void RunStepper::LeaveRobot(size_t node, size_t index) {
  const RobotId& robot = run_.nodes[node].invocations[index].robot;
  if (robot.empty()) return;
  core_.ledger.End(robot, {run_.id, node, index});
  core_.released.insert(robot);
  core_.changed_robots.insert(robot);
}

void RunStepper::OutcomeUnknown(const CommandOwner& owner) {
  run_.unknown_outcome = true;
  if (owner.node >= run_.nodes.size() || owner.invocation >= run_.nodes[owner.node].invocations.size())
    return;
  InvocationState& invocation = run_.nodes[owner.node].invocations[owner.invocation];
  if (IsFinal(invocation.state)) return;
  if (invocation.state == WorkState::kPending && invocation.attempt == 1) return;  // it has sent nothing
  invocation.once = true;
  if (invocation.state == WorkState::kPending)
    invocation.reason =
        "the outcome of the attempt before it is not known, and the operation is not idempotent";
}

}  // namespace docent::engine
