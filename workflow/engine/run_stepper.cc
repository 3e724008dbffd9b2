#include "workflow/engine/run_stepper.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/time_reader.h"
#include "workflow/engine/run_values.h"
#include "workflow/engine/start_values.h"
#include "workflow/engine/state/flow_graph.h"

namespace docent::engine {
RunStepper::RunStepper(Engine::Core* core, Run* run)
    : core_(*core),
      run_(*run),
      flow_(run->Flow()),
      graph_(*(run->graph != nullptr ? run->graph : run->graph = core->graphs.Of(run->document, run->flow))) {
}

std::string RunStepper::Subject(size_t node) const {
  return absl::StrCat(run_.id.value(), "/", IriSegment(flow_.nodes[node].name.value));
}

void RunStepper::SetNode(size_t index, WorkState state, const std::string& cause) {
  NodeState& node = run_.nodes[index];
  core_.bounds.Worked(1);
  core_.Say(Subject(index), ToString(node.state), ToString(state), cause);
  node.state = state;
  node.since_us = core_.input->now_us;
  node.deadline_us.reset();
  if (state != WorkState::kWaiting) node.waits_for.clear();
  if (state != WorkState::kRunning) {
    DisarmGuard(&node.guard);
    DisarmGuard(&node.hold);
    node.replaced.clear();
  }
  if (!node.busy_robots.empty()) {
    node.busy_robots.clear();
    core_.Reblock(run_);
  }
  if (state == WorkState::kFailed || state == WorkState::kCancelled || state == WorkState::kSkipped ||
      state == WorkState::kIncident) {
    node.reason = cause;
  }
}

void RunStepper::SetVariables(const TermBinding& binding) {
  std::set<std::string> changed;
  for (const auto& [name, value] : binding) {
    if (name.empty() || name[0] == '_') continue;
    if (value == kNoValue) {
      if (run_.variables.erase(name) > 0) changed.insert(name);
      continue;
    }
    auto [it, inserted] = run_.variables.try_emplace(name, value);
    if (!inserted && it->second != value)
      it->second = value;
    else if (!inserted)
      continue;
    changed.insert(name);
  }
  if (!changed.empty()) RearmWaiting(changed);
}

// What nodes wait for was written with values of before.
void RunStepper::RearmWaiting(const std::set<std::string>& changed) {
  for (size_t i = 0; i < run_.nodes.size(); ++i) {
    if (run_.nodes[i].state != WorkState::kWaiting || !graph_.UsesAny(i, changed)) continue;
    core_.bounds.Worked(1);
    ArmNode(i);
  }
}

void RunStepper::Begin(const std::string& cause) {
  core_.Say(run_.id.value(), "", ToString(WorkState::kRunning), cause);
  if (const std::string fault = TypeFault({*run_.document, flow_}, run_.variables); !fault.empty())
    return End(WorkState::kFailed, fault);
  if (const auto lacks = RequiredWithoutValue(*run_.document, flow_, run_.variables); !lacks.empty())
    return End(WorkState::kFailed, NeedsText(flow_, lacks));
  core_.touched.insert(run_.id);  // it goes on behind older runs that look for the same robot
}

// False for a run that began when its turn had no time left for it.
bool RunStepper::HasEntered() const {
  return run_.sink_reached || std::any_of(run_.nodes.begin(), run_.nodes.end(), [](const NodeState& node) {
           return node.state != WorkState::kInactive || !node.arrived.empty();
         });
}

void RunStepper::Enter() {
  for (size_t link : graph_.LinksFromSource()) Arrive(flow_.source.value, flow_.links[link].to.value, false);
}

void RunStepper::Activate(size_t index) {
  NodeState& node = run_.nodes[index];
  if (!HasCondition(index) && !run_.paused() && !core_.bounds.spent())
    return Open(index, {}, "", "it has no condition", nullptr);
  SetNode(index, WorkState::kWaiting, absl::StrCat("after ", absl::StrJoin(node.arrived, ", ")));
  AwaitCondition(index);
  if (core_.bounds.spent()) core_.unfinished.insert(run_.id);
}

bool RunStepper::HasCondition(size_t index) const {
  const std::optional<cawl::Condition>& condition = flow_.nodes[index].condition;
  return condition && !(condition->contexts.empty() && condition->cases.empty());
}

// From now on. A node without a condition waits only while its run is paused, or for the next turn.
void RunStepper::AwaitCondition(size_t index) {
  if (!HasCondition(index)) return;
  const std::optional<int64_t>& timeout_ms = flow_.nodes[index].condition->timeout_ms;
  if (timeout_ms) run_.nodes[index].deadline_us = core_.input->now_us + *timeout_ms * 1000;
  ArmNode(index);
}

std::vector<std::string> NodeKeys(const cawl::CompiledAsk& ask, bool every) {
  std::vector<std::string> keys = ask.event_variables;
  if (keys.empty() && every) return ask.free_variables;
  // a condition that holds with busy robots only is looked at again when it holds with another robot
  bool any_robot = std::count(ask.free_variables.begin(), ask.free_variables.end(), "robot") > 0;
  if (keys.empty() && any_robot) keys.push_back("robot");
  return keys;
}

void RunStepper::ArmNode(size_t index) {
  if (!HasCondition(index)) return;  // it waits since its run is, or was, paused, or goes on later
  NodeState& node = run_.nodes[index];
  if (node.armed.empty() && core_.bounds.spent()) {  // TryOpen does it
    core_.unfinished.insert(run_.id);
    return;
  }
  auto asks = cawl::CompileCondition(
      *run_.document, *flow_.nodes[index].condition,
      [this](const std::string& name) { return Value(name, nullptr); }, core_.limits);
  if (!asks.ok()) return NodeFailed(index, std::string(asks.status().message()));
  bool same = std::equal(
      asks->begin(), asks->end(), node.armed.begin(), node.armed.end(),
      [](const cawl::CompiledAsk& ask, const ArmedCondition& armed) { return ask.ask == armed.ask.ask; });
  if (same) return;  // other variables changed
  for (cawl::CompiledAsk& ask : *asks) {
    if (absl::Status status = cawl::ParseAsks(core_.limits, &ask); !status.ok())
      return NodeFailed(index, std::string(status.message()));
  }
  DisarmNode(index);
  node.waits_for = WaitsForText(index, *asks);
  for (cawl::CompiledAsk& ask : *asks) {
    const std::vector<std::string> keys = NodeKeys(ask, flow_.nodes[index].holds_condition);
    ConditionHandle handle = core_.Arm(ask, keys, {run_.id, index, ""});
    node.armed.push_back(Armed(handle, std::move(ask)));
  }
}

// What its condition needs, an ASK for each alternative: those of an `or` are armed as one.
std::string RunStepper::WaitsForText(size_t index, const std::vector<cawl::CompiledAsk>& asks) const {
  std::vector<std::string> texts;
  if (std::none_of(asks.begin(), asks.end(), [](const auto& ask) { return ask.has_alternatives; })) {
    for (const cawl::CompiledAsk& ask : asks) texts.push_back(ask.ask);
    return absl::StrJoin(texts, "\n# or\n");
  }
  for (const cawl::Alternative& alternative : cawl::AlternativesOf(*flow_.nodes[index].condition)) {
    auto ask = cawl::CompileAlternative(
        *run_.document, alternative, [this](const std::string& name) { return Value(name, nullptr); },
        core_.limits);
    if (ask.ok()) texts.push_back(std::move(ask->ask));
  }
  return absl::StrJoin(texts, "\n# or\n");
}

void RunStepper::DisarmNode(size_t index) {
  for (const ArmedCondition& armed : run_.nodes[index].armed) core_.Disarm(armed.handle);
  run_.nodes[index].armed.clear();
}

bool RunStepper::TryOpen(size_t index) {
  if (HasCondition(index) && run_.nodes[index].armed.empty()) {
    ArmNode(index);
    return run_.nodes[index].state != WorkState::kWaiting;
  }
  if (run_.paused()) {  // events come once
    for (ArmedCondition& armed : run_.nodes[index].armed) TakeEvents(&armed);
    return false;
  }
  if (!HasCondition(index)) {
    Open(index, {}, "", "it has no condition", nullptr);
    return true;
  }
  std::set<RobotId> busy;
  for (size_t i = 0; i < run_.nodes[index].armed.size(); ++i) {
    ArmedCondition& armed = run_.nodes[index].armed[i];
    TakeEvents(&armed);
    if (const auto opens = OpensAt(index, i); opens && *opens > core_.input->now_us) continue;
    if (HasToAskAgain(armed)) {
      AskAgain();
      return false;
    }
    if (TryOpenWith(index, armed, &busy)) return true;  // `armed` may be gone
  }
  if (busy != run_.nodes[index].busy_robots) {
    run_.nodes[index].busy_robots = std::move(busy);
    core_.Reblock(run_);
    if (run_.preempts)
      core_.coveted.insert(run_.nodes[index].busy_robots.begin(), run_.nodes[index].busy_robots.end());
  }
  return false;
}

// When an alternative may open the node at the earliest: <ext:time after="30s"/>.
std::optional<TimeMicros> RunStepper::OpensAt(size_t index, size_t alternative) const {
  const std::vector<int64_t> delays = cawl::DelaysOf(*flow_.nodes[index].condition);
  if (alternative >= delays.size() || delays[alternative] == 0) return std::nullopt;
  return run_.nodes[index].since_us + delays[alternative] * 1000;
}

void RunStepper::Open(size_t index, const std::vector<TermBinding>& bindings, std::string evidence,
                      const std::string& cause, const ArmedCondition* by) {
  const cawl::Node& syntax = flow_.nodes[index];
  NodeState& node = run_.nodes[index];
  absl::Status guarded = by == nullptr ? absl::OkStatus() : KeepGuard(index, ArmedCondition(*by));
  std::optional<Guard> guard = std::exchange(node.guard, std::nullopt);
  if (guard) guard->every = syntax.holds_condition && guard->armed.handle != 0;
  DisarmNode(index);
  SetNode(index, WorkState::kRunning, cause);
  node.guard = std::move(guard);
  node.fired_because = std::move(evidence);
  node.fired_us = core_.input->now_us;
  std::erase_if(node.invocations, [](const InvocationState& old) { return old.state != WorkState::kDone; });
  BeginTime(index);
  node.actions = {};
  if (!guarded.ok()) return NodeImpossible(index, guarded);
  for (const TermBinding& binding : bindings) {
    if (const std::string fault = TypeFault({*run_.document, flow_, &syntax}, binding); !fault.empty())
      return NodeImpossible(index, absl::InvalidArgumentError(fault));
  }
  if (!bindings.empty()) {
    for (const auto& [name, value] : bindings.front()) {
      const auto before = run_.variables.find(name);
      if (before == run_.variables.end())
        node.replaced[name] = {value, std::nullopt};
      else if (before->second != value)
        node.replaced[name] = {value, before->second};
    }
    SetVariables(bindings.front());
  }
  // new values can make another node's condition impossible, and that may end the run or begin a loop again
  if (!GoesOn() || node.state != WorkState::kRunning) return;
  if (absl::Status held = ArmHold(index); !held.ok()) return NodeImpossible(index, held);
  run_.nodes[index].actions.bindings = WithDoneValues(index, bindings);
  GoOnOpening(index, true);
}

// True if the node came to an end.
bool RunStepper::CheckNode(size_t index) {
  NodeState& node = run_.nodes[index];
  if (node.state != WorkState::kRunning || !node.pending_links.empty()) return false;
  const InvocationState* failed = nullptr;
  bool all_done = true;
  for (const InvocationState& invocation : node.invocations) {
    if (invocation.state == WorkState::kFailed || invocation.state == WorkState::kCancelled)
      failed = &invocation;
    all_done = all_done && invocation.state == WorkState::kDone;
  }
  if (failed != nullptr) {
    NodeFailed(index, failed->reason);
    return true;
  }
  if (!all_done || DoActions(index, true) == Progress::kWaits) return false;
  if (run_.state == WorkState::kRunning && node.state == WorkState::kRunning) NodeDone(index);
  return true;
}

void RunStepper::NodeFailed(size_t index, const std::string& reason) {
  const cawl::Node& syntax = flow_.nodes[index];
  NodeState& node = run_.nodes[index];
  DisarmNode(index);
  // Where none failed, they end with what ends the node: its time, what has to hold.
  const bool of_invocation =
      std::any_of(node.invocations.begin(), node.invocations.end(), [](const InvocationState& invocation) {
        return invocation.state == WorkState::kFailed || invocation.state == WorkState::kCancelled;
      });
  for (size_t i = 0; i < node.invocations.size(); ++i)
    CancelInvocation(index, i, of_invocation ? "another invocation of the node failed" : reason);
  const bool once = std::any_of(node.invocations.begin(), node.invocations.end(),
                                [](const InvocationState& invocation) { return invocation.once; });
  if (node.state == WorkState::kRunning && node.attempt <= syntax.retry && !once) {
    ++node.attempt;
    core_.Say(Subject(index), "running", "running",
              absl::StrCat("attempt ", node.attempt, " after: ", reason));
    node.deadline_us.reset();  // it begins with the attempt (BeginTime)
    for (InvocationState& old : node.invocations) {
      if (old.state == WorkState::kDone) continue;  // what is done is not done again
      InvocationState fresh;
      fresh.invoke = old.invoke;
      fresh.binding = old.binding;
      fresh.match = old.match;
      fresh.sent = old.sent;
      fresh.attempt = old.attempt + 1;  // its own retries begin anew
      fresh.failure = old.state == WorkState::kFailed ? old.reason : old.failure;
      fresh.partly_done = IsPartlyDone(old);
      fresh.unknown = old.unknown;
      if (!old.late.empty()) {  // if it succeeds all the same, it is done
        fresh.late = old.late;
        fresh.handler = old.handler;
      }
      DelayAttempt(syntax.retry_policy, node.attempt - 2, old, &fresh);
      old = std::move(fresh);
    }
    return;  // they are sent as the run advances
  }
  if (WaitsForOperator(index))
    BeginIncident(index, reason);
  else
    NodeFailedForGood(index, reason);
}

void RunStepper::NodeFailedForGood(size_t index, const std::string& reason) {
  const std::string& name = flow_.nodes[index].name.value;
  NoteDone(index);
  const std::string why = absl::StrCat(reason, DoOnFailure(index));
  SetNode(index, WorkState::kFailed, why);
  std::vector<size_t> taken;
  for (size_t i : graph_.LinksFrom(index)) {
    if (flow_.links[i].on_failure) taken.push_back(i);
  }
  if (taken.empty()) return End(WorkState::kFailed, absl::StrCat("node ", name, ": ", why));
  FollowLinks(index, taken);
}

// It fails whatever its ext:retry says: what it asks for cannot be asked.
void RunStepper::NodeImpossible(size_t index, const absl::Status& why) {
  run_.nodes[index].attempt = flow_.nodes[index].retry + 1;
  NodeFailed(index, std::string(why.message()));
}

void RunStepper::GiveUp(size_t index, const absl::Status& why) {
  const WorkState state = run_.nodes[index].state;
  if (run_.state != WorkState::kRunning) return;
  if (state == WorkState::kWaiting || state == WorkState::kRunning) NodeImpossible(index, why);
}

void RunStepper::CancelNode(size_t index, const std::string& reason) {
  NodeState& node = run_.nodes[index];
  if (!IsLive(node.state)) return;
  DisarmNode(index);
  for (const PendingLink& pending : node.pending_links) core_.Disarm(pending.handle);
  node.pending_links.clear();
  for (size_t i = 0; i < node.invocations.size(); ++i) CancelInvocation(index, i, reason);
  if (run_.state == WorkState::kRunning || !run_.parent.empty()) NoteDone(index);
  SetNode(index, WorkState::kCancelled, reason);
}

bool RunStepper::CheckDeadlines(size_t index) {
  NodeState& node = run_.nodes[index];
  TimeMicros now = core_.input->now_us;
  if (!run_.paused() && node.deadline_us && *node.deadline_us <= now) {
    NodeFailed(index, node.state == WorkState::kWaiting ? NotOpened(index) : NotDone(index));
    return true;
  }
  for (size_t i = 0; i < node.invocations.size(); ++i) {
    if (CheckOverdue(index, i)) return true;
  }
  return false;
}

// In the second half of a turn, only runs that this turn started go on, and only until they have done something. All others go on in
// the next turn.
bool RunStepper::HasToGoOnLater() const {
  const bool late = core_.turn_round >= core_.limits.engine_rounds_per_turn / 2;
  return late && (core_.gone_on.contains(run_.id) || core_.undo_runs.at(run_.id).has_value());
}

void RunStepper::Advance() {
  const bool waits_for_tick = run_.timer_us == kNextTick && !core_.input->clock_tick;
  if ((core_.bounds.spent() || waits_for_tick || HasToGoOnLater()) && run_.state == WorkState::kRunning)
    return GoOnLater();
  core_.resumed.insert(run_.id);
  if (run_.undoing) return Undo();
  if (!HasEntered() && GoesOn()) Enter();
  bool changed = true;
  while (changed && GoesOn()) {
    changed = false;
    for (size_t i = 0; i < run_.nodes.size() && GoesOn(); ++i) {
      if (core_.bounds.spent()) return GoOnLater();
      switch (run_.nodes[i].state) {
        case WorkState::kWaiting:
          changed = TryOpen(i) || CheckDeadlines(i) || changed;
          break;
        case WorkState::kRunning:
          if (!run_.nodes[i].pending_links.empty()) {
            // armed in an earlier round: the level is known; armed in this one: it is not yet
            if (IsKnown(run_.nodes[i].pending_links[0].handle)) changed = ResolvePendingLinks(i) || changed;
            break;
          }
          if (IsOpening(i)) {
            BeginTime(i);
            changed = GoOnOpening(i, false) || CheckDeadlines(i) || changed;
            break;
          }
          if (IsInterrupted(i)) {
            changed = SettleInterrupt(i) || CheckDeadlines(i) || changed;
            break;
          }
          if (CheckHold(i)) {
            changed = true;
            break;
          }
          BeginTime(i);
          for (size_t k = 0; k < run_.nodes[i].invocations.size(); ++k) {
            changed = GoOn(i, k) || changed;
            if (!GoesOn() || run_.nodes[i].state != WorkState::kRunning) break;
          }
          if (!GoesOn() || run_.nodes[i].state != WorkState::kRunning) break;
          SettleGuard(i);
          changed = CheckNode(i) || CheckDeadlines(i) || changed;
          break;
        default:
          break;
      }
    }
    if (GoesOn()) changed = CheckEnd() || changed;
    if (changed) core_.advanced.insert(run_.id);
  }
}

// The turn has done enough for runs: this one goes on in the next. What happens only now is taken: events, and the levels of
// `while` links, which do not outlast a turn.
void RunStepper::GoOnLater() {
  core_.unfinished.insert(run_.id);
  for (size_t i = 0; i < run_.nodes.size() && GoesOn(); ++i) {
    NodeState& node = run_.nodes[i];
    if (!node.pending_links.empty() && IsKnown(node.pending_links[0].handle)) ResolvePendingLinks(i);
    if (node.state != WorkState::kWaiting) continue;
    for (ArmedCondition& armed : node.armed) TakeEvents(&armed);
  }
}

bool RunStepper::CheckEnd() {
  for (const NodeState& node : run_.nodes) {
    if (IsLive(node.state)) return false;
  }
  if (run_.sink_reached)
    End(WorkState::kDone, "");
  else
    End(WorkState::kFailed, "no path reached the sink");
  return true;
}

void RunStepper::End(WorkState state, const std::string& why) {
  if (run_.state != WorkState::kRunning) return;
  if (state == WorkState::kFailed && GoesOn() && BeginUndo(state, why)) return;
  const std::string reason = run_.undoing ? EndUndoing(why) : why;
  run_.state = state;  // first: what is cancelled below must not go on
  core_.ended.insert(run_.id);
  for (size_t i = 0; i < run_.nodes.size(); ++i) {
    CancelNode(i, state == WorkState::kDone ? "the sink was reached" : reason);
  }
  if (!run_.parent.empty()) GatherDoneSteps();  // for the run that it is nested in
  WithdrawUntilEnd();
  run_.reason = reason;
  run_.ended_us = core_.input->now_us;
  core_.Say(run_.id.value(), ToString(WorkState::kRunning), ToString(state), reason);
}

}  // namespace docent::engine
