#include "reasoner/matching/comparison_form.h"

#include <gtest/gtest.h>

#include "graph/sparql/syntax/parser.h"

namespace docent::matching {
namespace {

// "?x >= 3", or "" if it is no comparison with a number.
std::string Read(const std::string& filter) {
  const sparql::ParsedQuery parsed =
      sparql::ParseQuery("ASK { ?x ?p ?y FILTER(" + filter + ") }", sparql::ParseOptionsWith({}, nullptr));
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, filter);
  const auto read = ReadNumberComparison(*parsed.query.algebra->expression);
  if (!read) return "";
  const char* ops[] = {" < ", " <= ", " > ", " >= "};
  return "?" + read->variable->name + (read->op ? ops[static_cast<int>(*read->op)] : " = ") +
         read->number->lexical;
}

TEST(ComparisonForm, IsReadEitherWayRound) {
  EXPECT_EQ(Read("?x >= 3"), "?x >= 3");
  EXPECT_EQ(Read("3 >= ?x"), "?x <= 3");
  EXPECT_EQ(Read("2.5 < ?y"), "?y > 2.5");
  EXPECT_EQ(Read("?x = 1"), "?x = 1");
  EXPECT_EQ(Read("1 = ?x"), "?x = 1");
}

TEST(ComparisonForm, OnlyWithANumberThatFitsIntoAnId) {
  for (const char* filter :
       {"?x != 1", "?x > ?y", "?x > \"a\"", "STRLEN(?x) > 1", "?x > \"1.5\"^^xsd:float",
        "?x > \"NaN\"^^xsd:double", "?x > \"01\"^^xsd:integer", "1 < 2", "BOUND(?x)", "?x IN (1, 2)"}) {
    EXPECT_EQ(Read(filter), "") << filter;
  }
}

}  // namespace
}  // namespace docent::matching
