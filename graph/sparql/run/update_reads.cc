#include "graph/sparql/run/update_reads.h"

#include <algorithm>

#include "graph/sparql/syntax/algebra_walk.h"

namespace docent::sparql {
namespace {

std::optional<Term> Constant(const PatternTerm& term) {
  return term.IsVariable() ? std::nullopt : std::optional<Term>(term.term());
}

// True for a path, and for GRAPH over something other than triples: { }, a sub-SELECT, …
bool ReadsEverything(const Algebra& a) {
  if (a.kind == Algebra::Kind::kPath) return true;
  if (a.kind != Algebra::Kind::kGraph) return false;
  const Algebra& inner = *a.children[0];
  return inner.kind != Algebra::Kind::kBgp || inner.triples.empty();
}

}  // namespace

void AddReads(const Algebra& where, std::vector<ReadPattern>* out) {
  if (AnyNode(where, ReadsEverything)) {
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
