#include "kb_server/rdf/term_id.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "kb_server/rdf/vocabulary.h"

namespace docent {
namespace {

Term Typed(std::string text, std::string_view type) {
  return Term::Literal(std::move(text), std::string(type));
}

void ExpectInline(const std::string& text, std::string_view type) {
  Term term = Typed(text, type);
  std::optional<TermId> id = InlineLiteral(term);
  ASSERT_TRUE(id.has_value()) << text;
  EXPECT_EQ(DecodeInline(*id), term) << text;
  EXPECT_TRUE(id->IsLiteral());
  EXPECT_FALSE(id->InDictionary());
  EXPECT_EQ(InlineDatatype(*id), type);
}

void ExpectNotInline(const std::string& text, std::string_view type) {
  EXPECT_FALSE(InlineLiteral(Typed(text, type)).has_value()) << text;
}

TEST(TermIdTest, Integers) {
  for (const char* text : {"0", "7", "-7", "576460752303423487", "-576460752303423488"})
    ExpectInline(text, kXsdInteger);
  for (const char* text : {"", "-", "-0", "+1", "01", "1.0", "1e3", " 1", "1 ", "576460752303423488",
                           "-576460752303423489", "99999999999999999999999"}) {
    ExpectNotInline(text, kXsdInteger);
  }
  EXPECT_EQ(InlineInteger(*InlineLiteral(Typed("-42", kXsdInteger))), -42);
}

TEST(TermIdTest, DecimalsKeepTheirDigits) {
  for (const char* text : {"0", "0.0", "1.50", "-0.001", "12", "123456.789", "18014398509481983",
                           "-18014398509481984", "0.0000000000000000000000000000001"}) {
    ExpectInline(text, kXsdDecimal);
  }
  for (const char* text : {"", ".", "-", ".5", "5.", "+1.0", "-0", "-0.0", "01.0", "1.2.3", "1e2",
                           "18014398509481984", "1-2", "0.00000000000000000000000000000001", "1.5 "}) {
    ExpectNotInline(text, kXsdDecimal);
  }
  InlineDecimalValue value = InlineDecimal(*InlineLiteral(Typed("-1.250", kXsdDecimal)));
  EXPECT_EQ(value.mantissa, -1250);
  EXPECT_EQ(value.scale, 3);
}

TEST(TermIdTest, EveryPoseFits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    int64_t mm = static_cast<int64_t>(random() % 200000001) - 100000000;
    std::string digits = std::to_string(std::abs(mm) % 1000);
    ExpectInline((mm < 0 ? "-" : "") + std::to_string(std::abs(mm) / 1000) + "." +
                     std::string(3 - digits.size(), '0') + digits.substr(0, 2) + "1",
                 kXsdDecimal);
  }
}

TEST(TermIdTest, DoublesThatFit) {
  for (const char* text : {"0.0E0", "-0.0E0", "1.0E0", "1.5E0", "-2.5E-1", "1.0E10", "INF", "-INF", "NaN"}) {
    ExpectInline(text, kXsdDouble);
  }
  for (const char* text : {"1", "1.0", "1e0", "1.0e0", "1E0", "1.50E0", "0.1E0", "1.0E+1", "1.1E0", "+INF",
                           "inf", "1.0E", "E", "1.0E999"}) {
    ExpectNotInline(text, kXsdDouble);
  }
  EXPECT_EQ(InlineDouble(*InlineLiteral(Typed("-2.5E-1", kXsdDouble))), -0.25);
  EXPECT_TRUE(std::isnan(InlineDouble(*InlineLiteral(Typed("NaN", kXsdDouble)))));
}

TEST(TermIdTest, Booleans) {
  ExpectInline("true", kXsdBoolean);
  ExpectInline("false", kXsdBoolean);
  ExpectNotInline("1", kXsdBoolean);
  ExpectNotInline("True", kXsdBoolean);
  EXPECT_TRUE(InlineBoolean(*InlineLiteral(Term::Boolean(true))));
}

TEST(TermIdTest, Dates) {
  for (const char* text : {"1970-01-01", "2024-02-29Z", "0001-01-01", "9999-12-31Z", "1900-02-28"}) {
    ExpectInline(text, kXsdDate);
  }
  for (const char* text : {"0000-01-01", "2023-02-29", "1900-02-29", "2024-13-01", "2024-00-10", "2024-01-00",
                           "2024-1-1", "-2024-01-01", "2024-01-01+01:00", "12024-01-01", "2024/01/01", ""}) {
    ExpectNotInline(text, kXsdDate);
  }
  InlineTimeValue value = InlineTime(*InlineLiteral(Typed("1969-12-31Z", kXsdDate)));
  EXPECT_EQ(value.time_us, -86'400'000'000);
  EXPECT_TRUE(value.has_zone);
}

TEST(TermIdTest, DateTimesKeepTheirDigits) {
  for (const char* text :
       {"1970-01-01T00:00:00", "1970-01-01T00:00:00Z", "2026-11-21T14:05:09.120Z", "2026-11-21T14:05:09.1",
        "1969-12-31T23:59:59.999999Z", "0830-01-01T00:00:00Z", "3000-01-01T00:00:00.000000"}) {
    ExpectInline(text, kXsdDateTime);
  }
  for (const char* text :
       {"2026-11-21T24:00:00", "2026-11-21T23:59:60", "2026-11-21T14:60:00", "2026-11-21 14:05:09",
        "2026-11-21T14:05:09.", "2026-11-21T14:05:09.1234567", "2026-11-21T14:05:09+01:00",
        "2026-02-30T00:00:00", "0500-01-01T00:00:00Z", "2026-11-21T14:05", "2026-11-21T1a:05:09"}) {
    ExpectNotInline(text, kXsdDateTime);
  }
  InlineTimeValue value = InlineTime(*InlineLiteral(Typed("1969-12-31T23:59:59.5", kXsdDateTime)));
  EXPECT_EQ(value.time_us, -500'000);
  EXPECT_FALSE(value.has_zone);
}

TEST(TermIdTest, OtherTermsNeedTheDictionary) {
  EXPECT_FALSE(InlineLiteral(Term::Iri("http://a")).has_value());
  EXPECT_FALSE(InlineLiteral(Term::Blank("b")).has_value());
  EXPECT_FALSE(InlineLiteral(Term::Literal("1")).has_value());
  ExpectNotInline("1", "http://www.w3.org/2001/XMLSchema#int");
  ExpectNotInline("1", "http://example.org/integer");
}

TEST(TermIdTest, DifferentTermsHaveDifferentIds) {
  EXPECT_NE(InlineLiteral(Typed("1", kXsdInteger)), InlineLiteral(Typed("1", kXsdDecimal)));
  EXPECT_NE(InlineLiteral(Typed("1.0", kXsdDecimal)), InlineLiteral(Typed("1.00", kXsdDecimal)));
  EXPECT_NE(InlineLiteral(Typed("2024-01-01", kXsdDate)), InlineLiteral(Typed("2024-01-01Z", kXsdDate)));
}

}  // namespace
}  // namespace docent
