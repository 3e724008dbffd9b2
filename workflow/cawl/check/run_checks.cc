// What will go wrong in runs of a flow: loops that nothing slows down, joins that never open, what a node undoes itself.
#include <algorithm>
#include <bitset>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/link_graph.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

constexpr size_t kMaxReported = 10;  // of each kind, in one flow

class RunChecker {
 public:
  RunChecker(const Flow& flow, xml::ElementReader* reader) : flow_(flow), reader_(*reader) {
    for (const Node& node : flow.nodes) nodes_.emplace(node.name.value, &node);
    for (const Link& link : flow.links) {
      all_[link.from.value].insert(link.to.value);
      into_[link.to.value].push_back(&link);
    }
  }

  void Check() {
    CheckLoops();
    for (const Node& node : flow_.nodes) CheckJoin(node);
  }

 private:
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
    const LinkGraph loops = LinksOnCycles(at_once);
    std::set<std::set<std::string>> reported;
    std::set<std::pair<std::string, std::string>> told;  // links
    size_t looked_at = 0;
    for (const Link& link : flow_.links) {
      if (looked_at >= kMaxReported) return;
      const std::string &from = link.from.value, &to = link.to.value;
      const auto it = loops.find(from);
      if (!link.while_text.given() || it == loops.end() || !it->second.contains(to)) continue;
      if (told.contains({from, to})) continue;
      ++looked_at;
      std::vector<std::string> way = from == to ? std::vector{to} : ShortestWay(loops, to, from);
      way.insert(way.begin(), from);
      for (size_t i = 1; i < way.size(); ++i) told.emplace(way[i - 1], way[i]);
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

  // How a link is followed: when its node is done, and its `while` holds or has none; or when it fails, or is interrupted.
  struct Follows {
    const Text* from;
    bool done_while, done_plain, failed, interrupted;
  };

  // The only link to a node, where it has one.
  std::optional<Follows> OnlyWayTo(const std::string& name) const {
    const auto links = into_.find(name);
    if (links == into_.end() || links->second.size() != 1) return std::nullopt;
    const Link& link = *links->second[0];
    const bool exceptional = link.on_failure || link.on_interrupt, repeats = link.while_text.given();
    return Follows{&link.from, !exceptional && repeats, !exceptional && !repeats, link.on_failure,
                   link.on_interrupt};
  }

  // Links out of one node of which either the one or the other is followed lead to them, and nothing else.
  bool Exclude(const std::string& a, const std::string& b) const {
    const std::optional<Follows> one = OnlyWayTo(a), other = OnlyWayTo(b);
    return one && other && one->from->value == other->from->value &&
           !(one->done_while && other->done_while) && !(one->done_plain && other->done_plain) &&
           !(one->failed && other->failed) && !(one->interrupted && other->interrupted);
  }

  static constexpr size_t kMaxNames = 10;  // of predecessors in one joinCondition that is looked at
  // For each set of predecessors that may have come, as a number: bit i says that the name i came.
  using Sets = std::bitset<size_t{1} << kMaxNames>;

  // The sets in which the name `i` came.
  static const Sets& SetsWith(size_t i) {
    static const std::vector<Sets> kAll = [] {
      std::vector<Sets> all(kMaxNames);
      for (size_t set = 0; set < Sets().size(); ++set) {
        for (size_t name = 0; name < kMaxNames; ++name) all[name][set] = (set >> name & 1) != 0;
      }
      return all;
    }();
    return kAll[i];
  }

  // The sets for which the expression is true: all of them at once. `names` is sorted.
  static Sets TrueIn(const Expression& e, const std::vector<std::string>& names) {
    using Kind = Expression::Kind;
    if (e.kind == Kind::kName)
      return SetsWith(
          static_cast<size_t>(std::lower_bound(names.begin(), names.end(), e.name) - names.begin()));
    Sets sets = TrueIn(e.children[0], names);
    if (e.kind == Kind::kNot) return ~sets;
    for (size_t i = 1; i < e.children.size(); ++i) {
      const Sets other = TrueIn(e.children[i], names);
      sets = e.kind == Kind::kAnd ? sets & other : sets | other;
    }
    return sets;
  }

  // The expression is tried with every set of predecessors that may have come.
  void CheckJoin(const Node& node) {
    if (!node.join) return;
    std::set<std::string> distinct;
    for (const Expression* e : NamesIn(*node.join)) distinct.insert(e->name);
    if (distinct.size() > kMaxNames) return;
    const std::vector<std::string> names(distinct.begin(), distinct.end());
    const Sets opens = TrueIn(*node.join, names);
    Sets possible = opens;
    std::optional<std::pair<size_t, size_t>>
        excluded;  // by which the smallest set is not possible that opens it
    for (size_t i = 0; i < names.size(); ++i) {
      for (size_t j = i + 1; j < names.size(); ++j) {
        if (!Exclude(names[i], names[j])) continue;
        const Sets both = SetsWith(i) & SetsWith(j);
        possible &= ~both;
        if (!excluded && opens.any() && both[opens._Find_first()]) excluded = {i, j};
      }
    }
    if (possible.any()) return;
    const std::string why = !excluded ? "joinCondition is never true"
                                      : Concat("joinCondition needs ", names[excluded->first], " and ",
                                               names[excluded->second], ", and only one of them comes");
    reader_
        .Warning(node.join_text.span, Concat("node ", node.name.value, " never opens: ", why),
                 !excluded ? "correct the expression" : "write or, or leave the <wait> out")
        .rule = kUnsatisfiable;
  }

  const Flow& flow_;
  xml::ElementReader& reader_;
  std::map<std::string, const Node*> nodes_;
  LinkGraph all_;  // every link
  std::map<std::string, std::vector<const Link*>> into_;
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
    if (action.when != Action::When::kOpen) continue;
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

void CheckRuns(const Document& document, xml::ElementReader* reader, Cancellation* cancellation) {
  for (const Flow& flow : document.flows) {
    if (IsOver(cancellation)) return;
    RunChecker(flow, reader).Check();
    for (const Node& node : flow.nodes) CheckOpening(node, reader);
  }
}

}  // namespace docent::cawl
