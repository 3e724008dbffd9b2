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

TEST(SparqlEvaluatorGroups, AStringMayHoldTheCharacterZero) {
  TestGraph g("");
  EXPECT_THAT(g.Rows("SELECT (STRLEN(\"a\\u0000b\") AS ?n) {}"), ElementsAre("3"));
}

}  // namespace
}  // namespace docent::sparql
