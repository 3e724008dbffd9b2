// The links of a flow as a run follows them: joins that open, branches that are dead, loops that begin again.
#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

bool HasNot(const cawl::Expression& expression) {
  return expression.kind == cawl::Expression::Kind::kNot ||
         std::any_of(expression.children.begin(), expression.children.end(), HasNot);
}

// Links that are followed in about the time of a change of a node.
constexpr size_t kLinksOfAChange = 16;

}  // namespace

void RunStepper::Arrive(const std::string& from, const std::string& to, bool closes_cycle) {
  if (to == flow_.sink.value) {
    run_.sink_reached = true;
    return;
  }
  size_t index = graph_.NodeIndex(to);
  if (index == flow_.nodes.size()) return;
  if (closes_cycle) return Reenter(index);
  run_.nodes[index].arrived.insert(from);
  Resolve(index);
}

// Nothing comes along this link, nor along those behind it that depend on it.
void RunStepper::DeadEnd(size_t link) {
  std::vector<size_t> todo = {link};
  while (!todo.empty() && GoesOn()) {
    const cawl::Link& dead = flow_.links[todo.back()];
    const size_t index = graph_.Target(todo.back());
    todo.pop_back();
    if (index == flow_.nodes.size()) continue;
    run_.nodes[index].dead.insert(dead.from.value);
    if (!Resolve(index)) continue;
    const std::vector<size_t>& links = graph_.LinksFrom(index);
    std::copy_if(links.rbegin(), links.rend(), std::back_inserter(todo),
                 [this](size_t behind) { return !graph_.ClosesCycle(behind); });
  }
}

// Does the join of an inactive node open, stay shut, or can it not open any more?
// True if it never opens, and is skipped.
bool RunStepper::Resolve(size_t index) {
  NodeState& node = run_.nodes[index];
  if (!GoesOn() || node.state != WorkState::kInactive)
    return false;  // a node before it may have ended the run
  const std::set<std::string>& predecessors = graph_.Predecessors(index);
  const bool may_be_known = node.arrived.size() + node.dead.size() >= predecessors.size();
  bool all_known =
      may_be_known && std::all_of(predecessors.begin(), predecessors.end(), [&](const std::string& name) {
        return node.arrived.count(name) > 0 || node.dead.count(name) > 0;
      });
  const std::optional<cawl::Expression>& join = flow_.nodes[index].join;
  if (join) core_.bounds.Worked(flow_.nodes[index].join_text.value.size() / kTextOfAChange);
  bool open =
      join ? cawl::Evaluate(*join, [&](const std::string& name) { return node.arrived.count(name) > 0; })
           : all_known && !node.arrived.empty();
  if (open && (all_known || !join || !HasNot(*join))) {
    Activate(index);
    return false;
  }
  if (!all_known) return false;
  SetNode(index, WorkState::kSkipped,
          join ? "its joinCondition cannot become true" : "nothing leads to it any more");
  return true;
}

// A loop goes back to this node: it and what comes after it begin anew.
void RunStepper::Reenter(size_t index) {
  int iteration = run_.nodes[index].iteration + 1;
  if (iteration >= core_.limits.node_iterations) {
    return End(WorkState::kFailed, absl::StrCat("node ", flow_.nodes[index].name.value, " was entered ",
                                                iteration, " times; the limit is node_iterations"));
  }
  std::set<size_t> again = graph_.Reachable(index);
  core_.bounds.Worked(again.size());
  for (size_t i : again) {
    if (IsLive(run_.nodes[i].state)) CancelNode(i, "the loop begins again");
    NodeState& node = run_.nodes[i];
    std::string from(ToString(node.state));
    NodeState fresh;
    fresh.iteration =
        node.iteration + 1;  // its own count: a loop around this one must not give its ids again
    // what is known of predecessors outside of the loop stays
    auto outside = [&](const std::string& name) { return again.count(graph_.NodeIndex(name)) == 0; };
    std::copy_if(node.arrived.begin(), node.arrived.end(), std::inserter(fresh.arrived, fresh.arrived.end()),
                 outside);
    std::copy_if(node.dead.begin(), node.dead.end(), std::inserter(fresh.dead, fresh.dead.end()), outside);
    node = std::move(fresh);
    core_.Say(Subject(i), from, "inactive", "the loop begins again");
  }
  run_.sink_reached = false;
  Activate(index);
}

void RunStepper::NodeDone(size_t index) {
  NodeState& node = run_.nodes[index];
  std::vector<size_t> plain;
  for (size_t i : graph_.LinksFrom(index)) {
    const cawl::Link& link = flow_.links[i];
    if (link.on_failure || link.on_interrupt) continue;
    if (!link.while_constraint) {
      plain.push_back(i);
      continue;
    }
    auto ask = cawl::CompileConstraint(
        *run_.document, *link.while_constraint,
        [this](const std::string& name) { return Value(name, nullptr); }, core_.limits);
    absl::Status status = ask.status();
    if (status.ok()) status = cawl::ParseAsks(core_.limits, &*ask);
    if (!status.ok()) return NodeFailed(index, std::string(status.message()));
    node.pending_links.push_back({i, core_.Arm(*ask, {}, {run_.id, index, ""})});
  }
  if (!node.pending_links.empty()) {
    core_.awaiting.insert(run_.id);  // their levels come with the next round
    return;
  }
  SetNode(index, WorkState::kDone,
          node.invocations.empty() ? "nothing to do" : "all its invocations are done");
  NoteDone(index);
  FollowLinks(index, plain);
}

// The conditions of `while` links have a level by now: take those that hold, else the plain links.
bool RunStepper::ResolvePendingLinks(size_t index) {
  NodeState& node = run_.nodes[index];
  if (node.pending_links.empty()) return false;
  std::vector<size_t> taken;
  for (const PendingLink& pending : node.pending_links) {
    if (core_.owners.contains(pending.handle) && core_.input->conditions->Holds(pending.handle)) {
      taken.push_back(pending.link);
    }
  }
  for (const PendingLink& pending : node.pending_links) core_.Disarm(pending.handle);
  node.pending_links.clear();
  if (taken.empty()) {
    for (size_t i : graph_.LinksFrom(index)) {
      const cawl::Link& link = flow_.links[i];
      if (!link.on_failure && !link.on_interrupt && !link.while_constraint) taken.push_back(i);
    }
  }
  SetNode(index, WorkState::kDone, "all its invocations are done");
  NoteDone(index);
  FollowLinks(index, taken);
  return true;
}

void RunStepper::FollowLinks(size_t index, const std::vector<size_t>& taken) {
  const std::string& from = flow_.nodes[index].name.value;
  // Where the loop begins again, this node will choose once more: nothing is dead yet.
  bool loops = std::any_of(taken.begin(), taken.end(), [&](size_t i) { return graph_.ClosesCycle(i); });
  const std::set<size_t> followed(taken.begin(), taken.end());
  core_.bounds.Worked(graph_.LinksFrom(index).size() / kLinksOfAChange);
  std::vector<size_t> links = graph_.LinksFrom(index);
  // A way back first: it resets what comes after it, also where another of these links leads.
  std::stable_partition(links.begin(), links.end(), [&](size_t i) { return graph_.ClosesCycle(i); });
  for (size_t i : links) {
    const cawl::Link& link = flow_.links[i];
    bool follow = followed.contains(i);
    bool closes = graph_.ClosesCycle(i);
    if (follow)
      Arrive(from, link.to.value, closes);
    else if (!closes && !loops)
      DeadEnd(i);
    if (!GoesOn()) return;
  }
}

}  // namespace docent::engine
