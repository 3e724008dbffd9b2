// Nodes of a flow that may be active at the same time and are in each other's way: they command one robot, or set one variable.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "workflow/cawl/check/node_claims.h"
#include "workflow/cawl/check/node_reach.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/structure_checks.h"

namespace docent::cawl {
namespace {

constexpr size_t kMaxReported = 10;  // of each kind, in one flow

bool HasOr(const Expression& expression) {
  return expression.kind == Expression::Kind::kOr ||
         std::any_of(expression.children.begin(), expression.children.end(), HasOr);
}

class RaceChecker {
 public:
  RaceChecker(const Document& document, const Flow& flow, xml::ElementReader* reader)
      : document_(document), flow_(flow), reader_(*reader), starts_with_robot_(StartsWithRobot()) {
    for (const Node& node : flow.nodes) {
      if (Bound(node).contains(kRobot)) binds_robot_.insert(&node);
    }
  }

  void Check(Cancellation* cancellation) {
    for (const Node& node : flow_.nodes) CheckNode(node);
    if (flow_.nodes.size() <= kMaxPairedNodes) CheckPairs(cancellation);
  }

 private:
  // Whether a run has a robot from its start on.
  bool StartsWithRobot() const {
    const auto& activator = document_.activator;
    const bool activated = activator && activator->flow.value == flow_.name.value;
    if (Declares(document_.variables, kRobot) || Declares(flow_.variables, kRobot)) return true;
    if (!activated) return false;
    const std::vector<std::string> bound = BoundBy(activator->condition);
    return Declares(activator->variables, kRobot) ||
           std::find(bound.begin(), bound.end(), kRobot) != bound.end();
  }

  // What stands in the way of each other within one node: its invocations start together.
  void CheckNode(const Node& node) {
    const bool one_robot = starts_with_robot_ || binds_robot_.contains(&node);
    const Names for_each(node.for_each.begin(), node.for_each.end());
    std::set<std::pair<std::string, std::string>> seen;
    Names given;
    const Text* repeated = nullptr;
    for (const Invoke& invoke : node.invokes) {
      CheckResults(node, invoke, &given);
      Names uses;
      const std::string robot = RobotOf(invoke, &uses);
      const std::string& operation = invoke.operation.value;
      if (operation.empty() || (robot.empty() && !one_robot)) continue;
      if (robot.empty()) uses.insert(kRobot);
      if (!Meet(uses, for_each) && repeated == nullptr) repeated = &invoke.operation;
      if (seen.insert({operation, robot}).second) continue;
      Warn(invoke.operation.span,
           Concat("node ", node.name.value, " invokes ", operation, " twice at the same time, of one robot"),
           "put one of the two into a node of its own", kRobotRace);
    }
    if (for_each.empty() || node.sequential || repeated == nullptr) return;
    Warn(node.for_each_text.span,
         Concat("node ", node.name.value, " invokes ", repeated->value,
                " for each match at the same time, of one robot"),
         "add ext:sequential=\"true\", or let forEach have ?robot", kRobotRace);
  }

  void CheckResults(const Node& node, const Invoke& invoke, Names* given) {
    for (const Output& output : invoke.outputs) {
      const std::string& name = output.variable.value;
      if (name.empty() || given->insert(name).second) continue;
      Warn(output.variable.span,
           Concat("node ", node.name.value, " sets variable ", name,
                  " by two invokes at the same time: the one that is done last counts"),
           "let each set a variable of its own, or put one of the two into a node of its own", kVariableRace);
    }
  }

  // Two links out of one node that are both followed: what comes after the one may be active together with what comes
  // after the other, unless the one comes after the other.
  void CheckPairs(Cancellation* cancellation) {
    Collect();
    if (looked_at_.none()) return;
    const NodeReach forward(flow_, [](const Link& link) { return !link.while_text.given(); });
    const NodeReach together(flow_, [](const Link& link) {
      return !link.while_text.given() && !link.on_failure && !link.on_interrupt;
    });
    for (size_t i = 0; i < flow_.nodes.size(); ++i) {
      before_.push_back(forward.Before(i));
      from_.push_back(forward.After(i));
      before_[i].set(i);
      from_[i].set(i);
    }
    std::vector<NodeSet> compared(flow_.nodes.size());
    told_.resize(flow_.nodes.size());
    const auto check_fork = [&](const NodeSet& targets) {
      NodeSet others = targets;
      ForEachNode(targets, [&](size_t first) {
        others.reset(first);
        if (IsEnough() || IsOver(cancellation)) return;
        ForEachNode(others & ~compared[first], [&](size_t second) { CheckBranches(first, second); });
        compared[first] |= others;
      });
    };
    check_fork(together.first());
    for (size_t fork = 0; fork < flow_.nodes.size(); ++fork) check_fork(together.Next(fork));
  }

  bool IsEnough() const {
    const bool of_robots = robots_.empty() || robot_races_ >= kMaxReported;
    return of_robots && (settings_.empty() || variable_races_ >= kMaxReported);
  }

  void CheckBranches(size_t first, size_t second) {
    const NodeSet of_first = looked_at_ & from_[first] & ~from_[second];
    const NodeSet of_second = looked_at_ & from_[second] & ~from_[first];
    ForEachNode(of_first, [&](size_t a) {
      ForEachNode(of_second & ~from_[a] & ~before_[a] & ~told_[a], [&](size_t b) {
        told_[a].set(b);
        told_[b].set(a);
        CheckRobots(a, b);
        CheckVariables(a, b);
      });
    });
  }

  // What two nodes or more command or set, by node.
  void Collect() {
    std::map<std::string, int> robots, variables;
    for (size_t i = 0; i < flow_.nodes.size(); ++i) {
      const Node& node = flow_.nodes[i];
      for (const std::string& robot : CommandedBy(node)) {
        robots_[i].insert(robot);
        ++robots[robot];
      }
      for (auto& [name, setting] : SettingsOf(node)) {
        settings_[i].emplace(name, setting);
        ++variables[name];
      }
      binders_.set(i, binds_robot_.contains(&node));
      any_joins_.set(i, node.join && HasOr(*node.join));
    }
    for (auto& [node, of_node] : robots_)
      std::erase_if(of_node, [&](const std::string& robot) { return robots[robot] < 2; });
    for (auto& [node, of_node] : settings_)
      std::erase_if(of_node, [&](const auto& setting) { return variables[setting.first] < 2; });
    std::erase_if(robots_, [](const auto& entry) { return entry.second.empty(); });
    std::erase_if(settings_, [](const auto& entry) { return entry.second.empty(); });
    for (const auto& [node, of_node] : robots_) looked_at_.set(node);
    for (const auto& [node, of_node] : settings_) looked_at_.set(node);
  }

  // Robots that operations of the node command and that it has from elsewhere.
  Names CommandedBy(const Node& node) const {
    Names own = Bound(node);
    own.insert(node.for_each.begin(), node.for_each.end());
    for (const Action& action : node.actions) {
      for (const Text& output : action.computed.outputs) {
        if (output.value != kRobot) own.insert(output.value);
      }
    }
    Names out;
    for (const Invoke& invoke : node.invokes) {
      if (invoke.operation.empty()) continue;
      Names uses;
      const std::string robot = RobotOf(invoke, &uses);
      const bool of_run = robot.empty();
      if (of_run && binds_robot_.contains(&node)) continue;
      if (of_run && !starts_with_robot_ && binds_robot_.empty()) continue;
      if (of_run || !Meet(uses, own)) out.insert(robot);
    }
    return out;
  }

  // Some node before both binds ?robot, or the run begins with one.
  bool OneRobot(size_t a, size_t b) const {
    return starts_with_robot_ || (binders_ & before_[a] & before_[b]).any();
  }

  void CheckRobots(size_t a, size_t b) {
    const auto of_a = robots_.find(a), of_b = robots_.find(b);
    if (of_a == robots_.end() || of_b == robots_.end()) return;
    for (const std::string& robot : of_a->second) {
      if (robot_races_ >= kMaxReported || !of_b->second.contains(robot)) continue;
      if (robot.empty() && !OneRobot(a, b)) continue;
      const auto [one, other] = InOrder(a, b);
      ++robot_races_;
      return Warn(other->name.span,
                  Concat("nodes ", one->name.value, " and ", other->name.value,
                         " may be active at the same time, and both command ",
                         robot.empty() ? "the robot of the run" : Concat("the robot ", robot)),
                  robot.empty() ? "link them one after the other, or give one of them a condition that binds "
                                  "a ?robot of its own"
                                : "link them one after the other, or give one of them another robot",
                  kRobotRace);
    }
  }

  void CheckVariables(size_t a, size_t b) {
    const auto of_a = settings_.find(a), of_b = settings_.find(b);
    if (of_a == settings_.end() || of_b == settings_.end()) return;
    for (const auto& [name, setting] : of_a->second) {
      if (variable_races_ >= kMaxReported) return;
      const auto same = of_b->second.find(name);
      if (same == of_b->second.end() || Agree(setting, same->second) || OneIsEnough(a, b)) continue;
      const auto [one, other] = InOrder(a, b);
      ++variable_races_;
      Warn(other->name.span,
           Concat("nodes ", one->name.value, " and ", other->name.value,
                  " may be active at the same time, and both set variable ", name,
                  ": the one that is done last counts"),
           "link them one after the other, or let each set a variable of its own", kVariableRace);
    }
  }

  // A join behind both that goes on after the first of them: they are alternatives.
  bool OneIsEnough(size_t a, size_t b) const { return (any_joins_ & from_[a] & from_[b]).any(); }

  std::pair<const Node*, const Node*> InOrder(size_t a, size_t b) const {
    const Node *one = &flow_.nodes[a], *other = &flow_.nodes[b];
    if (one->name.span.offset > other->name.span.offset) std::swap(one, other);
    return {one, other};
  }

  void Warn(const SourceSpan& span, std::string message, const char* hint, const char* rule) {
    reader_.Warning(span, std::move(message), hint).rule = rule;
  }

  const Document& document_;
  const Flow& flow_;
  xml::ElementReader& reader_;
  const bool starts_with_robot_;
  std::set<const Node*> binds_robot_;  // nodes whose own condition does
  // Of a flow whose pairs of nodes are looked at:
  NodeSet binders_;    // binds_robot_
  NodeSet any_joins_;  // nodes that wait for one of several
  NodeSet looked_at_;  // those of robots_ and settings_
  std::map<size_t, Names> robots_;
  std::map<size_t, std::map<std::string, Setting>> settings_;
  std::vector<NodeSet> from_, before_;  // a node and what comes after it, or before it
  std::vector<NodeSet> told_;           // with which others a node was compared
  size_t robot_races_ = 0;
  size_t variable_races_ = 0;
};

}  // namespace

void CheckRaces(const Document& document, xml::ElementReader* reader, Cancellation* cancellation) {
  for (const Flow& flow : document.flows) {
    if (IsOver(cancellation)) return;
    RaceChecker(document, flow, reader).Check(cancellation);
  }
}

}  // namespace docent::cawl
