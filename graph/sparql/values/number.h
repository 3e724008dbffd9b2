// A number without its term, for fast comparisons: read from an inline id or a Value in a few instructions,
// without a Value for each operand. Value; any thread.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_NUMBER_H_
#define DOCENT_GRAPH_SPARQL_VALUES_NUMBER_H_

#include <cmath>
#include <compare>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <optional>

#include "graph/rdf/dictionary.h"
#include "graph/rdf/term_id.h"
#include "graph/sparql/values/decimal.h"
#include "graph/sparql/values/value.h"

namespace docent::sparql {

class Number {
 public:
  // None if the id is no inline number. A dictionary id ("007"^^xsd:integer) or local id may be a number.
  static Number Of(TermId id) {
    switch (id.tag()) {
      case TermId::Tag::kInteger:
        return Number(Decimal::Of(InlineInteger(id)));
      case TermId::Tag::kDecimal: {
        const InlineDecimalValue value = InlineDecimal(id);
        return Number(Decimal{value.mantissa, value.scale});
      }
      case TermId::Tag::kPlainDouble:
        return Number(InlineDouble(id), InlineIsFloat(id) ? Kind::kFloat : Kind::kDouble);
      case TermId::Tag::kDouble:
      case TermId::Tag::kNearDouble:
        return Number(InlineDouble(id), Kind::kDouble);
      default:
        return Number();
    }
  }
  // None if the value is no number.
  static Number Of(const Value& value) {
    if (value.IsExact()) return Number(value.decimal());
    if (!value.IsNumeric()) return Number();
    return Number(value.number(), value.type() == Value::Type::kFloat ? Kind::kFloat : Kind::kDouble);
  }

  bool IsNone() const { return kind_ == Kind::kNone; }
  bool IsNan() const { return kind_ >= Kind::kFloat && std::isnan(inexact_); }

  // Compares with the promotions of XPath; NaN is unordered. Neither may be none.
  friend std::partial_ordering Compare(const Number& a, const Number& b) {
    if (a.kind_ == Kind::kExact && b.kind_ == Kind::kExact) return Compare(a.exact_, b.exact_) <=> 0;
    return CompareInexact(a, b);
  }

 private:
  enum class Kind : uint8_t { kNone, kExact, kFloat, kDouble };

  Number() = default;
  explicit Number(const Decimal& value) : kind_(Kind::kExact), exact_(value) {}
  Number(double value, Kind kind) : kind_(kind), inexact_(value) {}

  double AsDouble() const { return kind_ == Kind::kExact ? exact_.ToDouble() : inexact_; }
  static std::partial_ordering CompareInexact(const Number& a, const Number& b) {
    const double x = a.AsDouble(), y = b.AsDouble();
    if (a.kind_ == Kind::kDouble || b.kind_ == Kind::kDouble) return x <=> y;
    return static_cast<float>(x) <=> static_cast<float>(y);
  }

  Kind kind_ = Kind::kNone;
  double inexact_ = 0;
  Decimal exact_;
};

// Compares two inline integers or decimals, faster; nullopt: one is neither, or the scales differ too much.
inline std::optional<std::strong_ordering> CompareExact(TermId a, TermId b) {
  using Tag = TermId::Tag;
  const Tag of_a = a.tag(), of_b = b.tag();
  if (of_a == of_b && (of_a == Tag::kInteger ||
                       (of_a == Tag::kDecimal && InlineDecimal(a).scale == InlineDecimal(b).scale))) {
    return InlineInteger(a) <=> InlineInteger(b);  // a decimal's scale is in the lowest bits
  }
  if ((of_a != Tag::kInteger && of_a != Tag::kDecimal) || (of_b != Tag::kInteger && of_b != Tag::kDecimal))
    return std::nullopt;
  const InlineDecimalValue x =
      of_a == Tag::kInteger ? InlineDecimalValue{InlineInteger(a), 0} : InlineDecimal(a);
  const InlineDecimalValue y =
      of_b == Tag::kInteger ? InlineDecimalValue{InlineInteger(b), 0} : InlineDecimal(b);
  const int further = x.scale - y.scale;
  if (std::abs(further) >= std::ssize(kPowersOfTen)) return std::nullopt;
  // Mantissas have 60 bits at most: the products fit.
  const Int128 left = further < 0 ? Int128{x.mantissa} * kPowersOfTen[-further] : x.mantissa;
  const Int128 right = further > 0 ? Int128{y.mantissa} * kPowersOfTen[further] : y.mantissa;
  return left < right   ? std::strong_ordering::less
         : left > right ? std::strong_ordering::greater
                        : std::strong_ordering::equal;
}

// CompareForOrder of two ids, if it can be decided without values; else nullopt.
std::optional<int> CompareIdsForOrder(TermId a, TermId b, const Dictionary& dictionary);
inline std::optional<int> CompareForOrder(TermId a, TermId b, const Dictionary& dictionary) {
  if (a == b) return 0;
  if (const auto order = CompareExact(a, b)) return *order < 0 ? -1 : *order > 0 ? 1 : 0;
  return CompareIdsForOrder(a, b, dictionary);
}

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_NUMBER_H_
