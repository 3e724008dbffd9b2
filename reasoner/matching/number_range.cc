#include "reasoner/matching/number_range.h"

#include <charconv>
#include <cmath>

#include "kb_server/rdf/term.h"

namespace docent {

NumberView ViewNumber(TermId id) {
  switch (id.tag()) {
    case TermId::Tag::kInteger: {
      const int64_t shifted = static_cast<int64_t>(id.payload() << 4);
      return {NumberView::Kind::kNumber, static_cast<double>(shifted >> 4)};
    }
    case TermId::Tag::kDecimal:
    case TermId::Tag::kDouble: {
      const Term term = DecodeInline(id);
      double value = 0;
      const char* end = term.lexical.data() + term.lexical.size();
      const auto [stop, error] = std::from_chars(term.lexical.data(), end, value);
      if (error != std::errc() || stop != end) return {NumberView::Kind::kUnknown, 0};
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

}  // namespace docent
