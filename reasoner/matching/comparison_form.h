// Comparisons as queries write them, for what decides them on ids (number_range.h). Pure; any thread.
#ifndef DOCENT_REASONER_MATCHING_COMPARISON_FORM_H_
#define DOCENT_REASONER_MATCHING_COMPARISON_FORM_H_

#include <optional>

#include "graph/sparql/syntax/algebra.h"
#include "reasoner/matching/number_range.h"

namespace docent::matching {

// nullopt: it has no direction.
std::optional<Comparison> ComparisonOf(sparql::Expression::Kind kind);
// b Mirror(op) a for a op b.
Comparison Mirror(Comparison op);

// ?variable op number, either way round.
struct NumberComparison {
  const sparql::Variable* variable;
  std::optional<Comparison> op;  // nullopt: =
  const Term* number;            // one that fits into an id
};
// Of parts of `e`, which is to outlive it; nullopt: it is none.
std::optional<NumberComparison> ReadNumberComparison(const sparql::Expression& e);

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_COMPARISON_FORM_H_
