#include "reasoner/matching/number_range.h"

#include <gtest/gtest.h>

#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"

namespace docent::matching {
namespace {

TermId Number(const std::string& text, std::string_view datatype) {
  return InlineLiteral(Term::Literal(text, std::string(datatype))).value();
}

TEST(NumberRange, ReadsInlineNumbersOfEachType) {
  EXPECT_EQ(ViewNumber(Number("-7", kXsdInteger)).value, -7);
  EXPECT_EQ(ViewNumber(Number("0.5", kXsdDecimal)).value, 0.5);
  EXPECT_EQ(ViewNumber(Number("2.5E1", kXsdDouble)).value, 25);
  EXPECT_EQ(ViewNumber(Number("25.000000", kXsdDouble)).value, 25);
  EXPECT_EQ(ViewNumber(Number("0.30000000000000004", kXsdDouble)).value, 0.1 + 0.2);
}

TEST(NumberRange, TermsThatAreNoNumbersAreTold) {
  EXPECT_EQ(ViewNumber(TermId::Make(TermId::Tag::kIri, 3)).kind, NumberView::Kind::kOther);
  EXPECT_EQ(ViewNumber(TermId::Make(TermId::Tag::kLiteral, 3)).kind, NumberView::Kind::kUnknown);
  EXPECT_EQ(ViewNumber(Number("NaN", kXsdDouble)).kind, NumberView::Kind::kUnknown);
}

TEST(NumberRange, ComparesAcrossTypes) {
  const TermId half = Number("0.5", kXsdDecimal);
  const TermId one = Number("1", kXsdInteger);
  EXPECT_EQ(CompareNumbers(half, Comparison::kLess, one), true);
  EXPECT_EQ(CompareNumbers(half, Comparison::kGreaterOrEqual, one), false);
  EXPECT_EQ(CompareNumbers(one, Comparison::kGreater, half), true);
}

TEST(NumberRange, LeavesOpenWhatDoublesCannotTell) {
  // 9007199254740993 = 2^53 + 1 is no double.
  const TermId a = Number("9007199254740993", kXsdInteger);
  const TermId b = Number("9007199254740992", kXsdInteger);
  EXPECT_EQ(CompareNumbers(a, Comparison::kGreater, b), std::nullopt);
  EXPECT_EQ(CompareNumbers(Number("1", kXsdInteger), Comparison::kLess, Number("1.0", kXsdDecimal)),
            std::nullopt);
  EXPECT_EQ(CompareNumbers(TermId::Make(TermId::Tag::kLiteral, 1), Comparison::kLess, a), std::nullopt);
  // compared in single precision, where both are the same
  EXPECT_EQ(CompareNumbers(Number("0.1", kXsdDecimal), Comparison::kLess, Number("0.1", kXsdFloat)),
            std::nullopt);
}

TEST(NumberRange, AComparisonOfANumberWithAnIriIsAnErrorAndThusFalse) {
  EXPECT_EQ(CompareNumbers(TermId::Make(TermId::Tag::kIri, 1), Comparison::kLess, Number("1", kXsdInteger)),
            false);
}

// A long decimal without an exact quotient is still ordered correctly among its neighbours.
TEST(NumberRange, LongDecimalsKeepTheirOrder) {
  const TermId low = Number("0.12345678901234567", kXsdDecimal);
  const TermId high = Number("0.12345678901234967", kXsdDecimal);
  EXPECT_EQ(CompareNumbers(low, Comparison::kLess, high), true);
}

}  // namespace
}  // namespace docent::matching
