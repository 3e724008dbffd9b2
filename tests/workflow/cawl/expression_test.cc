#include "workflow/cawl/expression.h"

#include <gtest/gtest.h>

#include <set>

namespace docent::cawl {
namespace {

std::optional<Expression> Parse(const std::string& text) {
  xml::ElementReader reader(text, "f", "");
  xml::Text value{text, reader.Span(0, text.size())};
  return ParseExpression(value, 100, &reader);
}

TEST(Expression, PrecedenceAndAssociation) {
  EXPECT_EQ(ToText(*Parse("a or b and not c")), "a or b and not c");
  EXPECT_EQ(ToText(*Parse("(a or b) and not (c and d)")), "(a or b) and not (c and d)");
  EXPECT_EQ(ToText(*Parse("((a)) AND (b and c)")), "a and b and c");
  EXPECT_EQ(ToText(*Parse("not not a")), "not not a");
  EXPECT_EQ(Parse("a or b and c")->kind, Expression::Kind::kOr);
  EXPECT_EQ(Parse("not a and b")->kind, Expression::Kind::kAnd);
}

// Every assignment of four names, against C++'s own operators.
TEST(Expression, ValuesAgreeWithTheTruthTable) {
  std::optional<Expression> e = Parse("a and not b or (c or a) and d");
  ASSERT_TRUE(e);
  for (int bits = 0; bits < 16; ++bits) {
    bool a = bits & 1, b = bits & 2, c = bits & 4, d = bits & 8;
    auto value = [&](const std::string& n) { return n == "a" ? a : n == "b" ? b : n == "c" ? c : d; };
    EXPECT_EQ(Evaluate(*e, value), (a && !b) || ((c || a) && d)) << bits;
  }
}

TEST(Expression, NamesKnowTheirPlace) {
  std::optional<Expression> e = Parse("near and (not busy)");
  std::vector<const Expression*> names = NamesIn(*e);
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[1]->name, "busy");
  EXPECT_EQ(names[1]->span.offset, 14u);
  EXPECT_EQ(names[1]->span.length, 4u);
}

TEST(Expression, OtherNamesStandInQuotes) {
  std::optional<Expression> e = Parse("'Tour A' and not 'and' or ('it\\'s' and 'a\\\\b') and plain'quote");
  ASSERT_TRUE(e);
  std::vector<std::string> names;
  for (const Expression* name : NamesIn(*e)) names.push_back(name->name);
  EXPECT_EQ(names, (std::vector<std::string>{"Tour A", "and", "it's", "a\\b", "plain'quote"}));
  EXPECT_EQ(ToText(*e), "'Tour A' and not 'and' or it's and a\\b and plain'quote");
  EXPECT_EQ(ToText(*Parse(ToText(*e))), ToText(*e));
  EXPECT_EQ(ToText(*Parse("'plain'")), "plain");
  for (const char* bad : {"'open", "'a\\'", "'a''b'", "'"}) EXPECT_FALSE(Parse(bad)) << bad;
}

TEST(Expression, MalformedOnesAreRefused) {
  for (const char* bad : {"", "and", "a and", "a b", "(a", "a)", "()", "not", "a or or b", "not and a"}) {
    EXPECT_FALSE(Parse(bad)) << bad;
  }
}

}  // namespace
}  // namespace docent::cawl
