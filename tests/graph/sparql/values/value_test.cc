#include "graph/sparql/values/value.h"

#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/values/number.h"

namespace docent::sparql {
namespace {

using std::string_literals::operator""s;

Value Of(const std::string& lexical, std::string_view datatype) {
  return Value::OfTerm(Term::Literal(lexical, std::string(datatype)));
}
std::string Text(const Value& v) {
  return v.IsError() ? "error" : v.CanonicalText();
}

TEST(Decimal, ReadsAndWritesExactly) {
  EXPECT_EQ(Decimal::Parse("0.1")->ToString(), "0.1");
  EXPECT_EQ(Decimal::Parse("-00012.500")->ToString(), "-12.5");
  EXPECT_EQ(Decimal::Parse("+.5")->ToString(), "0.5");
  EXPECT_EQ(Decimal::Parse("5.")->ToString(), "5");
  for (const char* text :
       {"0", "-1", "0.5", "-0.05", "9999999999999999999", "10000000000000000000", "-10000000000000000001.5",
        "12345678901234567890123456789", "99999999999999999999999999999999999999",
        "0.000000000000000000000000000000000001", "-1.70141183460469231731687303715884105"}) {
    EXPECT_EQ(Decimal::Parse(text)->ToString(), text);
  }
  EXPECT_EQ(Decimal::Parse("100000000000000000000.500")->ToString(), "100000000000000000000.5");
  EXPECT_EQ(Decimal::Parse("0.000")->ToString(), "0");
  for (const char* bad : {"", "-", ".", "1e3", "1.2.3", "abc", "100000000000000000000000000000000000000",
                          "-1000000000000000000000000000000000000.01"}) {
    EXPECT_FALSE(Decimal::Parse(bad)) << bad;
  }
}

TEST(Decimal, ComputesWithoutRounding) {
  const Decimal tenth = *Decimal::Parse("0.1"), fifth = *Decimal::Parse("0.2");
  EXPECT_EQ(Add(tenth, fifth)->ToString(), "0.3");
  EXPECT_EQ(Subtract(tenth, fifth)->ToString(), "-0.1");
  EXPECT_EQ(Multiply(tenth, fifth)->ToString(), "0.02");
  EXPECT_EQ(Divide(Decimal::Of(1), Decimal::Of(3))->ToString(), "0.333333333333333333");
  EXPECT_EQ(Divide(Decimal::Of(6), *Decimal::Parse("0.004"))->ToString(), "1500");
  EXPECT_FALSE(Divide(tenth, Decimal::Of(0)));
  const Decimal large = *Decimal::Parse("99999999999999999999999999999999999999");
  EXPECT_FALSE(Multiply(large, large));
}

// 38 digits, whichever way a number comes about.
TEST(Decimal, HasOneLimitForAllThatMakesNumbers) {
  const auto of = [](const char* text) { return *Decimal::Parse(text); };
  const auto text = [](const std::optional<Decimal>& d) { return d ? d->ToString() : "none"; };
  const Decimal most = of("99999999999999999999999999999999999999");
  EXPECT_EQ(text(Add(most, Decimal::Of(0))), "99999999999999999999999999999999999999");
  EXPECT_EQ(text(Add(most, Decimal::Of(1))), "none");
  EXPECT_EQ(text(Subtract(Decimal::Of(-1), most)), "none");
  EXPECT_EQ(text(Multiply(of("10000000000000000000000000000000000000"), Decimal::Of(9))),
            "90000000000000000000000000000000000000");
  EXPECT_EQ(text(Multiply(of("10000000000000000000000000000000000000"), Decimal::Of(10))), "none");
  EXPECT_EQ(text(Divide(most, Decimal::Of(1))), "99999999999999999999999999999999999999");
  EXPECT_EQ(text(Divide(of("12000000000000000000000000000000000000"), of("0.1"))), "none");
  // What fits is there even if the way to it has more digits.
  EXPECT_EQ(text(Subtract(of("18000000000000000000000000000000000000"),
                          of("9500000000000000000000000000000000000.5"))),
            "8499999999999999999999999999999999999.5");
  EXPECT_EQ(text(Multiply(of("80000000000000000000000000000000000000"), of("0.5"))),
            "40000000000000000000000000000000000000");
  EXPECT_EQ(text(Multiply(of("-1.1"), of("90000000000000000000000000000000000000"))),
            "-99000000000000000000000000000000000000");
  EXPECT_EQ(text(Divide(of("18000000000000000000000000000000000000"), of("0.7"))),
            "25714285714285714285714285714285714285");
  EXPECT_EQ(text(Divide(of("-10000000000000000000000000000000000000"), Decimal::Of(3))),
            "-3333333333333333333333333333333333333.3");
  EXPECT_EQ(text(Divide(of("0.000000000000000000000000000000000001"), of("1000000000000000000000000000000"))),
            "0");
}

TEST(Decimal, RoundsAsXPathSays) {
  for (const auto& [text, floor, ceiling, round] : {std::tuple{"2.5", "2", "3", "3"},
                                                    {"-2.5", "-3", "-2", "-2"},
                                                    {"2.4", "2", "3", "2"},
                                                    {"-2.6", "-3", "-2", "-3"}}) {
    const Decimal d = *Decimal::Parse(text);
    EXPECT_EQ(d.Floor().ToString(), floor);
    EXPECT_EQ(d.Ceiling().ToString(), ceiling);
    EXPECT_EQ(d.Round().ToString(), round);
  }
}

TEST(Decimal, ComparesNumbersOfAnyScale) {
  EXPECT_LT(Compare(*Decimal::Parse("0.1"), *Decimal::Parse("0.11")), 0);
  EXPECT_EQ(Compare(*Decimal::Parse("1.10"), *Decimal::Parse("1.1")), 0);
  EXPECT_GT(Compare(*Decimal::Parse("99999999999999999999999999999999999999"),
                    *Decimal::Parse("0.000000000000000000000000000000000001")),
            0);
  EXPECT_GT(Compare(*Decimal::Parse("12345678901234567890.123456789012345679"),
                    *Decimal::Parse("12345678901234567890.123456789012345678")),
            0);
  EXPECT_LT(Compare(*Decimal::Parse("18000000000000000000000000000000000000"),
                    *Decimal::Parse("-9500000000000000000000000000000000000.5")) *
                -1,
            0);
}

// A number has one place in the order, compared by its id or by its value.
TEST(Number, ComparesAsItsValueDoes) {
  Dictionary dictionary;
  std::vector<Term> terms = {Term::Iri("http://a"),
                             Term::Blank("b"),
                             Term::Literal("1"),
                             Term::LangString("1", "en"),
                             Term::Boolean(true),
                             Term::Literal("2014-02-28", std::string(kXsdDate)),
                             Term::Literal("2014-02-28Z", std::string(kXsdDate)),
                             Term::Literal("007", std::string(kXsdInteger)),
                             Term::Literal("+7.0", std::string(kXsdDecimal)),
                             Term::Literal("x", std::string(kXsdInteger))};
  for (const char* text :
       {"0", "-1", "7", "100", "576460752303423487", "-576460752303423488", "9223372036854775807"}) {
    terms.push_back(Term::Literal(text, std::string(kXsdInteger)));
    terms.push_back(Term::Literal(text, std::string(kXsdDecimal)));
    terms.push_back(Term::Literal(text, std::string(kXsdDouble)));
    terms.push_back(Term::Literal(text, std::string(kXsdFloat)));
  }
  for (const char* text :
       {"7.0", "7.00", "-0.0", "0.10", "0.1", "6.9999", "0.0000000000000000000000000000001",
        "-18014398509481984", "0.0000000000018014398509481984", "100.5"}) {
    terms.push_back(Term::Literal(text, std::string(kXsdDecimal)));
    terms.push_back(Term::Literal(text, std::string(kXsdDouble)));
    terms.push_back(Term::Literal(text, std::string(kXsdFloat)));
  }
  for (const char* text :
       {"NaN", "INF", "-INF", "-0.0E0", "1.0E-1", "7.0E0", "1.0E300", "0.12345678901234567"}) {
    terms.push_back(Term::Literal(text, std::string(kXsdDouble)));
  }
  int compared = 0;
  for (const Term& first : terms) {
    for (const Term& second : terms) {
      const TermId a = dictionary.Intern(first), b = dictionary.Intern(second);
      const Value x = Value::OfTerm(first), y = Value::OfTerm(second);
      SCOPED_TRACE(ToNTriples(first) + " " + ToNTriples(second));
      const auto sign = [](int order) { return (order > 0) - (order < 0); };
      if (const auto order = CompareForOrder(a, b, dictionary)) {
        EXPECT_EQ(sign(*order), sign(CompareForOrder(x, y)));
        ++compared;
      }
      bool unordered = false;
      const std::optional<int> expected = CompareValues(x, y, &unordered);
      if (const auto order = CompareExact(a, b)) {
        EXPECT_EQ(*order, expected.value() <=> 0);
      }
      const Number m = Number::Of(a), n = Number::Of(b);
      if (m.IsNone() || n.IsNone()) continue;
      const std::partial_ordering order = Compare(m, n);
      EXPECT_EQ(order == std::partial_ordering::unordered, unordered);
      if (expected) {
        EXPECT_EQ(order, *expected <=> 0);
      }
      EXPECT_EQ(order == 0, ValuesEqual(x, y).value());
    }
  }
  EXPECT_GT(compared, 1500);
}

TEST(Value, IntegersBeyond32BitsAreExact) {
  const Value sum = Compute(Arithmetic::kAdd, Of("2147483647", kXsdInteger), Value::Integer(1));
  EXPECT_EQ(Text(sum), "2147483648");
  EXPECT_EQ(Text(Compute(Arithmetic::kMultiply, Of("9223372036854775807", kXsdInteger), Value::Integer(10))),
            "92233720368547758070");
}

TEST(Value, NumbersArePromoted) {
  EXPECT_EQ(Compute(Arithmetic::kDivide, Value::Integer(6), Value::Integer(4)).type(), Value::Type::kDecimal);
  EXPECT_EQ(Text(Compute(Arithmetic::kDivide, Value::Integer(6), Value::Integer(4))), "1.5");
  EXPECT_EQ(Compute(Arithmetic::kAdd, Value::Integer(1), Of("1.5", kXsdFloat)).type(), Value::Type::kFloat);
  EXPECT_EQ(Compute(Arithmetic::kAdd, Of("1.5", kXsdFloat), Of("1.5", kXsdDouble)).type(),
            Value::Type::kDouble);
  EXPECT_TRUE(Compute(Arithmetic::kDivide, Value::Integer(1), Value::Integer(0)).IsError());
  EXPECT_EQ(Text(Compute(Arithmetic::kDivide, Value::Double(1), Value::Integer(0))), "INF");
  EXPECT_TRUE(Compute(Arithmetic::kAdd, Value::Integer(1), Value::String("1")).IsError());
}

TEST(Value, EffectiveBooleanValue) {
  EXPECT_EQ(EffectiveBooleanValue(Value::String("")), false);
  EXPECT_EQ(EffectiveBooleanValue(Value::String("false")), true);
  EXPECT_EQ(EffectiveBooleanValue(Value::Integer(0)), false);
  EXPECT_EQ(EffectiveBooleanValue(Of("NaN", kXsdDouble)), false);
  EXPECT_EQ(EffectiveBooleanValue(Of("zzz", kXsdInteger)), false);  // invalid form of a number
  // Of more digits than there are values for, it is unknown.
  EXPECT_EQ(EffectiveBooleanValue(Of("100000000000000000000000000000000000000", kXsdInteger)), std::nullopt);
  EXPECT_EQ(EffectiveBooleanValue(Of("0.1000000000000000000000000000000000000001", kXsdDecimal)),
            std::nullopt);
  EXPECT_EQ(EffectiveBooleanValue(Of("1000000000000000000000000000000000000000.5", kXsdInteger)), false);
  EXPECT_EQ(EffectiveBooleanValue(Value::Iri("http://a/")), std::nullopt);
  EXPECT_EQ(EffectiveBooleanValue(Of("x", "http://a/type")), std::nullopt);
}

TEST(Value, IntegersOf38DigitsAreNumbers) {
  const std::string most(38, '9');
  for (const std::string& text : {most, "-" + most, std::string("42535295865117307932921825928971026433")}) {
    EXPECT_EQ(Of(text, kXsdInteger).type(), Value::Type::kInteger) << text;
    EXPECT_EQ(Text(*Cast(kXsdInteger, Value::String(text))), text);
    EXPECT_EQ(Text(*Cast(kXsdDecimal, Of(text, kXsdInteger))), text);
    EXPECT_EQ(Text(*Cast(kXsdInteger, Of(text + ".0", kXsdDecimal))), text);
    EXPECT_EQ(Text(Compute(Arithmetic::kAdd, Of(text, kXsdInteger), Value::Integer(0))), text);
  }
  EXPECT_EQ(Of(most, std::string(kXsdNs) + "positiveInteger").type(), Value::Type::kInteger);
  for (const std::string& text : {"1" + std::string(38, '0'), "-1" + std::string(38, '0')}) {
    EXPECT_EQ(Of(text, kXsdInteger).type(), Value::Type::kOther);
    EXPECT_EQ(Of(text, kXsdDecimal).type(), Value::Type::kOther);
    EXPECT_TRUE(Cast(kXsdInteger, Value::String(text))->IsError());
  }
  EXPECT_EQ(Text(*Cast(kXsdInteger, Of("9e37", kXsdDouble))).size(), 38u);
  EXPECT_TRUE(Cast(kXsdInteger, Of("1.1e38", kXsdDouble))->IsError());
}

// XML Schema 1.1 part 2, section D.3.1 (yearFrag).
TEST(Value, AYearOfMoreThanFourDigitsHasNoLeadingZero) {
  for (const char* good : {"0000-01-01", "0012-01-01", "-0012-01-01", "12000-01-01", "-12000-01-01"})
    EXPECT_EQ(Of(good, kXsdDate).type(), Value::Type::kDate) << good;
  for (const char* bad : {"00012-01-01", "02000-01-01", "-02000-01-01", "002000-01-01", "000-01-01"}) {
    EXPECT_EQ(Of(bad, kXsdDate).type(), Value::Type::kOther) << bad;
    EXPECT_EQ(Of(bad + "T00:00:00Z"s, kXsdDateTime).type(), Value::Type::kOther) << bad;
    EXPECT_TRUE(Cast(kXsdDate, Value::String(bad))->IsError()) << bad;
  }
}

TEST(Value, EqualityKnowsWhatItDoesNotKnow) {
  EXPECT_EQ(ValuesEqual(Value::Integer(1), Of("1.0", kXsdDecimal)), true);
  EXPECT_EQ(ValuesEqual(Of("x", "http://a/t"), Of("x", "http://a/t")), true);
  EXPECT_EQ(ValuesEqual(Of("x", "http://a/t"), Of("y", "http://a/t")), std::nullopt);
  EXPECT_EQ(ValuesEqual(Value::Iri("http://a/"), Value::String("http://a/")), false);
  EXPECT_EQ(ValuesEqual(Value::LangString("a", "en"), Value::LangString("a", "EN")), true);
  EXPECT_EQ(ValuesEqual(Of("NaN", kXsdDouble), Of("NaN", kXsdDouble)), false);
  EXPECT_EQ(ValuesEqual(Value::Error(), Value::Integer(1)), std::nullopt);
}

TEST(Value, TimesCompareAsInstants) {
  const Value noon = Of("2026-05-01T12:00:00Z", kXsdDateTime),
              zoned = Of("2026-05-01T14:00:00+02:00", kXsdDateTime);
  EXPECT_EQ(ValuesEqual(noon, zoned), true);
  bool unordered = false;
  EXPECT_LT(*CompareValues(noon, Of("2026-05-01T12:00:00.001Z", kXsdDateTime), &unordered), 0);
  EXPECT_EQ(CompareValues(noon, Of("2026-05-01T12:00:00", kXsdDateTime), &unordered),
            std::nullopt);  // within 14 hours
  EXPECT_LT(*CompareValues(noon, Of("2026-05-03T12:00:00", kXsdDateTime), &unordered), 0);
  for (const char* bad :
       {"2026-13-01T00:00:00", "2026-02-29T00:00:00", "2026-01-01T25:00:00", "2026-01-01", "x"}) {
    EXPECT_EQ(Of(bad, kXsdDateTime).type(), Value::Type::kOther) << bad;
  }
}

TEST(Value, Casts) {
  EXPECT_EQ(Text(*Cast(kXsdInteger, Value::String(" 42 "))), "42");
  EXPECT_EQ(Text(*Cast(kXsdInteger, Of("-3.7", kXsdDecimal))), "-3");
  EXPECT_EQ(Text(*Cast(kXsdString, Of("1.50E1", kXsdDouble))), "15");
  EXPECT_EQ(Text(*Cast(kXsdBoolean, Value::Integer(0))), "false");
  EXPECT_TRUE(Cast(kXsdInteger, Value::String("4x"))->IsError());
  EXPECT_TRUE(Cast(kXsdDecimal, Of("NaN", kXsdDouble))->IsError());
  EXPECT_FALSE(Cast("http://a/t", Value::Integer(1)).has_value());
}

TEST(Value, CastsOfDoublesWriteNoDigitsThatNobodyWrote) {
  const auto text = [](const std::string& number, std::string_view type, std::string_view to) {
    return Text(*Cast(to, Of(number, type)));
  };
  for (const auto& [number, string, decimal] :
       {std::tuple{"91584.696e0", "91584.696", "91584.696"},
        {"0.1e0", "0.1", "0.1"},
        {"-0e0", "-0", "0"},
        {"0e0", "0", "0"},
        {"1e-6", "0.000001", "0.000001"},
        {"9.99e-7", "9.99E-7", "0.000000999"},
        {"999999.5e0", "999999.5", "999999.5"},
        {"-1e6", "-1.0E6", "-1000000"},
        {"1.5e300", "1.5E300", "error"},
        {"NaN", "NaN", "error"},
        {"-INF", "-INF", "error"},
        {"1.2345678901234567e-20", "1.2345678901234567E-20", "0.000000000000000000012345678901234567"}}) {
    EXPECT_EQ(text(number, kXsdDouble, kXsdString), string);
    EXPECT_EQ(text(number, kXsdDouble, kXsdDecimal), decimal) << number;
  }
  EXPECT_EQ(text("0.1", kXsdFloat, kXsdString), "0.1");
  EXPECT_EQ(text("16777.217", kXsdFloat, kXsdDecimal), "16777.217");
  EXPECT_EQ(text("-3.9e0", kXsdDouble, kXsdInteger), "-3");
}

TEST(Value, TermOrderIsTotalAndByValue) {
  const std::vector<Term> ordered = {Term::Blank("b"),
                                     Term::Iri("http://a/"),
                                     Term::Integer(2),
                                     Term::Literal("10", std::string(kXsdInteger)),
                                     Term::Literal("10.0", std::string(kXsdDecimal)),
                                     Term::Literal("a"),
                                     Term::Literal("b"),
                                     Term::LangString("a", "en")};
  for (size_t i = 0; i < ordered.size(); ++i) {
    for (size_t k = 0; k < ordered.size(); ++k) {
      const int order = CompareTerms(ordered[i], ordered[k]);
      EXPECT_EQ(order < 0, i < k) << i << " " << k;
      EXPECT_EQ(order == 0, i == k) << i << " " << k;
    }
  }
}

}  // namespace
}  // namespace docent::sparql
