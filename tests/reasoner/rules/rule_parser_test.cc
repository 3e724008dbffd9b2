#include "reasoner/rules/rule_parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kPrefix[] = "PREFIX : <http://example.org/>\n";

std::string Errors(const std::string& text) {
  return Render(ParseRules(kPrefix + text, "t.rules").diagnostics, kPrefix + text);
}

TEST(RuleParser, ReadsRulesDataAndLaterPrefixes) {
  const ParsedRules parsed = ParseRules(R"(
    PREFIX : <http://example.org/>
    DATA { :near a :Symmetric . }
    # a comment
    RULE { ?b ?p ?a . ?a :touched true } WHERE { ?a ?p ?b . ?p a :Symmetric }
    PREFIX ex: <http://example.org/more#>
    RULE { ?r ex:free true } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r :task ?t } }
  )",
                                        "t.rules");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  ASSERT_EQ(parsed.rules.size(), 3u);
  EXPECT_EQ(parsed.rules[0].head.size(), 1u);
  EXPECT_EQ(parsed.rules[1].head.size(), 2u);
  EXPECT_EQ(parsed.rules[1].span.line, 5);
  EXPECT_EQ(parsed.rules[2].head[0].predicate.term().lexical, "http://example.org/more#free");
}

TEST(RuleParser, AnEmptyDocumentHasNoRules) {
  EXPECT_TRUE(ParseRules("", "t.rules").ok());
  EXPECT_TRUE(ParseRules("# nothing\n", "t.rules").ok());
}

TEST(RuleParser, UnsafeHeadsAreRefusedAtTheVariable) {
  const ParsedRules parsed =
      ParseRules(std::string(kPrefix) + "RULE { ?a :p ?nobody } WHERE { ?a :q ?b }", "t.rules");
  ASSERT_EQ(parsed.diagnostics.size(), 1u);
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("?nobody of the head does not occur in the body"));
  EXPECT_EQ(parsed.diagnostics[0].span.line, 2);
  EXPECT_EQ(parsed.diagnostics[0].span.column, 14);
}

TEST(RuleParser, AHeadVariableOfOneBranchOnlyIsRefused) {
  EXPECT_THAT(Errors("RULE { ?a :p ?b } WHERE { { ?a :q ?b } UNION { ?a :r ?c } }"),
              HasSubstr("not bound in every solution"));
  EXPECT_EQ(Errors("RULE { ?a :p ?b } WHERE { { ?a :q ?b } UNION { ?b :r ?a } }"), "");
  EXPECT_EQ(Errors("RULE { ?a :p ?b } WHERE { { ?a :q ?b } UNION { ?a :r ?c BIND(:n AS ?b) } }"), "");
  EXPECT_THAT(Errors("RULE { ?a :p ?b } WHERE { { ?a :q ?c } UNION { ?a :r ?c BIND(:n AS ?b) } }"),
              HasSubstr("?b of the head is not bound in every solution"));
}

TEST(RuleParser, BindMakesAHeadVariable) {
  EXPECT_EQ(Errors("RULE { ?a :twice ?d } WHERE { ?a :n ?n BIND(?n * 2 AS ?d) }"), "");
}

TEST(RuleParser, AFilterOnAnUnboundVariableIsAnError) {
  EXPECT_THAT(Errors("RULE { ?a :p :x } WHERE { ?a :q ?b FILTER(?typo > 3) }"),
              HasSubstr("?typo is not bound where the FILTER"));
}

TEST(RuleParser, RefusesWhatCannotBeKeptUpToDate) {
  EXPECT_THAT(Errors("RULE { ?a :p :x } WHERE { ?a :q ?b OPTIONAL { ?a :r ?c } }"), HasSubstr("OPTIONAL"));
  EXPECT_THAT(Errors("RULE { ?a :p :x } WHERE { GRAPH :g { ?a :q ?b } }"), HasSubstr("GRAPH"));
  EXPECT_THAT(Errors("RULE { ?a :p ?b } WHERE { ?a :q+ ?b }"),
              HasSubstr("?b . ?b <http://example.org/q> ?c }\n"));
  EXPECT_THAT(Errors("RULE { ?a :p ?b } WHERE { ?a :q/:r* ?b }"), HasSubstr("property path of any length"));
  EXPECT_THAT(Errors("RULE { ?a :p ?b } WHERE { ?a :q/:r? ?b }"),
              HasSubstr("one rule with the step and one without"));
  EXPECT_THAT(Errors("RULE { ?a :p ?b } WHERE { ?a !:q ?b }"), HasSubstr("NOT IN"));
  EXPECT_THAT(Errors("RULE { ?a :n ?n } WHERE { { SELECT ?a (AVG(?b) AS ?n) { ?a :q ?b } GROUP BY ?a } }"),
              HasSubstr("COUNT, SUM, MIN and MAX can be kept"));
  EXPECT_THAT(Errors("RULE { ?a :n ?b } WHERE { { SELECT DISTINCT ?a ?b { ?a :q ?b } } }"),
              HasSubstr("a sub-SELECT"));
  EXPECT_THAT(Errors("RULE { ?a :t ?t } WHERE { ?a :q ?b BIND(NOW() AS ?t) }"), HasSubstr("NOW() in a rule"));
}

TEST(RuleParser, AggregatesOfSubSelectsBindTheirVariables) {
  EXPECT_EQ(Errors("RULE { ?a :n ?n } WHERE { { SELECT ?a (COUNT(*) AS ?n) { ?a :q ?b } GROUP BY ?a } }"),
            "");
  EXPECT_THAT(Errors("RULE { ?a :n ?b } WHERE { { SELECT ?a (COUNT(*) AS ?n) { ?a :q ?b } GROUP BY ?a } }"),
              HasSubstr("?b of the head does not occur in the body"));
}

TEST(RuleParser, ReadsTheOtherFormsOfTheDraft) {
  const ParsedRules parsed = ParseRules(std::string(kPrefix) +
                                            "RULE :named { ?a :p ?b } WHERE { ?a :q ?b NOT { ?b :q ?a } }\n"
                                            "IF { ?a :q ?b SET(?c := 1 + 1) } THEN { ?a :c ?c }\n"
                                            "RULE :check { } WHERE { ?a :q ?a }",
                                        "t.rules");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  ASSERT_EQ(parsed.rules.size(), 3u);
  EXPECT_EQ(parsed.rules[0].name, "http://example.org/named");
  EXPECT_EQ(parsed.rules[1].head[0].object.variable().name, "c");
  EXPECT_TRUE(parsed.rules[2].head.empty());
  EXPECT_THAT(Errors("IF { ?a :q ?b } { ?a :p ?b }"), HasSubstr("expected THEN"));
  EXPECT_THAT(Errors("RULE { ?a :p ?c } WHERE { ?a :q ?b SET(?c = 1) }"),
              HasSubstr("':=' after the variable"));
  EXPECT_THAT(Errors("RULE :p :q { ?a :p ?c } WHERE { ?a :q ?b }"), HasSubstr("error"));
}

TEST(RuleParser, HeadsMustBeTriples) {
  EXPECT_THAT(Errors("RULE { [] :p ?b } WHERE { ?a :q ?b }"), HasSubstr("blank node in a rule head"));
  EXPECT_THAT(Errors("RULE { _:x :p ?b } WHERE { ?a :q ?b }"), HasSubstr("blank node in a rule head"));
}

TEST(RuleParser, DataHoldsNoVariables) {
  EXPECT_THAT(Errors("DATA { ?a :p :b }"), HasSubstr("a variable is not allowed in DATA"));
  const ParsedRules list = ParseRules(std::string(kPrefix) + "DATA { :a :p (1 2 3) }", "t.rules");
  ASSERT_EQ(list.diagnostics.size(), 1u) << "a list is six triples, and one mistake";
  EXPECT_THAT(list.diagnostics[0].message, HasSubstr("no blank nodes, nor lists"));
}

TEST(RuleParser, ARulesNameIsAnIri) {
  EXPECT_EQ(Errors("RULE :near { ?a :p ?b } WHERE { ?a :q ?b }"), "");
  const ParsedRules parsed =
      ParseRules(std::string(kPrefix) + "RULE near { ?a :p ?b } WHERE { ?a :q ?b }", "t.rules");
  ASSERT_EQ(parsed.diagnostics.size(), 1u);
  EXPECT_EQ(parsed.diagnostics[0].message, "the name of a rule is an IRI");
  EXPECT_EQ(parsed.diagnostics[0].span.column, 6);
}

TEST(RuleParser, TheLimitOfPartsIsOfOneRule) {
  const std::string part = " NOT { ?a a :C }";
  std::string many, one = "RULE { ?a :p ?b } WHERE { ?a :q ?b";
  for (size_t i = 0; i <= Limits{}.query_elements; ++i) {
    absl::StrAppend(&many, "RULE { ?a :p ?b } WHERE { ?a :q ?b", part, " }\n");
    one += part;
  }
  EXPECT_EQ(Errors(many), "");
  EXPECT_THAT(Errors(one + " }"), HasSubstr("query_elements"));
}

TEST(RuleParser, ReportsEveryMistakeOfADocument) {
  const std::string text = std::string(kPrefix) +
                           "RULE { ?a :p ?x } WHERE { ?a :q ?b }\n"
                           "RULE { ?a :p ?b } WERE { ?a :q ?b }\n"
                           "RULE { ?a :p ?b } WHERE { ?a :q ?b OPTIONAL { ?a :r ?c } }\n"
                           "nonsense\n"
                           "RULE { ?a nope:p ?b } WHERE { ?a :q ?b }\n";
  const ParsedRules parsed = ParseRules(text, "t.rules");
  std::vector<int> lines;
  for (const Diagnostic& d : parsed.diagnostics) lines.push_back(d.span.line);
  EXPECT_THAT(lines, ::testing::UnorderedElementsAre(2, 3, 4, 5, 6)) << Render(parsed.diagnostics, text);
  EXPECT_TRUE(parsed.rules.empty());
}

}  // namespace
}  // namespace docent::rules
