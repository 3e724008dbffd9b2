// Comparison of numbers of inline literals as doubles: cheap, and undecided if doubles are not enough. Any
// thread.
#ifndef DOCENT_REASONER_MATCHING_NUMBER_RANGE_H_
#define DOCENT_REASONER_MATCHING_NUMBER_RANGE_H_

#include <optional>

#include "graph/rdf/term_id.h"

namespace docent::matching {

// Value of a term in a numeric comparison.
struct NumberView {
  enum class Kind : uint8_t {
    kNumber,   // a number; `value` is the nearest double
    kOther,    // certainly no number: a comparison with a number is an error
    kUnknown,  // a float, or a dictionary literal: perhaps a number in a form that does not fit into an id
  };
  Kind kind = Kind::kUnknown;
  double value = 0;
};
NumberView ViewNumber(TermId id);

// The comparisons of SPARQL that have a direction.
enum class Comparison : uint8_t { kLess, kLessOrEqual, kGreater, kGreaterOrEqual };

// `left op right` (SPARQL 1.1 section 17.3, numeric). nullopt if doubles cannot decide: rounding, NaN, or a
// number in the dictionary. Rounding to double is monotone, so unequal doubles decide. False if an operand is
// no number.
std::optional<bool> CompareNumbers(TermId left, Comparison op, TermId right);

// A necessary condition on a number: `value op bound`.
struct NumberGuard {
  Comparison op = Comparison::kGreater;
  double bound = 0;
};

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_NUMBER_RANGE_H_
