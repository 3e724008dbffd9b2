// Arithmetic, comparison and casts of times and durations in queries.
#include <gmock/gmock.h>

#include "graph/sparql/values/duration.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

using testing::ElementsAre;

// Of "PT1H/dayTime" a literal of xsd:dayTimeDuration and so on.
std::string Expand(const std::string& expression) {
  static constexpr std::pair<const char*, const char*> kTypes[] = {{"/DT", "^^xsd:dateTime"},
                                                                   {"/D", "^^xsd:date"},
                                                                   {"/T", "^^xsd:time"},
                                                                   {"/d", "^^xsd:dayTimeDuration"},
                                                                   {"/m", "^^xsd:yearMonthDuration"},
                                                                   {"/x", "^^xsd:duration"}};
  std::string out = expression;
  for (const auto& [tag, type] : kTypes) {
    for (size_t at; (at = out.find(std::string("'") + tag)) != std::string::npos;)
      out.replace(at + 1, std::strlen(tag), type);
  }
  return out;
}

// The value's text and the local name of its type; "-" if it has none.
std::string Of(const std::string& expression) {
  static const TestGraph* const graph = new TestGraph;
  const std::string text = Expand(expression);
  const auto rows =
      graph->Rows("SELECT (STR(" + text + ") AS ?v) (STRAFTER(STR(DATATYPE(" + text + ")), '#') AS ?t) {}");
  return rows.empty() ? "no row" : rows[0];
}

struct Case {
  const char* expression;
  const char* value;
};

void Expect(std::initializer_list<Case> cases) {
  for (const auto& [expression, value] : cases) {
    const std::string got = Of(expression);
    EXPECT_EQ(got.substr(0, got.find(' ')), value) << expression << " gives " << got;
  }
}

TEST(SparqlTimes, TypesOfResults) {
  EXPECT_EQ(Of("'2026-05-01T12:00:00Z'/DT - '2026-04-30T11:00:00Z'/DT"), "P1DT1H dayTimeDuration");
  EXPECT_EQ(Of("'2026-05-01T12:00:00Z'/DT - 'PT5M'/d"), "2026-05-01T11:55:00Z dateTime");
  EXPECT_EQ(Of("'2026-05-01'/D + 'P1M'/m"), "2026-06-01 date");
  EXPECT_EQ(Of("'P1Y'/m / 'P1M'/m"), "12 decimal");
  EXPECT_EQ(Of("'PT1H'/d + 'P1M'/m"), "P1MT1H duration");
  EXPECT_EQ(Of("xsd:byte('12')"), "12 byte");
  EXPECT_EQ(Of("TIMEZONE('2026-05-01T12:00:00-05:30'/DT)"), "-PT5H30M dayTimeDuration");
}

// The examples of XPath and XQuery Functions 3.1, sections 8.4, 9.7 and 9.8.
TEST(SparqlTimes, Arithmetic) {
  Expect({{"'2000-10-30T06:12:00-05:00'/DT - '1999-11-28T09:00:00Z'/DT", "P337DT2H12M"},
          {"'2000-10-30'/D - '1999-11-28'/D", "P337D"},
          {"'2000-10-30+05:00'/D - '1999-11-28Z'/D", "P336DT19H"},
          {"'2000-10-15-05:00'/D - '2000-10-10+02:00'/D", "P5DT7H"},
          {"'11:12:00Z'/T - '04:00:00Z'/T", "PT7H12M"},
          {"'11:00:00-05:00'/T - '21:30:00+05:30'/T", "PT0S"},
          {"'2000-10-30T11:12:00'/DT + 'P1Y2M'/m", "2001-12-30T11:12:00"},
          {"'2000-10-30T11:12:00'/DT + 'P3DT1H15M'/d", "2000-11-02T12:27:00"},
          {"'P3DT1H15M'/d + '2000-10-30T11:12:00'/DT", "2000-11-02T12:27:00"},
          {"'2000-10-30T11:12:00'/DT - 'P1Y2M'/m", "1999-08-30T11:12:00"},
          {"'2000-10-30Z'/D + 'P2DT2H30M0S'/d", "2000-11-01Z"},
          {"'2000-10-30'/D - 'P3DT1H15M'/d", "2000-10-26"},
          {"'2000-02-29Z'/D - 'P1Y'/m", "1999-02-28Z"},
          {"'2000-10-31-05:00'/D - 'P1Y1M'/m", "1999-09-30-05:00"},
          {"'2024-01-31'/D + 'P1M'/m", "2024-02-29"},
          {"'2026-01-31'/D + 'P1M'/m", "2026-02-28"},
          {"'1900-01-31'/D + 'P1M'/m", "1900-02-28"},
          {"'2024-01-31T10:00:00Z'/DT + 'P1M1DT2H'/x", "2024-03-01T12:00:00Z"},
          {"'11:12:00'/T + 'P3DT1H15M'/d", "12:27:00"},
          {"'23:12:00+03:00'/T + 'P1DT3H15M'/d", "02:27:00+03:00"},
          {"'08:20:00-05:00'/T - 'P23DT10H10M'/d", "22:10:00-05:00"},
          {"'P2Y11M'/m + 'P3Y3M'/m", "P6Y2M"},
          {"'P2Y11M'/m - 'P3Y3M'/m", "-P4M"},
          {"'P2Y11M'/m * 2.3", "P6Y9M"},
          {"2.3e0 * 'P2Y11M'/m", "P6Y9M"},
          {"'P2Y11M'/m / 1.5", "P1Y11M"},
          {"'-P1M'/m / 2", "P0M"},
          {"'P3Y4M'/m / '-P1Y4M'/m", "-2.5"},
          {"'P2DT12H5M'/d + 'P5DT12H'/d", "P8DT5M"},
          {"'PT2H10M'/d * 2.1", "PT4H33M"},
          {"'P1DT2H30M10.5S'/d / 1.5", "PT17H40M7S"},
          {"'P2DT53M11S'/d / 'P1DT10H'/d", "1.437834967320261437"},
          {"'PT1H'/x - 'PT30M'/d", "PT30M"},
          {"STR('PT1H'/d + 'PT0.000001S'/d)", "PT1H0.000001S"}});
}

TEST(SparqlTimes, WhatHasNoMeaningHasNoValue) {
  for (const char* none : {"'2026-05-01'/D - '2026-05-01T00:00:00'/DT",
                           "'2026-05-01'/D + 1",
                           "'PT1H'/d * 'PT1H'/d",
                           "'PT1H'/d / 0",
                           "'PT1H'/d / 0e0",
                           "'PT1H'/d * 'NaN'^^xsd:double",
                           "'PT1H'/d * 1e300",
                           "'P1MT1S'/x * 2",
                           "'P1M'/m / 'PT1S'/d",
                           "'P1M'/m - 'PT1S'/d",
                           "'11:00:00'/T + 'P1M'/m",
                           "'PT1H'/d - '11:00:00'/T",
                           "'PT1H'/d + 1",
                           "1 / 'PT1H'/d",
                           "'200000-01-01T00:00:00'/DT + 'P1Y'/m",
                           "'P9000000000000000000M'/m + 'P9000000000000000000M'/m",
                           "'2026-01-01'/D + 'P900000000000M'/m",
                           "'PT1H'/m + 'P1M'/m",
                           "'PT1H'/d < 'P1M'/m",
                           "'P30D'/x < 'P1M'/x",
                           "xsd:date('10:00:00'/T)",
                           "xsd:time('2026-01-01'/D)",
                           "xsd:byte('128')",
                           "xsd:unsignedInt(-1)",
                           "xsd:nonNegativeInteger('-1')",
                           "xsd:int('x')",
                           "xsd:dayTimeDuration('P1M')",
                           "xsd:dayTimeDuration('1')",
                           "xsd:yearMonthDuration('PT1S')",
                           "xsd:duration('P')",
                           "xsd:duration('PT')",
                           "xsd:duration('P1H')",
                           "xsd:duration('P1M1Y')",
                           "xsd:duration('P1.5D')",
                           "xsd:duration('PT1.S')",
                           "xsd:date(5)",
                           "xsd:duration(5)",
                           "xsd:dayTimeDuration('P99999999999999999999D')"}) {
    EXPECT_EQ(Of(none), "- -") << none;
  }
}

TEST(SparqlTimes, Comparison) {
  Expect({{"'PT60M'/d = 'PT1H'/d", "true"},
          {"'P1Y'/m = 'P12M'/m", "true"},
          {"'P1Y'/x = 'P12M'/m", "true"},
          {"'PT0S'/d = 'P0M'/m", "true"},
          {"'PT1H'/d = 'P1M'/m", "false"},
          {"'PT59M'/d < 'PT1H'/d", "true"},
          {"'-P1D'/d < 'PT0S'/d", "true"},
          {"'P11M'/m >= 'P1Y'/m", "false"},
          {"'PT1H'/x > 'PT59M'/d", "true"},
          {"'08:00:00+09:00'/T = '17:00:00-06:00'/T", "false"},
          {"'24:00:00'/T = '00:00:00'/T", "true"},
          {"'11:00:00-05:00'/T < '17:00:00Z'/T", "true"},
          {"'2004-12-25Z'/D < '2004-12-25-05:00'/D", "true"},
          {"'2026-05-01'/D > '2026-04-30'/D", "true"},
          {"'2026-05-01T10:00:00Z'/DT > NOW() - 'PT5M'/d", "true"},
          {"NOW() - NOW() = 'PT0S'/d", "true"}});
}

TEST(SparqlTimes, Casts) {
  Expect({{"xsd:date('2026-05-01T23:00:00-05:00'/DT)", "2026-05-01-05:00"},
          {"xsd:dateTime('2026-05-01Z'/D)", "2026-05-01T00:00:00Z"},
          {"xsd:time('2026-05-01T23:00:00.5-05:00'/DT)", "23:00:00.5-05:00"},
          {"xsd:time(' 10:00:00Z ')", "10:00:00Z"},
          {"xsd:date('1969-12-31T23:00:00'/DT)", "1969-12-31"},
          {"xsd:dayTimeDuration('PT90M')", "PT1H30M"},
          {"xsd:dayTimeDuration('P1Y2DT3H'/x)", "P2DT3H"},
          {"xsd:yearMonthDuration('P1Y2DT3H'/x)", "P1Y"},
          {"xsd:duration('P14M'/m)", "P1Y2M"},
          {"xsd:string('PT90M'/d + 'PT0S'/d)", "PT1H30M"},
          {"xsd:int('2147483647')", "2147483647"},
          {"xsd:long(12.9)", "12"},
          {"xsd:short(' -7 ')", "-7"},
          {"xsd:unsignedByte(true)", "1"},
          {"xsd:nonNegativeInteger(3e0)", "3"},
          {"xsd:byte(5) + 1", "6"},
          {"HOURS('10:20:30'/T)", "10"}});
}

TEST(SparqlTimes, OrderAndAggregates) {
  const TestGraph graph(
      "ex:a ex:d 'PT2H'^^xsd:dayTimeDuration . ex:b ex:d 'PT90M'^^xsd:dayTimeDuration . ex:c ex:d "
      "'P1D'^^xsd:dayTimeDuration ; "
      "ex:t '09:00:00Z'^^xsd:time . ex:d ex:d 'P1M'^^xsd:yearMonthDuration ; ex:t '10:00:00+03:00'^^xsd:time "
      ".");
  EXPECT_THAT(graph.Rows("SELECT ?x { ?x ex:d ?d } ORDER BY ?d", {}, true), ElementsAre("b", "a", "c", "d"));
  EXPECT_THAT(graph.Rows("SELECT (MIN(?d) AS ?a) (MAX(?d) AS ?b) { ?x ex:d ?d }"), ElementsAre("PT90M P1M"));
  EXPECT_THAT(graph.Rows("SELECT (MIN(?t) AS ?a) { ?x ex:t ?t }"), ElementsAre("10:00:00+03:00"));
  EXPECT_THAT(graph.Rows("SELECT ?x { ?x ex:d ?d FILTER(?d <= 'PT120M'^^xsd:dayTimeDuration) }"),
              ElementsAre("a", "b"));
  EXPECT_THAT(graph.Rows("SELECT ?x { ?x ex:d ?d FILTER(?d = 'PT120M'^^xsd:dayTimeDuration) }"),
              ElementsAre("a"));
}

TEST(SparqlTimes, FractionsBeyondTheMicrosecondAreCompared) {
  Expect({{"'12:34:56.1234567891'/T = '12:34:56.123456789'/T", "false"},
          {"'12:34:56.1234567891'/T > '12:34:56.123456789'/T", "true"},
          {"'12:34:56.1234567890'/T = '12:34:56.123456789'/T", "true"},
          {"'2026-01-01T12:34:56.1234567891Z'/DT > '2026-01-01T14:34:56.123456789+02:00'/DT", "true"},
          {"'2026-01-01T12:34:56.123456Z'/DT = '2026-01-01T12:34:56.1234560Z'/DT", "true"},
          {"'2026-01-01T12:34:56.1234561Z'/DT > '2026-01-01T12:34:56.123456Z'/DT", "true"}});
}

}  // namespace
}  // namespace docent::sparql
