// What an operator does with nodes of a run: incidents and how they are settled, commands that are stopped, values of
// variables.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/state/flow_graph.h"

namespace docent::engine {
namespace {

std::string ByOperator(std::string_view what, const std::string& reason) {
  return Concat("an operator ", what, reason.empty() ? "" : ": ", reason);
}

}  // namespace

// Of a node that fails for good. What the node itself says beats its links with onFailure, and these what the flow says.
bool RunStepper::WaitsForOperator(size_t index) const {
  const cawl::Node& node = flow_.nodes[index];
  if (node.on_failure != cawl::OnFailure::kUnset) return node.on_failure == cawl::OnFailure::kIncident;
  if (flow_.on_failure != cawl::OnFailure::kIncident) return false;
  const std::vector<size_t>& links = graph_.LinksFrom(index);
  return std::none_of(links.begin(), links.end(), [&](size_t link) { return flow_.links[link].on_failure; });
}

void RunStepper::BeginIncident(size_t index, const std::string& reason) {
  NodeState& node = run_.nodes[index];
  DisarmNode(index);
  for (const PendingLink& pending : std::exchange(node.pending_links, {})) core_.Disarm(pending.handle);
  for (size_t i = 0; i < node.invocations.size(); ++i) CancelInvocation(index, i, reason);
  std::map<std::string, ReplacedValue> replaced = std::move(node.replaced);
  SetNode(index, WorkState::kIncident, reason);
  node.replaced = std::move(replaced);
  LetRobotsGo(index);
}

// Robots of a node that waits for an operator serve other runs meanwhile, once their commands have ended. Where nothing else
// of the run goes on, so do all of its robots.
void RunStepper::LetRobotsGo(size_t index) {
  const bool others_go_on = std::any_of(run_.nodes.begin(), run_.nodes.end(), [](const NodeState& node) {
    return node.state == WorkState::kWaiting || node.state == WorkState::kRunning;
  });
  std::set<RobotId> robots = run_.robots;
  if (others_go_on) {
    robots.clear();
    for (const InvocationState& invocation : run_.nodes[index].invocations) {
      if (!invocation.robot.empty()) robots.insert(invocation.robot);
    }
  }
  std::set<RunId> nest;  // this run and those that it is nested in
  for (const Run* run = &run_; run != nullptr;) {
    nest.insert(run->id);
    const auto outer = core_.runs.find(run->parent);
    run = outer == core_.runs.end() ? nullptr : &outer->second;
  }
  const std::set<RunId>& tree = core_.trees.at(core_.RootOf(run_));
  for (const RobotId& robot : robots) {
    const bool used = std::any_of(tree.begin(), tree.end(), [&](const RunId& id) {
      const auto run = core_.runs.find(id);
      return !nest.contains(id) && run != core_.runs.end() && run->second.robots.contains(robot);
    });
    if (used || !core_.ledger.Tasks(robot).empty()) continue;
    for (const RunId& id : nest) {
      if (Run* run = core_.Mutable(id)) run->robots.erase(robot);
    }
    core_.released.insert(robot);
    core_.changed_robots.insert(robot);
  }
}

bool MaySettle(const NodeState& node) {
  if (node.state == WorkState::kIncident) return true;
  const bool retried = node.first_attempt > 1 || !node.wanted_robot.empty();
  if (!retried || !node.pending_links.empty()) return false;
  return node.state == WorkState::kWaiting ||
         (node.state == WorkState::kRunning && node.actions.begun &&
          std::all_of(node.invocations.begin(), node.invocations.end(), [](const InvocationState& each) {
            return each.state == WorkState::kPending || each.state == WorkState::kDone;
          }));
}

// What has begun nothing since an operator had the node begin again.
void RunStepper::TakeBackRetry(size_t index) {
  NodeState& node = run_.nodes[index];
  if (node.state == WorkState::kIncident) return;
  DisarmNode(index);
  DisarmGuard(&node.guard);
  DisarmGuard(&node.hold);
  for (size_t i = 0; i < node.invocations.size(); ++i)
    CancelInvocation(index, i, "an operator takes it back");
}

void RunStepper::RetryNode(size_t index, const RobotId& robot, const std::string& reason) {
  NodeState& node = run_.nodes[index];
  if (!MaySettle(node)) return;
  TakeBackRetry(index);
  node.wanted_robot = robot;
  node.attempt = 1;
  node.reason = reason.empty() ? "" : ByOperator("has it begin again", reason);
  std::vector<InvocationState> done;
  for (const InvocationState& invocation : node.invocations) {
    if (invocation.state != WorkState::kDone) continue;
    done.push_back(invocation);
    done.back().sent = false;  // not since the node opens again
  }
  WaitAgain(index, ByOperator("has it begin again", reason), std::move(done));
}

void RunStepper::SkipNode(size_t index, const TermBinding& values, const std::string& reason) {
  NodeState& node = run_.nodes[index];
  if (!MaySettle(node)) return;
  TakeBackRetry(index);
  // Nothing is left to do in it: it is done as the run advances.
  for (const InvocationState& invocation : node.invocations)
    node.first_attempt = std::max(node.first_attempt, invocation.attempt + 1);
  node.invocations.clear();
  node.actions.begun = true;  // what it had left to do before them, too
  node.actions.awaited.clear();
  node.reason = ByOperator("skips it", reason);
  SetNode(index, WorkState::kRunning, node.reason);
  SetVariables(values);
}

void RunStepper::FailNode(size_t index, const std::string& reason) {
  if (!MaySettle(run_.nodes[index])) return;
  TakeBackRetry(index);
  NodeFailedForGood(index,
                    absl::StrCat(run_.nodes[index].reason, run_.nodes[index].reason.empty() ? "" : "; ",
                                 ByOperator("let it fail", reason)));
}

void RunStepper::SetVariable(const std::string& name, const Term& value) {
  core_.Say(absl::StrCat(run_.id.value(), "/$", name), "", ToDisplay(value), "an operator set it");
  SetVariables({{name, value}});
}

void RunStepper::StopCommands(Stopped why, const RobotId* robot) {
  for (NodeState& node : run_.nodes) {
    for (InvocationState& invocation : node.invocations) {
      for (OpenCommand& open : invocation.commands) {
        const bool meant = robot == nullptr || open.command.robot == *robot;
        if (!meant || open.overdue_until_us || open.stopped != Stopped::kNo) continue;
        core_.output->cancels.push_back(open.command.id);
        open.stopped = why;
      }
    }
  }
}

// What no robot has begun does not begin while the run is paused, or the robot takes no commands.
void RunStepper::RecallCommands(Stopped why, const RobotId* robot) {
  for (NodeState& node : run_.nodes) {
    for (InvocationState& invocation : node.invocations) {
      for (OpenCommand& open : invocation.commands) {
        const bool meant = robot == nullptr || open.command.robot == *robot;
        if (!meant || open.IsEnding() || open.recalled != Stopped::kNo) continue;
        core_.output->recalls.push_back(open.command.id);
        open.recalled = why;
      }
    }
  }
}

// A command that was cancelled, or called back, has ended without success. `begun`: a robot may have begun it.
void RunStepper::CommandStopped(const CommandOwner& owner, OpenCommand stopped, bool begun,
                                const std::string& reason) {
  NodeState& node = run_.nodes[owner.node];
  InvocationState& invocation = node.invocations[owner.invocation];
  const cawl::Node& syntax = flow_.nodes[owner.node];
  const Stopped by = stopped.stopped != Stopped::kNo ? stopped.stopped : stopped.recalled;
  const std::string why = by == Stopped::kByPause ? "its run was paused" : "its robot takes no commands";
  const bool retries =
      invocation.retries < syntax.invokes[invocation.invoke].retry || node.attempt <= syntax.retry;
  core_.Say(absl::StrCat(Subject(owner.node, owner.invocation), " ", invocation.handler->Label(stopped.step)),
            "running", begun ? "cancelled" : "not begun", why);
  if (by == Stopped::kWithRobot && retries && !invocation.once) {
    // another robot may do it
    return InvocationFailed(owner.node, owner.invocation,
                            absl::StrCat("cancelled: ", why, reason.empty() ? "" : ": ", reason));
  }
  if (stopped.command.idempotent || !begun) {
    invocation.reason = begun ? absl::StrCat("cancelled: ", why, "; it begins again")
                              : absl::StrCat("not begun: ", why, "; it is sent again");
    invocation.lost.push_back(std::move(stopped));
    return;
  }
  BeginIncident(owner.node, absl::StrCat(stopped.command.operation, " was cancelled since ", why,
                                         ", and it is not idempotent: it does not begin again by itself"));
}

}  // namespace docent::engine
