#include "graph/sparql/run/update_reads.h"

#include <algorithm>

#include "graph/sparql/syntax/algebra_walk.h"

namespace docent::sparql {
namespace {

constexpr size_t kMostReads = 256;

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
  if (AnyNode(where, ReadsEverything)) return AddRead({}, out);
  for (const PatternOccurrence& occurrence : AllTriplePatterns(where)) {
    const TriplePattern& t = *occurrence.pattern;
    AddRead({Constant(t.subject), Constant(t.predicate), Constant(t.object), std::nullopt}, out);
  }
}

void AddRead(ReadPattern read, std::vector<ReadPattern>* out) {
  const ReadPattern everything;
  if (!out->empty() && out->front() == everything) return;
  if (read == everything || out->size() == kMostReads) {
    out->assign(1, everything);
  } else if (std::find(out->begin(), out->end(), read) == out->end()) {
    out->push_back(std::move(read));
  }
}

}  // namespace docent::sparql
