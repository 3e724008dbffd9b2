// Nodes of a flow that may be active at the same time and are in each other's way: they command one robot, or set one variable.
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "workflow/cawl/check/node_claims.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/link_graph.h"
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
      : document_(document), flow_(flow), reader_(*reader) {
    for (const Node& node : flow.nodes) {
      nodes_.emplace(node.name.value, &node);
      if (Bound(node).contains(kRobot)) binds_robot_.insert(node.name.value);
    }
    starts_with_robot_ = StartsWithRobot();
    for (const Link& link : flow.links) {
      if (link.while_text.given()) continue;
      forward_[link.from.value].insert(link.to.value);
      if (!link.on_failure && !link.on_interrupt) together_[link.from.value].insert(link.to.value);
    }
  }

  void Check() {
    for (const Node& node : flow_.nodes) CheckNode(node);
    if (flow_.nodes.size() > kMaxPairedNodes) return;
    Collect();
    if (robots_.empty() && settings_.empty()) return;
    for (const auto& [fork, targets] : together_) {
      for (auto first = targets.begin(); first != targets.end(); ++first) {
        for (auto second = std::next(first); second != targets.end(); ++second)
          CheckBranches(*first, *second);
      }
    }
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
    const bool one_robot = starts_with_robot_ || binds_robot_.contains(node.name.value);
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

  // What two nodes or more command or set, by node.
  void Collect() {
    std::map<std::string, int> robots, variables;
    for (const Node& node : flow_.nodes) {
      for (const std::string& robot : CommandedBy(node)) {
        robots_[node.name.value].insert(robot);
        ++robots[robot];
      }
      for (auto& [name, setting] : SettingsOf(node)) {
        settings_[node.name.value].emplace(name, setting);
        ++variables[name];
      }
    }
    for (auto& [node, of_node] : robots_)
      std::erase_if(of_node, [&](const std::string& robot) { return robots[robot] < 2; });
    for (auto& [node, of_node] : settings_)
      std::erase_if(of_node, [&](const auto& setting) { return variables[setting.first] < 2; });
    std::erase_if(robots_, [](const auto& entry) { return entry.second.empty(); });
    std::erase_if(settings_, [](const auto& entry) { return entry.second.empty(); });
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
      if (of_run && binds_robot_.contains(node.name.value)) continue;
      if (of_run && !starts_with_robot_ && binds_robot_.empty()) continue;
      if (of_run || !Meet(uses, own)) out.insert(robot);
    }
    return out;
  }

  // Some node before both binds ?robot, or the run begins with one.
  bool OneRobot(const std::string& a, const std::string& b) const {
    if (starts_with_robot_) return true;
    return std::any_of(binds_robot_.begin(), binds_robot_.end(), [&](const std::string& name) {
      const Names& after = After(name);
      return after.contains(a) && after.contains(b);
    });
  }

  const Names& After(const std::string& name) const {
    const auto [it, is_new] = after_.try_emplace(name);
    if (is_new) it->second = Reachable(forward_, name);
    return it->second;
  }

  bool IsLookedAt(const std::string& name) const {
    return robots_.contains(name) || settings_.contains(name);
  }

  // Two links out of one node that are both followed: what comes after the one may be active together with what comes
  // after the other, unless the one comes after the other.
  void CheckBranches(const std::string& first, const std::string& second) {
    const bool enough_of_robots = robots_.empty() || robot_races_.size() >= kMaxReported;
    const bool enough_of_variables = settings_.empty() || variable_races_.size() >= kMaxReported;
    if (enough_of_robots && enough_of_variables) return;
    for (const std::string& a : After(first)) {
      if (!IsLookedAt(a) || After(second).contains(a)) continue;
      for (const std::string& b : After(second)) {
        if (a == b || !IsLookedAt(b) || After(first).contains(b)) continue;
        if (After(a).contains(b) || After(b).contains(a)) continue;
        CheckRobots(a, b);
        CheckVariables(a, b);
      }
    }
  }

  void CheckRobots(const std::string& a, const std::string& b) {
    const auto of_a = robots_.find(a), of_b = robots_.find(b);
    if (of_a == robots_.end() || of_b == robots_.end()) return;
    for (const std::string& robot : of_a->second) {
      if (robot_races_.size() >= kMaxReported || !of_b->second.contains(robot)) continue;
      if (robot.empty() && !OneRobot(a, b)) continue;
      const auto [one, other] = InOrder(a, b);
      if (!robot_races_.insert({one, other}).second) return;
      Warn(other->name.span,
           Concat("nodes ", one->name.value, " and ", other->name.value,
                  " may be active at the same time, and both command ",
                  robot.empty() ? "the robot of the run" : Concat("the robot ", robot)),
           robot.empty() ? "link them one after the other, or give one of them a condition that binds a "
                           "?robot of its own"
                         : "link them one after the other, or give one of them another robot",
           kRobotRace);
    }
  }

  void CheckVariables(const std::string& a, const std::string& b) {
    const auto of_a = settings_.find(a), of_b = settings_.find(b);
    if (of_a == settings_.end() || of_b == settings_.end()) return;
    for (const auto& [name, setting] : of_a->second) {
      if (variable_races_.size() >= kMaxReported) return;
      const auto same = of_b->second.find(name);
      if (same == of_b->second.end() || Agree(setting, same->second) || OneIsEnough(a, b)) continue;
      const auto [one, other] = InOrder(a, b);
      if (!variable_races_.insert({{one, other}, name}).second) continue;
      Warn(other->name.span,
           Concat("nodes ", one->name.value, " and ", other->name.value,
                  " may be active at the same time, and both set variable ", name,
                  ": the one that is done last counts"),
           "link them one after the other, or let each set a variable of its own", kVariableRace);
    }
  }

  // A join behind both that goes on after the first of them: they are alternatives.
  bool OneIsEnough(const std::string& a, const std::string& b) const {
    return std::any_of(flow_.nodes.begin(), flow_.nodes.end(), [&](const Node& node) {
      return node.join && HasOr(*node.join) && After(a).contains(node.name.value) &&
             After(b).contains(node.name.value);
    });
  }

  std::pair<const Node*, const Node*> InOrder(const std::string& a, const std::string& b) const {
    const Node *one = nodes_.at(a), *other = nodes_.at(b);
    if (one->name.span.offset > other->name.span.offset) std::swap(one, other);
    return {one, other};
  }

  void Warn(const SourceSpan& span, std::string message, const char* hint, const char* rule) {
    reader_.Warning(span, std::move(message), hint).rule = rule;
  }

  const Document& document_;
  const Flow& flow_;
  xml::ElementReader& reader_;
  std::map<std::string, const Node*> nodes_;
  Names binds_robot_;  // nodes whose own condition does
  bool starts_with_robot_ = false;
  LinkGraph forward_;   // without `while`
  LinkGraph together_;  // without `while` and `onFailure`: all of a node's are followed
  std::map<std::string, Names> robots_;
  std::map<std::string, std::map<std::string, Setting>> settings_;
  mutable std::map<std::string, Names> after_;
  std::set<std::pair<const Node*, const Node*>> robot_races_;
  std::set<std::pair<std::pair<const Node*, const Node*>, std::string>> variable_races_;
};

}  // namespace

void CheckRaces(const Document& document, xml::ElementReader* reader) {
  for (const Flow& flow : document.flows) RaceChecker(document, flow, reader).Check();
}

}  // namespace docent::cawl
