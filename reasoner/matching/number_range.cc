#include "reasoner/matching/number_range.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "graph/rdf/term.h"

namespace docent::matching {

namespace {

// Numerators and denominators up to here are exact doubles, so their quotient is the correctly rounded
// value.
constexpr int64_t kExactMantissa = int64_t{1} << 53;
constexpr int kExactPower = 22;

NumberView FromText(TermId id) {
  const Term term = DecodeInline(id);
  double value = 0;
  const char* end = term.lexical.data() + term.lexical.size();
  const auto [stop, error] = std::from_chars(term.lexical.data(), end, value);
  if (error != std::errc() || stop != end) return {NumberView::Kind::kUnknown, 0};
  return {NumberView::Kind::kNumber, value};
}

NumberView FromDecimal(TermId id) {
  static constexpr std::array<double, kExactPower + 1> kPowers = {
      1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const InlineDecimalValue value = InlineDecimal(id);
  if (value.scale > kExactPower || std::abs(value.mantissa) > kExactMantissa) return FromText(id);
  return {NumberView::Kind::kNumber, static_cast<double>(value.mantissa) / kPowers[value.scale]};
}

}  // namespace

NumberView ViewNumber(TermId id) {
  switch (id.tag()) {
    case TermId::Tag::kInteger:
      return {NumberView::Kind::kNumber, static_cast<double>(InlineInteger(id))};
    case TermId::Tag::kDecimal:
      return FromDecimal(id);
    case TermId::Tag::kDouble:
    case TermId::Tag::kPlainDouble:
    case TermId::Tag::kNearDouble: {
      // A number compared with a float is first rounded to a float: 0.1 is not less than "0.1"^^xsd:float.
      if (id.tag() == TermId::Tag::kPlainDouble && InlineIsFloat(id)) return {NumberView::Kind::kUnknown, 0};
      const double value = InlineDouble(id);
      if (std::isnan(value)) return {NumberView::Kind::kUnknown, 0};
      return {NumberView::Kind::kNumber, value};
    }
    case TermId::Tag::kLiteral:
    case TermId::Tag::kLocal:
    case TermId::Tag::kNone:
      return {NumberView::Kind::kUnknown, 0};
    default:
      return {NumberView::Kind::kOther, 0};
  }
}

std::optional<bool> CompareNumbers(TermId left, Comparison op, TermId right) {
  const NumberView a = ViewNumber(left);
  const NumberView b = ViewNumber(right);
  if (a.kind != NumberView::Kind::kNumber || b.kind != NumberView::Kind::kNumber) {
    const bool one_is_number = a.kind == NumberView::Kind::kNumber || b.kind == NumberView::Kind::kNumber;
    const bool one_is_other = a.kind == NumberView::Kind::kOther || b.kind == NumberView::Kind::kOther;
    if (one_is_number && one_is_other) return false;
    return std::nullopt;
  }
  if (a.value == b.value) return std::nullopt;
  const bool less = a.value < b.value;
  return (op == Comparison::kLess || op == Comparison::kLessOrEqual) ? less : !less;
}

}  // namespace docent::matching
