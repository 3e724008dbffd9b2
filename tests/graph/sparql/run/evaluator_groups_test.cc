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

// Sections 18.3.1 and 18.5.1: a solution has the variables of the query alone, not those that stand for the
// blank nodes of a pattern and for the middle of a path.
TEST(SparqlEvaluatorGroups, CountDistinctOfAllTakesTheVariablesOfTheQueryAlone) {
  TestGraph g(
      "ex:x ex:p ex:y , ex:z . ex:y ex:q ex:w . ex:z ex:q ex:w , ex:v . GRAPH ex:g { ex:x ex:p ex:y , ex:z . "
      "ex:y ex:q ex:w . ex:z ex:q ex:w }");
  const auto count = [&](const std::string& where) {
    return g.Rows("SELECT (COUNT(DISTINCT *) AS ?n) " + where);
  };
  for (const char* one :
       {"{ ex:x ex:p [] }", "{ _:b ex:p _:c }", "{ ex:x ex:p [ ex:q ex:w ] }",
        "{ ex:x (ex:none|(ex:p/ex:q)) ex:w }", "{ ex:x ex:p/ex:q ex:w }",
        "{ ?d ^ex:q/^ex:p ex:x FILTER(?d = ex:w) }",
        "{ ex:x (ex:p/ex:q)|(ex:p/ex:q/^ex:q/ex:q) ?d FILTER(?d = ex:w) }",
        "{ { SELECT * { ex:x ex:p [] } } }", "{ GRAPH ex:g { ex:x ex:p _:y } }",
        "{ GRAPH ex:g { ex:x ex:p/ex:q ?d } }", "{ ex:x ex:p [] OPTIONAL { ex:x ex:p/ex:q [] } }",
        "{ { ex:x ex:p [] } UNION { ex:x ex:p/ex:q [] } }",
        "{ ?x ex:p [] FILTER EXISTS { ?x ex:p/ex:q ?y } }", "{ ?x ex:p [] MINUS { ?y ex:p [] } }",
        "{ ?x ex:p [] } GROUP BY ?x HAVING (COUNT(DISTINCT *) < 2)", "{ BIND(1 AS ?i) ex:x ex:p [] }"}) {
    EXPECT_THAT(count(one), ElementsAre("1")) << one;
  }
  EXPECT_THAT(count("{ ex:x ex:p ?y }"), ElementsAre("2"));
  EXPECT_THAT(count("{ ex:x ex:p/ex:q ?d }"), ElementsAre("2"));
  EXPECT_THAT(count("{ ex:x ex:p [ ex:q ?d ] } GROUP BY ?d ORDER BY ?d"), ElementsAre("1", "1"));
  EXPECT_THAT(count("{ ex:x ex:none [] }"), ElementsAre("0"));
  EXPECT_THAT(g.Rows("SELECT (COUNT(*) AS ?n) { ex:x ex:p/ex:q ex:w }"), ElementsAre("2"))
      << "each way is a solution";
  EXPECT_THAT(
      g.Rows("SELECT ?d (COUNT(DISTINCT *) AS ?n) (COUNT(*) AS ?all) { [] ex:q ?d } GROUP BY ?d ORDER BY ?d"),
      ElementsAre("v 1 1", "w 1 2"));
  EXPECT_THAT(g.Rows("SELECT DISTINCT * { ex:x ex:p/ex:q ?d } ORDER BY ?d"), ElementsAre("v", "w"));
}

TEST(SparqlEvaluatorGroups, AStringMayHoldTheCharacterZero) {
  TestGraph g("");
  EXPECT_THAT(g.Rows("SELECT (STRLEN(\"a\\u0000b\") AS ?n) {}"), ElementsAre("3"));
}

}  // namespace
}  // namespace docent::sparql
