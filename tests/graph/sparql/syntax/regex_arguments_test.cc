#include "graph/sparql/syntax/regex_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "graph/sparql/syntax/parser.h"

namespace docent::sparql {
namespace {

using testing::HasSubstr;

Diagnostics MistakesOf(const std::string& expression) {
  return ParseExpression(expression).diagnostics;
}

TEST(RegexArguments, WhatCanBeEvaluatedIsTaken) {
  for (const char* const expression :
       {R"(REGEX(?x, "^[a-z-[aeiou]]+$"))", R"(REGEX(?x, "a b", "x"))", R"(REGEX(?x, "(", "q"))",
        R"(REGEX(?x, ?p))", R"(REGEX(?x, "(", ?flags))", R"(REGEX(?x, CONCAT("(", ?p)))",
        R"(REPLACE(?x, "(a)\\1", "$1\\$\\\\"))", R"(REPLACE(?x, "a", "$", "q"))",
        R"(REPLACE(?x, "a", "$", ?flags))", R"(REPLACE(?x, "a*b", ?r))",
        R"(REGEX("a"@en, "a"^^<http://www.w3.org/2001/XMLSchema#string>))", R"(REGEX(?x, ""))"}) {
    EXPECT_TRUE(MistakesOf(expression).empty()) << expression << Render(MistakesOf(expression), expression);
  }
}

struct Case {
  const char* expression;
  const char* message;
  int column;
};

TEST(RegexArguments, AMistakeIsShownAtItsPlaceInTheString) {
  for (const Case& c : std::vector<Case>{
           {R"(REGEX(?x, "ab(?i)c"))", "the pattern of REGEX cannot be evaluated: '(?i' is not a group", 14},
           {R"(REGEX(?x, "\\d\\b"))", "'\\b' is not an escape", 15},
           {R"(REGEX(?x, "\\d\u00E9\U0001F600\\b"))", "'\\b' is not an escape", 31},
           {R"(REGEX(?x, '''a'b\\A'''))", "'\\A' is not an escape", 17},
           {R"(REGEX(?x, "[[:alpha:]]"))", "'[' inside a class", 13},
           {R"(REGEX(?x, "a", "iz"))", "the flags of REGEX cannot be evaluated: 'z' is not a flag", 18},
           {R"(REGEX(?x, ?p, "z"))", "'z' is not a flag", 16},
           {R"(REPLACE(?x, "a", "b$"))",
            "the replacement of REPLACE cannot be evaluated: '$' must be followed by a digit", 20},
           {R"(REPLACE(?x, "a", "\\n"))", "a backslash must be followed", 19},
           {R"(REPLACE(?x, ?p, "$a"))", "'$' must be followed by a digit", 18},
           {R"(REPLACE(?x, "a*", "b"))", "matches the empty string", 13},
           {R"(REPLACE(?x, "^|a", "b"))", "matches the empty string", 13},
           {R"(REPLACE(?x, "(a)?\\1", "b"))", "matches the empty string", 13},
           {R"(REPLACE(?x, "", "b", "q"))", "matches the empty string", 13},
           {R"(REGEX(?x, "a"@en))", "the pattern of REGEX is a string without a language, not \"a\"@en", 11},
           {R"(REGEX(?x, 5))", "the pattern of REGEX is a string", 11},
           {R"(REGEX(?x, <http://e/a>))", "the pattern of REGEX is a string", 11},
           {R"(REGEX(?x, "a", 1))", "the flags of REGEX is a string", 16},
           {R"(REPLACE(?x, "a", 1))", "the replacement of REPLACE is a string", 18},
           {R"(COALESCE(REGEX(?x, "("), false))", "the group that begins here is not closed", 21},
       }) {
    const Diagnostics found = MistakesOf(c.expression);
    ASSERT_EQ(found.size(), 1u) << c.expression;
    EXPECT_THAT(found[0].message, HasSubstr(c.message)) << c.expression;
    EXPECT_EQ(found[0].span.column, c.column) << c.expression;
    EXPECT_EQ(found[0].span.line, 1) << c.expression;
  }
}

TEST(RegexArguments, EveryPartOfAQueryIsLookedAt) {
  const std::string bad = R"(REGEX(?x, "("))", p = "?s <http://e/p> ?x ";
  for (const std::string& query :
       {"SELECT * {" + p + "FILTER " + bad + "}", "SELECT (" + bad + " AS ?y) {" + p + "}",
        "SELECT * {" + p + "BIND(" + bad + " AS ?y) }", "SELECT * {" + p + "} ORDER BY " + bad,
        "SELECT (COUNT(*) AS ?n) {" + p + "} GROUP BY (" + bad + " AS ?k)",
        "SELECT (SUM(IF(" + bad + ", 1, 2)) AS ?n) {" + p + "}",
        "SELECT ?s {" + p + "} GROUP BY ?s HAVING " + bad,
        "SELECT * {" + p + "OPTIONAL { FILTER " + bad + "} }",
        "SELECT * {" + p + "FILTER EXISTS { FILTER " + bad + "} }",
        "ASK { { SELECT * {" + p + "FILTER " + bad + "} } }", "CONSTRUCT WHERE {" + p + "} HAVING " + bad,
        "DESCRIBE ?s {" + p + "MINUS {" + p + "FILTER(!" + bad + ")} }"}) {
    EXPECT_FALSE(ParseQuery(query).ok()) << query;
  }
  EXPECT_FALSE(ParseUpdate("DELETE {" + p + "} WHERE {" + p + "FILTER " + bad + "}").ok());
  const ParsedQuery two = ParseQuery("ASK {" + p + "FILTER " + bad + " FILTER " + bad + "}");
  EXPECT_EQ(two.diagnostics.size(), 2u);
}

TEST(RegexArguments, OtherEndpointsHavePatternsOfTheirOwn) {
  EXPECT_TRUE(ParseQuery(R"(ASK { SERVICE <http://e/s> { ?s ?p ?o FILTER REGEX(?o, "(?i)a") } })").ok());
}

TEST(RegexArguments, TextsAcceptedBeforeAreTaken) {
  ParseOptions options;
  options.check_patterns = false;
  EXPECT_TRUE(ParseQuery(R"(ASK { ?s ?p ?o FILTER REGEX(?o, "(?i)a") })", options).ok());
}

}  // namespace
}  // namespace docent::sparql
