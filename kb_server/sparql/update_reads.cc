#include "kb_server/sparql/update_reads.h"

#include <algorithm>

namespace docent::sparql {
namespace {

std::optional<Term> Constant(const PatternTerm& term) {
  return term.IsVariable() ? std::nullopt : std::optional<Term>(term.term);
}

// Whether `test(node)` holds for a node anywhere in `a`, expressions included.
template <typename Test>
bool Any(const Algebra& a, const Test& test);

template <typename Test>
bool Any(const Expression& e, const Test& test) {
  return (e.pattern && Any(*e.pattern, test)) ||
         std::any_of(e.arguments.begin(), e.arguments.end(),
                     [&test](const ExpressionPtr& argument) { return Any(*argument, test); });
}

template <typename Test>
bool Any(const Algebra& a, const Test& test) {
  if (test(a) || (a.expression && Any(*a.expression, test))) return true;
  for (const AlgebraPtr& child : a.children) {
    if (Any(*child, test)) return true;
  }
  for (const GroupKey& key : a.group_keys) {
    if (Any(*key.expression, test)) return true;
  }
  for (const Aggregate& aggregate : a.aggregates) {
    if (aggregate.expression && Any(*aggregate.expression, test)) return true;
  }
  for (const OrderCondition& order : a.order) {
    if (Any(*order.expression, test)) return true;
  }
  return false;
}

// A path; GRAPH over something that is more than triples: { }, a sub-SELECT, …
bool ReadsEverything(const Algebra& a) {
  if (a.kind == Algebra::Kind::kPath) return true;
  if (a.kind != Algebra::Kind::kGraph) return false;
  const Algebra& inner = *a.children[0];
  return inner.kind != Algebra::Kind::kBgp || inner.triples.empty();
}

}  // namespace

void AddReads(const Algebra& where, std::vector<ReadPattern>* out) {
  if (Any(where, ReadsEverything)) {
    out->push_back({});
    return;
  }
  for (const PatternOccurrence& occurrence : AllTriplePatterns(where)) {
    const TriplePattern& t = *occurrence.pattern;
    ReadPattern read{Constant(t.subject), Constant(t.predicate), Constant(t.object), std::nullopt};
    if (std::find(out->begin(), out->end(), read) == out->end()) out->push_back(std::move(read));
  }
}

}  // namespace docent::sparql
