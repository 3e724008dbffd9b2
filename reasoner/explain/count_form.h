// Counts that are only compared with a number, as patterns that say the same: what why-not can reason about.
//
//   { SELECT ?b (COUNT(?v) AS ?n) { ?v :at ?b } GROUP BY ?b } FILTER(?n >= 2)
//     → { SELECT ?b { ?v :at ?b . ?v_2 :at ?b FILTER(!sameTerm(?v, ?v_2)) } }
//   … FILTER(?n < 2)
//     → { SELECT ?b { ?v :at ?b FILTER NOT EXISTS { ?v_3 :at ?b . ?v_4 :at ?b FILTER(!sameTerm(?v_3, ?v_4)) } } }
//
// Pure functions; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_COUNT_FORM_H_
#define DOCENT_REASONER_EXPLAIN_COUNT_FORM_H_

#include "graph/sparql/syntax/algebra.h"

namespace docent::explain {

// Counts up to here are written out.
inline constexpr int kMostCounted = 4;

// `where` with a solution exactly when it has one, and with the same values for what both show, but without such counts.
// Null where it has none: of things that are counted once (DISTINCT, or no other variable in what is counted), by
// variables, compared with a number of at most kMostCounted, and not used otherwise.
sparql::AlgebraPtr WithoutCounts(const sparql::Algebra& where);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_COUNT_FORM_H_
