// Comparisons in queries, in the form that can be decided on ids (number_range.h). Pure; any thread.
#ifndef DOCENT_REASONER_MATCHING_COMPARISON_FORM_H_
#define DOCENT_REASONER_MATCHING_COMPARISON_FORM_H_

#include <optional>

#include "graph/sparql/syntax/algebra.h"
#include "reasoner/matching/number_range.h"

namespace docent::matching {

// nullopt: the operator has no direction.
std::optional<Comparison> ComparisonOf(sparql::Expression::Kind kind);
// b Mirror(op) a is the same as a op b.
Comparison Mirror(Comparison op);

// ?variable op number, in either order.
struct NumberComparison {
  const sparql::Variable* variable;
  std::optional<Comparison> op;  // nullopt: =
  const Term* number;            // fits into an id
};
// Points into `e`, which must outlive the result; nullopt: no such comparison.
std::optional<NumberComparison> ReadNumberComparison(const sparql::Expression& e);

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_COMPARISON_FORM_H_
