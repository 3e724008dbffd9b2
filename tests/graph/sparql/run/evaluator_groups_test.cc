#include <gmock/gmock.h>

#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

using testing::ElementsAre;

TEST(SparqlEvaluatorGroups, HavingAndOrderByTakeAnyValueOfTheirGroup) {
  TestGraph g("");
  EXPECT_THAT(
      g.Rows("SELECT ?s { VALUES (?s ?o) { (2 20) (1 10) (2 20) (3 5) } } GROUP BY ?s ORDER BY ?o", {}, true),
      ElementsAre("3", "1", "2"));
  EXPECT_THAT(
      g.Rows("SELECT ?s { VALUES (?s ?o) { (2 20) (1 10) (3 5) } } GROUP BY ?s HAVING (?o > 5) ORDER BY ?s"),
      ElementsAre("1", "2"));
  EXPECT_THAT(g.Rows("SELECT (COUNT(*) AS ?n) { VALUES ?o { 1 2 } } ORDER BY (?o + 1)"), ElementsAre("2"));
}

// Rules take a total back by computing it again, from rows in another order.
TEST(SparqlEvaluatorGroups, ASumBeyond38DigitsOnTheWayIsTheSameInEveryOrder) {
  TestGraph g("");
  const std::string most(38, '9');
  const std::string a = most, b = "60000000000000000000000000000000000000", c = "-" + most;
  for (const std::string& rows :
       {a + " " + b + " " + c + " 1.5 7", c + " 7 1.5 " + b + " " + a, b + " " + a + " 7 " + c + " 1.5"}) {
    EXPECT_THAT(g.Rows("SELECT (SUM(?n) - 60000000000000000000000000000000000000 AS ?x) { VALUES ?n { " +
                       rows + " 0.5 } }"),
                ElementsAre("9"))
        << rows;
  }
  EXPECT_THAT(g.Rows("SELECT (SUM(?n) AS ?x) { VALUES ?n { " + a + " 1 } }"), ElementsAre("-"));
  EXPECT_THAT(g.Rows("SELECT (SUM(?n) AS ?x) { VALUES ?n { " + a + " 1 -1 } }"), ElementsAre(most));
}

TEST(SparqlEvaluatorGroups, AStringMayHoldTheCharacterZero) {
  TestGraph g("");
  EXPECT_THAT(g.Rows("SELECT (STRLEN(\"a\\u0000b\") AS ?n) {}"), ElementsAre("3"));
}

}  // namespace
}  // namespace docent::sparql
