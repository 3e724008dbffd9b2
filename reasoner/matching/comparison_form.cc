#include "reasoner/matching/comparison_form.h"

#include <utility>

namespace docent::matching {
namespace {

using sparql::Expression;

bool IsInlineNumber(const Expression& e) {
  if (e.kind != Expression::Kind::kTerm) return false;
  const std::optional<TermId> id = InlineLiteral(e.term);
  return id && ViewNumber(*id).kind == NumberView::Kind::kNumber;
}

}  // namespace

std::optional<Comparison> ComparisonOf(Expression::Kind kind) {
  switch (kind) {
    case Expression::Kind::kLess:
      return Comparison::kLess;
    case Expression::Kind::kLessOrEqual:
      return Comparison::kLessOrEqual;
    case Expression::Kind::kGreater:
      return Comparison::kGreater;
    case Expression::Kind::kGreaterOrEqual:
      return Comparison::kGreaterOrEqual;
    default:
      return std::nullopt;
  }
}

Comparison Mirror(Comparison op) {
  switch (op) {
    case Comparison::kLess:
      return Comparison::kGreater;
    case Comparison::kLessOrEqual:
      return Comparison::kGreaterOrEqual;
    case Comparison::kGreater:
      return Comparison::kLess;
    case Comparison::kGreaterOrEqual:
      return Comparison::kLessOrEqual;
  }
  return op;
}

std::optional<NumberComparison> ReadNumberComparison(const Expression& e) {
  std::optional<Comparison> op = ComparisonOf(e.kind);
  if (!op && e.kind != Expression::Kind::kEqual) return std::nullopt;
  const Expression* variable = e.arguments[0].get();
  const Expression* number = e.arguments[1].get();
  if (variable->kind != Expression::Kind::kVariable) {
    std::swap(variable, number);
    if (op) op = Mirror(*op);
  }
  if (variable->kind != Expression::Kind::kVariable || !IsInlineNumber(*number)) return std::nullopt;
  return NumberComparison{&variable->variable, op, &number->term};
}

}  // namespace docent::matching
