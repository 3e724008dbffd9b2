#include "reasoner/explain/count_form.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "reasoner/explain/condition_form.h"
#include "reasoner/matching/comparison_form.h"

namespace docent::explain {
namespace {

using sparql::Algebra;
using sparql::AlgebraPtr;
using sparql::Expression;
using sparql::ExpressionPtr;
using sparql::PatternTerm;
using sparql::Variable;
using Names = std::set<std::string>;

// A range of counts: at least `least`, and fewer than `below`.
struct Bounds {
  int least = 0;
  std::optional<int> below;
};

// ?name compared with a whole number, in either order, as bounds.
struct CountTest {
  std::string name;
  Bounds bounds;
};

std::optional<CountTest> CountTestOf(const Expression& e) {
  const std::optional<matching::NumberComparison> comparison = matching::ReadNumberComparison(e);
  if (!comparison) return std::nullopt;
  const double number = matching::ViewNumber(*InlineLiteral(*comparison->number)).value;
  if (std::abs(number) > kMostCounted) return std::nullopt;
  const int up = static_cast<int>(std::ceil(number)), down = static_cast<int>(std::floor(number));
  CountTest test{comparison->variable->name, {}};
  if (!comparison->op) {
    if (up != down) return std::nullopt;
    test.bounds = {up, up + 1};
  } else if (*comparison->op == matching::Comparison::kGreaterOrEqual) {
    test.bounds.least = up;
  } else if (*comparison->op == matching::Comparison::kGreater) {
    test.bounds.least = down + 1;
  } else {
    test.bounds.below = *comparison->op == matching::Comparison::kLess ? up : down + 1;
  }
  if (test.bounds.least > kMostCounted || test.bounds.below.value_or(1) > kMostCounted) return std::nullopt;
  return test;
}

void Rename(Algebra& node, const std::map<std::string, std::string>& to) {
  const auto rename = [&to](std::string& name) {
    if (const auto found = to.find(name); found != to.end()) name = found->second;
  };
  const auto term = [&rename](PatternTerm& t) {
    if (!t.IsVariable()) return;
    Variable variable = t.variable();
    rename(variable.name);
    t.Set(variable);
  };
  for (sparql::TriplePattern& triple : node.triples) {
    term(triple.subject);
    term(triple.predicate);
    term(triple.object);
  }
  ForEachExpression(node, [&](Expression& e) {
    if (e.kind == Expression::Kind::kVariable) rename(e.variable.name);
  });
  for (const AlgebraPtr& child : node.children) Rename(*child, to);
}

Names ShownBy(const Algebra& node) {
  Names names;
  for (const Variable& v : sparql::InScopeVariables(node)) names.insert(v.name);
  return names;
}

// True for a conjunction of triple patterns and filters, each of whose solutions comes once.
bool IsPlain(const Algebra& node) {
  if (node.kind != Algebra::Kind::kBgp && node.kind != Algebra::Kind::kJoin &&
      node.kind != Algebra::Kind::kFilter)
    return false;
  bool exists = false;
  ForEachExpression(node, [&](const Expression& e) { exists = exists || e.pattern != nullptr; });
  return !exists && std::all_of(node.children.begin(), node.children.end(),
                                [](const AlgebraPtr& c) { return IsPlain(*c); });
}

AlgebraPtr Over(Algebra::Kind kind, AlgebraPtr child) {
  auto node = std::make_unique<Algebra>(kind);
  node->children.push_back(std::move(child));
  return node;
}

ExpressionPtr VariableNamed(const std::string& name) {
  auto e = std::make_unique<Expression>(Expression::Kind::kVariable, SourceSpan{});
  e->variable.name = name;
  return e;
}

// The counted pattern with its group keys.
class Counted {
 public:
  // nullopt: counts of `group` cannot be rewritten.
  static std::optional<Counted> Of(const Algebra& group, const sparql::Aggregate& aggregate,
                                   const Names& shown) {
    Counted counted(*group.children[0]);
    if (aggregate.function != sparql::Aggregate::Function::kCount || !IsPlain(counted.pattern_))
      return std::nullopt;
    for (const sparql::GroupKey& key : group.group_keys) {
      const bool same = key.expression->kind == Expression::Kind::kVariable &&
                        key.expression->variable.name == key.variable.name;
      if (!same) return std::nullopt;
      counted.keys_.push_back(key.variable);
      if (shown.contains(key.variable.name)) counted.shown_.push_back(key.variable);
    }
    MentionedBeside(counted.pattern_, nullptr, counted.named_);
    counted.others_ = counted.named_;
    for (const Variable& key : counted.keys_) counted.others_.erase(key.name);
    // variables that only a filter mentions are not counted
    const Names bound = ShownBy(counted.pattern_);
    if (!std::includes(bound.begin(), bound.end(), counted.others_.begin(), counted.others_.end()))
      return std::nullopt;
    const bool star = aggregate.expression == nullptr;
    if (!star && aggregate.expression->kind != Expression::Kind::kVariable) return std::nullopt;
    if (counted.others_.empty() || (star && counted.others_.size() != 1)) return std::nullopt;
    counted.what_ = star ? *counted.others_.begin() : aggregate.expression->variable.name;
    if (!counted.others_.contains(counted.what_)) return std::nullopt;
    if (!aggregate.distinct && counted.others_.size() != 1) return std::nullopt;
    return counted;
  }

  // { SELECT the keys shown { … } } with a solution for each group within the bounds.
  AlgebraPtr Within(const Bounds& bounds) {
    // an existing group has at least one; without keys there is always one group
    const int least = std::max(bounds.least, keys_.empty() ? 0 : 1);
    AlgebraPtr body = least == 0 ? std::make_unique<Algebra>(Algebra::Kind::kBgp) : AtLeast(least, kCopyMark);
    if (bounds.below) {
      body = Over(Algebra::Kind::kFilter, std::move(body));
      body->expression = std::make_unique<Expression>(Expression::Kind::kNotExists, SourceSpan{});
      body->expression->pattern = AtLeast(*bounds.below, '_');  // shown to people unchanged
    }
    AlgebraPtr select = Over(Algebra::Kind::kProject, std::move(body));
    select->variables = shown_;
    return select;
  }

 private:
  explicit Counted(const Algebra& pattern) : pattern_(pattern) {}

  // Copies of the pattern for different things. `mark` separates the names of their variables from the copy's
  // number.
  AlgebraPtr AtLeast(int least, char mark) {
    std::vector<AlgebraPtr> copies;
    std::vector<std::string> things;
    for (int i = 0; i < least; ++i) {
      std::map<std::string, std::string> names;
      ++copies_;
      for (const std::string& name : others_) {
        std::string& own = names[name] =
            copies_ == 1 ? name : absl::StrCat(name, std::string(1, mark), copies_);
        while (copies_ > 1 && named_.contains(own)) own += '_';
      }
      copies.push_back(pattern_.Clone());
      Rename(*copies.back(), names);
      things.push_back(names[what_]);
    }
    AlgebraPtr all = std::move(copies[0]);
    if (least > 1) {
      all = Over(Algebra::Kind::kJoin, std::move(all));
      for (int i = 1; i < least; ++i) all->children.push_back(std::move(copies[static_cast<size_t>(i)]));
    }
    for (size_t i = 0; i < things.size(); ++i) {
      for (size_t j = i + 1; j < things.size(); ++j) {
        all = Over(Algebra::Kind::kFilter, std::move(all));
        auto same = std::make_unique<Expression>(Expression::Kind::kBuiltin,
                                                 SourceSpan{});  // compares terms, not values
        same->builtin = sparql::Builtin::kSameTerm;
        same->arguments.push_back(VariableNamed(things[i]));
        same->arguments.push_back(VariableNamed(things[j]));
        all->expression = std::make_unique<Expression>(Expression::Kind::kNot, SourceSpan{});
        all->expression->arguments.push_back(std::move(same));
      }
    }
    return all;
  }

  const Algebra& pattern_;
  std::vector<Variable> keys_, shown_;
  Names named_;   // variables of the pattern
  Names others_;  // those of them that are not keys
  std::string what_;
  int copies_ = 0;  // number made so far
};

// The nodes of a counting sub-SELECT, from its top to its group, and the names of its aggregates.
struct Chain {
  const Algebra* group = nullptr;
  std::map<std::string, const sparql::Aggregate*>
      counts;  // by name, also those of SELECT (COUNT(?x) AS ?name)
  std::vector<const Algebra*> having;
};

// nullopt: `top` is no such sub-SELECT, or uses its counts in expressions.
std::optional<Chain> ChainOf(const Algebra& top) {
  Chain chain;
  std::vector<const Algebra*> extends;
  const Algebra* at = &top;
  for (; at->kind != Algebra::Kind::kGroup; at = at->children[0].get()) {
    if (at->kind == Algebra::Kind::kExtend) {
      extends.push_back(at);
    } else if (at->kind == Algebra::Kind::kFilter) {
      chain.having.push_back(at);
    } else if (at->kind != Algebra::Kind::kProject) {
      return std::nullopt;
    }
  }
  chain.group = at;
  for (const sparql::Aggregate& aggregate : at->aggregates) chain.counts[aggregate.result.name] = &aggregate;
  for (auto extend = extends.rbegin(); extend != extends.rend(); ++extend) {
    const Expression& value = *(*extend)->expression;
    const auto count = value.kind == Expression::Kind::kVariable ? chain.counts.find(value.variable.name)
                                                                 : chain.counts.end();
    if (count == chain.counts.end()) return std::nullopt;
    const sparql::Aggregate* aggregate = count->second;
    chain.counts[(*extend)->variable.name] = aggregate;
  }
  return chain;
}

class Rewriter {
 public:
  explicit Rewriter(const Algebra& whole) : whole_(whole) {}

  // A copy of `node`. `filters`: conjuncts of the enclosing filters that can see its variables.
  AlgebraPtr Copy(const Algebra& node, const std::vector<const Expression*>& filters) {
    if (AlgebraPtr written = Written(node, filters)) return written;
    AlgebraPtr copy = node.Clone();
    // here the number of equal solutions matters
    if (node.kind == Algebra::Kind::kGroup || node.kind == Algebra::Kind::kSlice ||
        node.kind == Algebra::Kind::kService)
      return copy;
    std::vector<const Expression*> inner;
    if (node.kind == Algebra::Kind::kFilter || node.kind == Algebra::Kind::kJoin) inner = filters;
    if (node.kind == Algebra::Kind::kFilter) sparql::CollectConjuncts(*node.expression, inner);
    // a pattern that may be absent is shown to people as written
    const bool first = node.kind == Algebra::Kind::kMinus || node.kind == Algebra::Kind::kLeftJoin;
    for (size_t i = 0; i < (first ? 1 : node.children.size()); ++i)
      copy->children[i] = Copy(*node.children[i], inner);
    if (node.kind != Algebra::Kind::kFilter) return copy;
    std::vector<const Expression*> own;
    sparql::CollectConjuncts(*node.expression, own);
    std::erase_if(own, [this](const Expression* e) { return used_.contains(e); });
    AlgebraPtr all = std::move(copy->children[0]);
    for (const Expression* e : own) {
      all = Over(Algebra::Kind::kFilter, std::move(all));
      all->span = node.span;
      all->expression = e->Clone();
    }
    return all;
  }
  bool changed() const { return !used_.empty(); }

 private:
  // The sub-SELECT at `top` without its counts; null: it stays as it is.
  AlgebraPtr Written(const Algebra& top, const std::vector<const Expression*>& filters) {
    const std::optional<Chain> chain = ChainOf(top);
    if (!chain) return nullptr;
    std::vector<const Expression*> conjuncts;
    for (const Algebra* filter : chain->having) {
      if (!SeesItsCounts(*filter, *chain)) return nullptr;
      sparql::CollectConjuncts(*filter->expression, conjuncts);
    }
    const size_t own = conjuncts.size();
    conjuncts.insert(conjuncts.end(), filters.begin(), filters.end());
    std::map<const sparql::Aggregate*, Bounds> bounds;
    std::set<const Expression*> used;
    const Names shown = ShownBy(top);
    for (size_t i = 0; i < conjuncts.size(); ++i) {
      const std::optional<CountTest> test = CountTestOf(*conjuncts[i]);
      const bool sees = test && (i < own || shown.contains(test->name));
      const auto count = sees ? chain->counts.find(test->name) : chain->counts.end();
      if (count == chain->counts.end()) {
        if (i < own) return nullptr;  // HAVING has another condition
        continue;
      }
      Bounds& of = bounds[count->second];
      of.least = std::max(of.least, test->bounds.least);
      const auto& below = test->bounds.below;
      if (below) of.below = std::min(of.below.value_or(*below), *below);
      used.insert(conjuncts[i]);
    }
    if (bounds.size() != 1 || IsUsedOtherwise(top, *chain, used)) return nullptr;
    std::optional<Counted> counted = Counted::Of(*chain->group, *bounds.begin()->first, shown);
    const Bounds& within = bounds.begin()->second;
    if (!counted || within.below.value_or(1) < 1) return nullptr;
    used_.insert(used.begin(), used.end());
    return counted->Within(within);
  }

  // True if SELECT shows the filter the names of the counts that it uses.
  static bool SeesItsCounts(const Algebra& filter, const Chain& chain) {
    const Names shown = ShownBy(*filter.children[0]);
    const std::vector<Variable> asked = sparql::MentionedVariables(*filter.expression);
    return std::all_of(asked.begin(), asked.end(), [&](const Variable& v) {
      return v.IsHidden() || !chain.counts.contains(v.name) || shown.contains(v.name);
    });
  }
  // True if an expression other than those conjuncts uses a count.
  bool IsUsedOtherwise(const Algebra& top, const Chain& chain,
                       const std::set<const Expression*>& used) const {
    Names names;
    MentionedBut(whole_, top, used, names);
    return std::any_of(chain.counts.begin(), chain.counts.end(),
                       [&](const auto& count) { return names.contains(count.first); });
  }
  static void MentionedBut(const Algebra& node, const Algebra& top, const std::set<const Expression*>& used,
                           Names& names) {
    if (&node == &top) return;
    if (node.kind == Algebra::Kind::kFilter) {
      std::vector<const Expression*> conjuncts;
      sparql::CollectConjuncts(*node.expression, conjuncts);
      for (const Expression* e : conjuncts) {
        if (used.contains(e)) continue;
        for (const Variable& v : sparql::MentionedVariables(*e)) names.insert(v.name);
      }
      return MentionedBut(*node.children[0], top, used, names);
    }
    if (node.kind == Algebra::Kind::kJoin) {
      for (const AlgebraPtr& child : node.children) MentionedBut(*child, top, used, names);
      return;
    }
    MentionedBeside(node, &top, names);
  }

  const Algebra& whole_;
  std::set<const Expression*> used_;
};

}  // namespace

AlgebraPtr WithoutCounts(const Algebra& where) {
  Rewriter rewriter(where);
  AlgebraPtr copy = rewriter.Copy(where, {});
  return rewriter.changed() ? std::move(copy) : nullptr;
}

}  // namespace docent::explain
