// Rewriting of counts that are only compared with a number into patterns on which why-not can work.
//
//   { SELECT ?b (COUNT(?v) AS ?n) { ?v :at ?b } GROUP BY ?b } FILTER(?n >= 2)
//     → { SELECT ?b { ?v :at ?b . ?v_2 :at ?b FILTER(!sameTerm(?v, ?v_2)) } }
//   … FILTER(?n < 2)
//     → { SELECT ?b { ?v :at ?b
//           FILTER NOT EXISTS { ?v_3 :at ?b . ?v_4 :at ?b FILTER(!sameTerm(?v_3, ?v_4)) } } }
//
// Pure functions; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_COUNT_FORM_H_
#define DOCENT_REASONER_EXPLAIN_COUNT_FORM_H_

#include "graph/sparql/syntax/algebra.h"

namespace docent::explain {

// Counts up to this number are rewritten.
inline constexpr int kMostCounted = 4;

// `where` without such counts: it has a solution exactly if `where` has one, and the same values for the
// variables that both project. Null if `where` has none. The counted things must be distinct (DISTINCT, or no
// other variable in the counted pattern), grouped by variables, compared with a number of at most
// kMostCounted, and not used otherwise.
sparql::AlgebraPtr WithoutCounts(const sparql::Algebra& where);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_COUNT_FORM_H_
