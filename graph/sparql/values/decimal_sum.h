// Exact sum of decimals that may leave the 38 digits of a Decimal on the way: whether it fits at the end does not
// depend on the order of the numbers. Value; one thread.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_DECIMAL_SUM_H_
#define DOCENT_GRAPH_SPARQL_VALUES_DECIMAL_SUM_H_

#include <array>
#include <optional>

#include "graph/sparql/values/decimal.h"

namespace docent::sparql {

class DecimalSum {
 public:
  void Add(const Decimal& number);
  // nullopt: it has more digits than a Decimal.
  std::optional<Decimal> Result() const;

 private:
  static constexpr int kLimbDigits = 18;
  // The sum times 10^36, the lowest limb first: 108 digits, of which a number has 74. Limbs may be negative.
  std::array<Int128, 6> limbs_{};
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_DECIMAL_SUM_H_
