// Guards of a run's nodes: the condition that opened a node is asked again in the turn that sends its first command, and
// what has to hold while the node runs (ext:while-holds) is watched.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/state/flow_graph.h"

namespace docent::engine {

bool RunStepper::IsKnown(ConditionHandle handle) const {
  return !core_.IsArming(handle);
}

RunStepper::Answer RunStepper::Ask(const Guard& guard, const TermBinding& match) {
  if (guard.armed.handle == 0) {  // it is only asked for when something waits
    if (!WroteInThisRound()) return Answer::kYes;
    core_.awaiting.insert(run_.id);  // what it and its sub-flows wrote is seen in the next round
    return Answer::kUnknown;
  }
  if (core_.MayHaveChanged(guard.armed.handle)) {
    AskAgain();
    return Answer::kUnknown;
  }
  if (!IsKnown(guard.armed.handle)) {
    core_.awaiting.insert(run_.id);  // its level comes with the next round
    return Answer::kUnknown;
  }
  if (!core_.input->conditions->Holds(guard.armed.handle)) return Answer::kNo;
  if (match.empty()) return Answer::kYes;
  const auto solutions = core_.input->conditions->Solutions(guard.armed.handle, match, 1);
  return solutions.ok() && !solutions->empty() ? Answer::kYes : Answer::kNo;
}

// The match without what only tells events apart.
TermBinding RunStepper::MatchOf(const cawl::CompiledAsk& ask, const TermBinding& solution) {
  TermBinding match;
  for (const std::string& name : ask.free_variables) {
    if (const auto value = solution.find(name); value != solution.end()) match.insert(*value);
  }
  return match;
}

// `by` opens the node: it becomes its guard. An event has happened by then, and is not asked for again.
absl::Status RunStepper::KeepGuard(size_t index, const ArmedCondition& by) {
  NodeState& node = run_.nodes[index];
  if (!by.ask.by_event()) {
    node.guard = Guard{by, false};
    std::erase_if(node.armed, [&](const ArmedCondition& armed) { return armed.handle == by.handle; });
    return absl::OkStatus();
  }
  const auto place = std::find_if(node.armed.begin(), node.armed.end(),
                                  [&](const ArmedCondition& armed) { return armed.handle == by.handle; });
  auto asks = cawl::CompileCondition(
      *run_.document, *flow_.nodes[index].condition,
      [this](const std::string& name) { return Value(name, nullptr); }, core_.limits, nullptr,
      cawl::Events::kHappened);
  if (!asks.ok()) return asks.status();
  cawl::CompiledAsk& ask = (*asks)[static_cast<size_t>(place - node.armed.begin())];
  if (absl::Status status = cawl::ParseAsks(core_.limits, &ask); !status.ok()) return status;
  node.guard = Guard{Armed(0, std::move(ask)), false};
  return absl::OkStatus();
}

// Whether the guard may still have to be asked.
bool RunStepper::NeedsGuard(size_t index) const {
  const cawl::Node& syntax = flow_.nodes[index];
  const NodeState& node = run_.nodes[index];
  if (node.state != WorkState::kRunning) return false;
  if (syntax.holds_condition || node.attempt <= syntax.retry) return true;
  return std::any_of(
      node.invocations.begin(), node.invocations.end(), [&](const InvocationState& invocation) {
        return !IsFinal(invocation.state) && (invocation.state == WorkState::kPending ||
                                              invocation.retries < syntax.invokes[invocation.invoke].retry);
      });
}

// Lets go of a guard that is not asked any more, and arms one that is not armed yet.
void RunStepper::SettleGuard(size_t index) {
  NodeState& node = run_.nodes[index];
  if (!node.guard) return;
  if (!NeedsGuard(index)) return DisarmGuard(&node.guard);
  if (node.guard->armed.handle == 0) ArmGuard(index, flow_.nodes[index].holds_condition);
}

// `every`: a change of any match is to be noticed.
void RunStepper::ArmGuard(size_t index, bool every) {
  Guard& guard = *run_.nodes[index].guard;
  if (guard.armed.handle != 0) core_.Disarm(guard.armed.handle);
  guard.every = every;
  guard.armed.handle = core_.Arm(guard.armed.ask, NodeKeys(guard.armed.ask, every), {run_.id, index, ""});
  core_.awaiting.insert(run_.id);
}

void RunStepper::DisarmGuard(std::optional<Guard>* guard) {
  if (*guard && (*guard)->armed.handle != 0) core_.Disarm((*guard)->armed.handle);
  guard->reset();
}

// The node writes before its invocations begin: that does not close its own guard.
void RunStepper::WritesAtOpen(size_t index) {
  NodeState& node = run_.nodes[index];
  if (!node.guard || flow_.nodes[index].invokes.empty()) return;
  if (node.guard->armed.handle == 0) ArmGuard(index, flow_.nodes[index].holds_condition);
  core_.wrote_at_open.emplace(run_.id, index);
}

void Engine::Core::LetOwnGuardsGo() {
  for (const auto& [id, node] : std::exchange(wrote_at_open, {})) {
    if (Run* run = Mutable(id)) RunStepper(this, run).LetOwnGuardGo(node);
  }
}

void RunStepper::LetOwnGuardGo(size_t index) {
  NodeState& node = run_.nodes[index];
  if (node.state != WorkState::kRunning || !node.guard || node.guard->armed.handle == 0) return;
  const Guard& guard = *node.guard;
  std::vector<TermBinding> matches;
  for (const TermBinding& match : node.actions.bindings) matches.push_back(MatchOf(guard.armed.ask, match));
  for (const InvocationState& invocation : node.invocations) matches.push_back(invocation.match);
  const bool fell = std::any_of(matches.begin(), matches.end(),
                                [&](const TermBinding& match) { return Ask(guard, match) == Answer::kNo; });
  if (fell) DisarmGuard(&node.guard);
}

// What has to hold while the node runs, with the values that it has now.
absl::Status RunStepper::ArmHold(size_t index) {
  const cawl::Node& syntax = flow_.nodes[index];
  if (!syntax.hold) return absl::OkStatus();
  auto ask = cawl::CompileConstraint(
      *run_.document, *syntax.hold, [this](const std::string& name) { return Value(name, nullptr); },
      core_.limits);
  if (!ask.ok()) return ask.status();
  if (absl::Status status = cawl::ParseAsks(core_.limits, &*ask); !status.ok()) return status;
  const ConditionHandle handle = core_.Arm(*ask, {}, {run_.id, index, ""});
  run_.nodes[index].hold = Guard{Armed(handle, *std::move(ask)), false};
  core_.awaiting.insert(run_.id);
  return absl::OkStatus();
}

// Something was begun since the node opened: in this attempt, or in one before. What has to hold has to until the node is done,
// also between attempts.
bool RunStepper::HasBegun(size_t index) const {
  const std::vector<InvocationState>& invocations = run_.nodes[index].invocations;
  return std::any_of(invocations.begin(), invocations.end(),
                     [](const InvocationState& invocation) { return invocation.sent; });
}

// No invocation of the node does anything now, or has done something.
bool RunStepper::NothingBegun(size_t index) const {
  const std::vector<InvocationState>& invocations = run_.nodes[index].invocations;
  return std::all_of(invocations.begin(), invocations.end(), [](const InvocationState& invocation) {
    return invocation.state == WorkState::kPending;
  });
}

// Whether an invocation that has sent nothing in this attempt may begin. `*changed`: the node went back to waiting.
bool RunStepper::MayBegin(size_t node, size_t index, bool* changed) {
  NodeState& state = run_.nodes[node];
  if (state.guard) {
    const Answer answer = Ask(*state.guard, state.invocations[index].match);
    if (answer == Answer::kUnknown) return false;
    if (answer == Answer::kNo) {
      *changed = NothingBegun(node);
      const std::string why = absl::StrCat("condition ", state.guard->armed.ask.name, ToAbsl(kCeasedToHold));
      if (*changed)
        WaitAgain(node, why);
      else
        WaitForOwnRobot(node, index, why);
      // others of the node go on: it is to be noticed when this match holds again. (A time that must have passed would begin again.)
      if (!*changed && !state.guard->every && state.guard->armed.ask.lasting.empty()) ArmGuard(node, true);
      return false;
    }
  }
  if (!state.hold) return true;
  const Answer answer = Ask(*state.hold, {});
  if (answer == Answer::kNo) WaitForOwnRobot(node, index, kHoldsNot);
  return answer == Answer::kYes;
}

// True if what has to hold fell, and the node was interrupted.
bool RunStepper::CheckHold(size_t index) {
  NodeState& node = run_.nodes[index];
  const bool all_ended =
      std::all_of(node.invocations.begin(), node.invocations.end(),
                  [](const InvocationState& invocation) { return IsFinal(invocation.state); });
  if (all_ended || !HasBegun(index)) return false;
  if (node.hold && Ask(*node.hold, {}) == Answer::kNo) {
    Interrupt(index, absl::StrCat("what has to hold ceased to: ", flow_.nodes[index].hold_text.value));
    return true;
  }
  if (!flow_.nodes[index].holds_condition || !node.guard) return false;
  for (const InvocationState& invocation : node.invocations) {
    if (IsFinal(invocation.state) || Ask(*node.guard, invocation.match) != Answer::kNo) continue;
    Interrupt(index, absl::StrCat("condition ", node.guard->armed.ask.name, ToAbsl(kCeasedToHold)));
    return true;
  }
  return false;
}

// Whether nothing can be heard now of how its commands end, those of attempts before included.
bool RunStepper::IsOutOfReach(size_t node, size_t index) const {
  const auto is_silent = [this](const RobotCommand& command) {
    const RobotOffer* offer = core_.OfferOf(command.operation, command.robot);
    return offer == nullptr || offer->offline;
  };
  const std::vector<OpenCommand>& commands = run_.nodes[node].invocations[index].commands;
  if (std::any_of(commands.begin(), commands.end(),
                  [&](const OpenCommand& open) { return !is_silent(open.command); }))
    return false;
  const CommandOwner self{run_.id, node, index};
  if (core_.ledger.EndingOf(self) == 0) return true;
  const RobotLedger::Ending& ending = core_.ledger.ending();
  return std::none_of(ending.begin(), ending.end(), [&](const auto& other) {
    const std::vector<CommandOwner>& owners = other.second.owners;
    return !owners.empty() && owners.front() == self && !is_silent(other.second.command);
  });
}

// What the node does is cancelled. The end of its commands is waited for: what succeeds all the same is done.
void RunStepper::Interrupt(size_t index, const std::string& why) {
  NodeState& node = run_.nodes[index];
  const TimeMicros until_us = core_.input->now_us + core_.limits.default_step_timeout_ms * int64_t{1000};
  for (size_t i = 0; i < node.invocations.size(); ++i) {
    InvocationState& invocation = node.invocations[i];
    if (IsFinal(invocation.state)) continue;
    if (IsOutOfReach(index, i)) {
      CancelInvocation(index, i, why);
      continue;
    }
    for (OpenCommand& open : invocation.commands) {
      if (!open.overdue_until_us) core_.output->cancels.push_back(open.command.id);
      open.overdue_until_us = until_us;
    }
    ForgetLost(&invocation);
    invocation.overdue = why;
    invocation.deadline_us = until_us;
    invocation.not_before_us.reset();
    invocation.reason =
        absl::StrCat(why, "; ",
                     invocation.state == WorkState::kPending ? ToAbsl(kAttemptNotEnded)
                                                             : "how its command ends is not known yet");
    node.reason = Concat(kInterrupted, why);
    node.deadline_us.reset();  // the wait for the end has its own
  }
  if (!IsInterrupted(index)) return Interrupted(index, why);
  core_.Say(Subject(index), "running", "running", node.reason);
}

// True if the end of what was cancelled is known, and the node is done, was interrupted, or failed.
bool RunStepper::SettleInterrupt(size_t index) {
  NodeState& node = run_.nodes[index];
  for (size_t i = 0; i < node.invocations.size(); ++i) {
    if (IsFinal(node.invocations[i].state)) continue;
    BeginAgain(index, i);  // as done or cancelled, where its end is known
    if (!GoesOn() || node.state != WorkState::kRunning) return true;
    if (!IsFinal(node.invocations[i].state) && IsOutOfReach(index, i))
      CancelInvocation(index, i, std::string(node.invocations[i].overdue));
  }
  const auto has = [&node](auto&& is) {
    return std::any_of(node.invocations.begin(), node.invocations.end(), is);
  };
  if (has([](const InvocationState& invocation) { return !IsFinal(invocation.state); })) return false;
  const std::string why = std::exchange(node.reason, "").substr(kInterrupted.size());
  if (!has([](const InvocationState& invocation) { return invocation.state != WorkState::kDone; })) {
    CheckNode(index);
  } else if (has([](const InvocationState& invocation) { return invocation.once; }) &&
             InterruptLinks(index).empty()) {
    NodeFailed(index,
               absl::StrCat(why, "; how its command ended is unknown, and the operation is not idempotent"));
  } else {
    Interrupted(index, why);
  }
  return true;
}

std::vector<size_t> RunStepper::InterruptLinks(size_t index) const {
  std::vector<size_t> links;
  for (size_t link : graph_.LinksFrom(index)) {
    if (flow_.links[link].on_interrupt) links.push_back(link);
  }
  return links;
}

// It takes its links with onInterrupt, or waits again.
void RunStepper::Interrupted(size_t index, const std::string& why) {
  const std::vector<size_t> taken = InterruptLinks(index);
  if (taken.empty()) {
    run_.nodes[index].attempt = 1;  // it begins from its start
    return WaitAgain(index, why);
  }
  NoteDone(index);
  SetNode(index, WorkState::kCancelled, why);
  FollowLinks(index, taken);
}

// Back to waiting for the condition, as before the match that opened the node.
void RunStepper::WaitAgain(size_t index, const std::string& why, std::vector<InvocationState> kept) {
  NodeState& node = run_.nodes[index];
  for (size_t i = 0; i < node.invocations.size(); ++i) {
    const InvocationState& invocation = node.invocations[i];
    if (!IsFinal(invocation.state)) SetInvocation(index, i, WorkState::kCancelled, why);
    const bool sent = invocation.attempt > 1 || !invocation.robot.empty() || invocation.sent;
    node.first_attempt = std::max(node.first_attempt, invocation.attempt + (sent ? 1 : 0));
  }
  NoteDone(index, !kept.empty());  // what is kept may be done with the rest
  node.invocations = std::move(kept);
  node.fired_because.clear();
  node.fired_us = 0;
  const std::map<std::string, ReplacedValue> replaced = std::exchange(node.replaced, {});
  SetNode(index, WorkState::kWaiting, why);
  PutBack(replaced);
  if (!GoesOn() || run_.nodes[index].state != WorkState::kWaiting) return;
  if (!HasCondition(index) && !run_.paused()) return Open(index, {}, "", "it has no condition", nullptr);
  AwaitCondition(index);
}

// The values that a match gave to the run and that nothing has changed since.
void RunStepper::PutBack(const std::map<std::string, ReplacedValue>& replaced) {
  std::set<std::string> changed;
  for (const auto& [name, value] : replaced) {
    const auto now = run_.variables.find(name);
    if (now == run_.variables.end() || now->second != value.given) continue;
    if (value.before)
      now->second = *value.before;
    else
      run_.variables.erase(now);
    changed.insert(name);
  }
  if (!changed.empty()) RearmWaiting(changed);
}

}  // namespace docent::engine
