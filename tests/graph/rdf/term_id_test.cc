#include "graph/rdf/term_id.h"

#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "graph/rdf/vocabulary.h"

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
  for (const char* text : {"0.0E0",
                           "-0.0E0",
                           "1.0E0",
                           "1.5E0",
                           "-2.5E-1",
                           "1.0E10",
                           "INF",
                           "-INF",
                           "NaN",
                           "1.1E0",
                           "1.2345678901234567E1",
                           "-1.234567890123456E-7",  // canonical
                           "1",
                           "1.0",
                           "0.0",
                           "-0.05",
                           "12.340000",
                           "-3",
                           "123456789.123456",  // a decimal
                           "12.345678901234567",
                           "-0.30000000000000004",
                           "65535.99999999999",  // shortest
                           "9.5e-05",
                           "1e-05",
                           "-1.234567890123456e-05"}) {
    ExpectInline(text, kXsdDouble);
  }
  for (const char* text : {"1e0",
                           "1.0e0",
                           "1E0",
                           "1.50E0",
                           "0.1E0",
                           "1.0E+1",
                           "+INF",
                           "inf",
                           "nan",
                           "infinity",
                           "1.0E",
                           "E",
                           "e",
                           "",
                           "-",
                           ".",
                           ".5",
                           "5.",
                           "+1.0",
                           "-0",
                           "-0.0",
                           "01.0",
                           "1.0E999",
                           "9.5E-05",
                           "9.5e-5",
                           "12.3456789012345670",
                           "12.34567890123456789",
                           "1.2345678901234567E10",
                           "0.00000000000000000000001",
                           "1.5 ",
                           "0x1p3",
                           "1.2345678901234567e-10"}) {
    ExpectNotInline(text, kXsdDouble);
  }
  const auto value = [](const char* text) { return InlineDouble(*InlineLiteral(Typed(text, kXsdDouble))); };
  EXPECT_EQ(value("-2.5E-1"), -0.25);
  EXPECT_EQ(value("12.340000"), 12.34);
  EXPECT_EQ(value("0.30000000000000004"), 0.1 + 0.2);
  EXPECT_EQ(value("-9.5e-05"), -9.5e-05);
  EXPECT_TRUE(std::isnan(value("NaN")));
}

TEST(TermIdTest, FloatsAsDecimals) {
  for (const char* text : {"0", "0.1", "-12.340000", "16777217"}) ExpectInline(text, kXsdFloat);
  for (const char* text : {"1.0E0", "-0.0", "INF", "1e3"}) ExpectNotInline(text, kXsdFloat);
  EXPECT_EQ(InlineDouble(*InlineLiteral(Typed("0.1", kXsdFloat))), static_cast<double>(0.1f));
  EXPECT_EQ(InlineDouble(*InlineLiteral(Typed("16777217", kXsdFloat))), 16777216.0);
}

// As Python, C++ streams and printf write them.
TEST(TermIdTest, EveryCoordinateFitsHoweverItIsWritten) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-5000, 5000);
  for (int i = 0; i < 20000; ++i) {
    const double value = place(random) / (1 + static_cast<double>(random() % 1000));
    for (const std::chars_format format : {std::chars_format::fixed, std::chars_format::scientific}) {
      std::array<char, 40> buffer;
      const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format).ptr;
      const std::string text(buffer.data(), end);
      if (std::abs(value) < 0x1p-26) continue;
      ExpectInline(text, kXsdDouble);
      EXPECT_EQ(InlineDouble(*InlineLiteral(Typed(text, kXsdDouble))), value) << text;
    }
    ExpectInline(std::to_string(std::abs(value) + 1), kXsdDouble);
  }
}

TEST(TermIdTest, NumbersHaveTheIdsOfTheirTexts) {
  for (const int64_t value : {int64_t{0}, int64_t{-1}, (int64_t{1} << 59) - 1, -(int64_t{1} << 59)}) {
    EXPECT_EQ(InlineIntegerId(value), InlineLiteral(Typed(std::to_string(value), kXsdInteger))) << value;
  }
  EXPECT_EQ(InlineIntegerId(int64_t{1} << 59), std::nullopt);
  EXPECT_EQ(InlineIntegerId(-(int64_t{1} << 59) - 1), std::nullopt);
  const std::pair<InlineDecimalValue, std::string> decimals[] = {
      {{0, 0}, "0"},
      {{0, 2}, "0.00"},
      {{5, 1}, "0.5"},
      {{-5, 3}, "-0.005"},
      {{150, 2}, "1.50"},
      {{-1200, 0}, "-1200"},
      {{1, 31}, "0.0000000000000000000000000000001"}};
  for (const auto& [value, text] : decimals) {
    EXPECT_EQ(InlineDecimalId(value), InlineLiteral(Typed(text, kXsdDecimal))) << text;
  }
  EXPECT_EQ(InlineDecimalId({1, 32}), std::nullopt);
  EXPECT_EQ(InlineDecimalId({int64_t{1} << 54, 0}), std::nullopt);
  EXPECT_TRUE(InlineDecimalId({-(int64_t{1} << 54), 31}));
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
  EXPECT_EQ(value.local_us, -86'400'000'000);
  EXPECT_EQ(value.zone_minutes, 0);
}

TEST(TermIdTest, DateTimesKeepTheirDigits) {
  for (const char* text :
       {"1970-01-01T00:00:00", "1970-01-01T00:00:00Z", "2026-11-21T14:05:09.120Z", "2026-11-21T14:05:09.1",
        "1969-12-31T23:59:59.999999Z", "0830-01-01T00:00:00Z", "3000-01-01T00:00:00.000000"}) {
    ExpectInline(text, kXsdDateTime);
  }
  for (const char* text :
       {"2026-11-21T14:05:09+01:00", "2026-11-21T14:05:09.040829+00:00", "2000-01-01T00:00:00.000-14:00",
        "2071-01-01T00:00:00.999999+14:00", "2026-11-21T14:05:09.123-03:30"}) {
    ExpectInline(text, kXsdDateTime);
  }
  for (const char* text :
       {"2026-11-21T24:00:00", "2026-11-21T23:59:60", "2026-11-21T14:60:00", "2026-11-21 14:05:09",
        "2026-11-21T14:05:09.", "2026-11-21T14:05:09.1234567", "2026-11-21T14:05:09-00:00",
        "2026-11-21T14:05:09+01:07", "2026-11-21T14:05:09+14:15", "2026-11-21T14:05:09.12+01:00",
        "1999-12-31T23:59:59+00:00", "2072-01-01T00:00:00+00:00", "2026-11-21T14:05:09+1:00",
        "2026-11-21T14:05:09 01:00", "2026-11-21T14:05:09+01:60", "2026-02-30T00:00:00",
        "0500-01-01T00:00:00Z", "2026-11-21T14:05", "2026-11-21T1a:05:09"}) {
    ExpectNotInline(text, kXsdDateTime);
  }
  const InlineTimeValue zoned = InlineTime(*InlineLiteral(Typed("2000-01-02T00:00:00-03:30", kXsdDateTime)));
  EXPECT_EQ(zoned.zone_minutes, -210);
  EXPECT_EQ(zoned.local_us, 946'771'200'000'000);
  InlineTimeValue value = InlineTime(*InlineLiteral(Typed("1969-12-31T23:59:59.5", kXsdDateTime)));
  EXPECT_EQ(value.local_us, -500'000);
  EXPECT_EQ(value.zone_minutes, std::nullopt);
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
