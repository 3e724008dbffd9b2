// What will go wrong in runs of a flow: two nodes that command one robot at the same time, loops that nothing slows down.
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "graph/base/text.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/link_graph.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/structure_checks.h"

namespace docent::cawl {
namespace {

constexpr char kRobot[] = "robot";
constexpr size_t kMaxReported = 10;  // of each kind, in one flow

bool Declares(const std::vector<Variable>& variables) {
  return std::any_of(variables.begin(), variables.end(),
                     [](const Variable& v) { return v.name.value == kRobot; });
}

bool BindsRobot(const Node& node) {
  if (!node.condition) return false;
  const std::vector<std::string> bound = BoundBy(*node.condition);
  return std::find(bound.begin(), bound.end(), kRobot) != bound.end();
}

class RunChecker {
 public:
  RunChecker(const Document& document, const Flow& flow, xml::ElementReader* reader)
      : document_(document), flow_(flow), reader_(*reader) {
    for (const Node& node : flow.nodes) {
      nodes_.emplace(node.name.value, &node);
      if (BindsRobot(node)) binds_robot_.insert(node.name.value);
    }
    starts_with_robot_ = StartsWithRobot();
    for (const Link& link : flow.links) {
      all_[link.from.value].insert(link.to.value);
      if (link.while_text.given()) continue;
      forward_[link.from.value].insert(link.to.value);
      if (!link.on_failure && !link.on_interrupt) together_[link.from.value].insert(link.to.value);
    }
  }

  void Check() {
    CheckNodes();
    if (flow_.nodes.size() <= kMaxPairedNodes) CheckRaces();
    CheckLoops();
  }

 private:
  // Whether a run has a robot from its start on.
  bool StartsWithRobot() const {
    const auto& activator = document_.activator;
    const bool activated = activator && activator->flow.value == flow_.name.value;
    if (Declares(document_.variables) || Declares(flow_.variables)) return true;
    if (!activated) return false;
    const std::vector<std::string> bound = BoundBy(activator->condition);
    return Declares(activator->variables) || std::find(bound.begin(), bound.end(), kRobot) != bound.end();
  }

  // Invocations of one node that start together.
  void CheckNodes() {
    for (const Node& node : flow_.nodes) {
      const bool one_robot = starts_with_robot_ || binds_robot_.contains(node.name.value);
      if (!one_robot) continue;
      std::set<std::string> seen;
      for (const Invoke& invoke : node.invokes) {
        const std::string& operation = invoke.operation.value;
        if (operation.empty() || seen.insert(operation).second) continue;
        Diagnostic& report = reader_.Warning(
            invoke.operation.span,
            Concat("node ", node.name.value, " invokes ", operation, " twice at the same time, of one robot"),
            "put one of the two into a node of its own");
        report.rule = kRobotRace;
      }
      const bool each_its_own =
          std::find(node.for_each.begin(), node.for_each.end(), kRobot) != node.for_each.end();
      if (!node.for_each.empty() && !node.sequential && !each_its_own && !seen.empty()) {
        reader_
            .Warning(node.for_each_text.span,
                     Concat("node ", node.name.value, " invokes ", *seen.begin(),
                            " for each match at the same time, of one robot"),
                     "add ext:sequential=\"true\", or let forEach have ?robot")
            .rule = kRobotRace;
      }
    }
  }

  // Operations of a robot that the node has from elsewhere.
  bool CommandsTheRobot(const std::string& name) const {
    const auto it = nodes_.find(name);
    if (it == nodes_.end() || binds_robot_.contains(name)) return false;
    return std::any_of(it->second->invokes.begin(), it->second->invokes.end(),
                       [](const Invoke& invoke) { return !invoke.operation.empty(); });
  }

  // Some node before both binds ?robot, or the run begins with one.
  bool OneRobot(const std::string& a, const std::string& b) const {
    if (starts_with_robot_) return true;
    return std::any_of(binds_robot_.begin(), binds_robot_.end(), [&](const std::string& name) {
      const std::set<std::string>& after = After(name);
      return after.contains(a) && after.contains(b);
    });
  }

  const std::set<std::string>& After(const std::string& name) const {
    const auto [it, is_new] = after_.try_emplace(name);
    if (is_new) it->second = Reachable(forward_, name);
    return it->second;
  }

  // Two links out of one node that are both followed: what comes after the one may be active together with what comes
  // after the other, unless the one comes after the other.
  void CheckRaces() {
    if (!starts_with_robot_ && binds_robot_.empty()) return;
    for (const auto& [fork, targets] : together_) {
      for (auto first = targets.begin(); first != targets.end(); ++first) {
        for (auto second = std::next(first); second != targets.end(); ++second)
          CheckBranches(*first, *second);
      }
    }
  }

  void CheckBranches(const std::string& first, const std::string& second) {
    for (const std::string& a : After(first)) {
      if (!CommandsTheRobot(a) || After(second).contains(a)) continue;
      for (const std::string& b : After(second)) {
        if (races_.size() >= kMaxReported) return;
        if (a == b || !CommandsTheRobot(b) || After(first).contains(b)) continue;
        if (After(a).contains(b) || After(b).contains(a) || !OneRobot(a, b)) continue;
        ReportRace(a, b);
      }
    }
  }

  void ReportRace(const std::string& a, const std::string& b) {
    const Node *one = nodes_.at(a), *other = nodes_.at(b);
    if (one->name.span.offset > other->name.span.offset) std::swap(one, other);
    if (!races_.insert({one, other}).second) return;
    reader_
        .Warning(
            other->name.span,
            Concat("nodes ", one->name.value, " and ", other->name.value,
                   " may be active at the same time, and both command the robot of the run"),
            "link them one after the other, or give one of them a condition that binds a ?robot of its own")
        .rule = kRobotRace;
  }

  static bool TakesTime(const Node& node) {
    if (!node.invokes.empty()) return true;
    for (const Action& action : node.actions) {
      if (action.waits) return true;
    }
    return node.condition && !(node.condition->contexts.empty() && node.condition->cases.empty());
  }

  void CheckLoops() {
    LinkGraph at_once;
    const auto is_instant = [&](const std::string& name) {
      const auto it = nodes_.find(name);
      return it != nodes_.end() && !TakesTime(*it->second);
    };
    for (const auto& [from, targets] : all_) {
      if (!is_instant(from)) continue;
      for (const std::string& to : targets) {
        if (is_instant(to)) at_once[from].insert(to);
      }
    }
    std::set<std::set<std::string>> reported;
    for (const Link& link : flow_.links) {
      if (!link.while_text.given() || reported.size() >= kMaxReported) continue;
      const auto it = at_once.find(link.from.value);
      if (it == at_once.end() || !it->second.contains(link.to.value)) continue;
      const std::vector<std::string> way = CycleThrough(at_once, link.from.value);
      if (way.empty() || std::find(way.begin(), way.end(), link.to.value) == way.end()) continue;
      if (!reported.insert(std::set<std::string>(way.begin(), way.end())).second) continue;
      reader_
          .Warning(
              link.while_text.span,
              Concat("nothing slows this loop down: ", Arrows(way), " has no condition and no invoke"),
              "while its condition holds, it goes round until the limit node_iterations; give a node in it a "
              "condition that waits for what is to come")
          .rule = kLoopWithoutWait;
    }
  }

  const Document& document_;
  const Flow& flow_;
  xml::ElementReader& reader_;
  std::map<std::string, const Node*> nodes_;
  std::set<std::string> binds_robot_;  // nodes whose own condition does
  bool starts_with_robot_ = false;
  LinkGraph all_;       // every link
  LinkGraph forward_;   // without `while`
  LinkGraph together_;  // without `while` and `onFailure`: all of a node's are followed
  mutable std::map<std::string, std::set<std::string>> after_;
  std::set<std::pair<const Node*, const Node*>> races_;
};

}  // namespace

namespace {

// Constraints that the rule has without `not`, or under it.
std::vector<const Constraint*> ConstraintsOf(const Rule& rule, bool negated) {
  std::vector<const Constraint*> all;
  const auto visit = [&](const auto& self, const Expression& e, bool under_not) -> void {
    for (const Expression& child : e.children)
      self(self, child, under_not != (e.kind == Expression::Kind::kNot));
    if (e.kind != Expression::Kind::kName || under_not != negated) return;
    for (const Constraint& constraint : rule.constraints) {
      if (constraint.name.value == e.name) all.push_back(&constraint);
    }
  };
  if (rule.expression) {
    visit(visit, *rule.expression, false);
  } else if (!negated) {
    for (const Constraint& constraint : rule.constraints) all.push_back(&constraint);
  }
  return all;
}

bool MayBeTheSame(const Word& a, const Word& b) {
  const bool terms = a.kind == Word::Kind::kTerm && b.kind == Word::Kind::kTerm;
  return a.comparison == Word::Comparison::kNone && b.comparison == Word::Comparison::kNone &&
         (!terms || a.term == b.term);
}

// Whether the fact, told or withdrawn, makes the condition fall that opened its node.
bool Closes(const Condition& condition, const Constraint& fact, bool tells) {
  for (const Context& context : condition.contexts) {
    for (const Rule& rule : context.rules) {
      for (const Constraint* constraint : ConstraintsOf(rule, tells)) {
        if (constraint->verb.kind == Word::Kind::kTerm && MayBeTheSame(constraint->verb, fact.verb) &&
            MayBeTheSame(constraint->subject, fact.subject) && MayBeTheSame(constraint->object, fact.object))
          return true;
      }
    }
  }
  return false;
}

void CheckOpening(const Node& node, xml::ElementReader* reader) {
  const bool commands = std::any_of(node.invokes.begin(), node.invokes.end(),
                                    [](const Invoke& invoke) { return !invoke.operation.value.empty(); });
  for (const Action& action : node.actions) {
    if (action.when_done) continue;
    for (const Constraint& fact : action.facts) {
      const bool releases = action.kind == Action::Kind::kRelease;
      if (releases && commands && fact.subject.name == "robot") {
        reader
            ->Warning(fact.subject.span,
                      "the robot is given back before the node uses it, and is then taken again",
                      "write at=\"done\"")
            .rule = kReleaseBeforeUse;
      }
      const bool writes = action.kind == Action::Kind::kTell || action.kind == Action::Kind::kWithdraw;
      if (!writes || !node.holds_condition || !node.condition) continue;
      if (!Closes(*node.condition, fact, action.kind == Action::Kind::kTell)) continue;
      reader
          ->Warning(
              node.hold_text.span,
              Concat("while-holds has no effect: node ", node.name.value,
                     " makes its condition fall itself when it opens, and that is then not asked again"),
              "leave out of the condition what the node itself tells (object != $name), or write what has to "
              "hold")
          .rule = kWhileHoldsWithoutEffect;
      return;
    }
  }
}

}  // namespace

void CheckRuns(const Document& document, xml::ElementReader* reader) {
  for (const Flow& flow : document.flows) {
    RunChecker(document, flow, reader).Check();
    for (const Node& node : flow.nodes) CheckOpening(node, reader);
  }
}

}  // namespace docent::cawl
