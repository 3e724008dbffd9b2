// Rules that are refused, and what is said of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/rules/rule_engine_fixture.h"

namespace docent::rules {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(RuleEngineTest, NegationThroughRecursionIsRefusedWithItsCycle) {
  const std::string text =
      "PREFIX : <http://example.org/>\n"
      "RULE { ?x a :A } WHERE { ?x a :T FILTER NOT EXISTS { ?x a :B } }\n"
      "RULE { ?x a :B } WHERE { ?x a :C }\n"
      "RULE { ?x a :C } WHERE { ?x a :A }\n";
  const Diagnostics diagnostics = engine_.PutRules("bad.rules", text);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].message,
            "negation through recursion: bad.rules rule 1 (line 2) negates the results of bad.rules rule "
            "2 (line 3), "
            "which needs bad.rules rule 3 (line 4), which needs bad.rules rule 1 (line 2)");
  EXPECT_EQ(diagnostics[0].span.line, 2);
  EXPECT_EQ(engine_.rule_count(), 0u) << "nothing changed";
}

TEST_F(RuleEngineTest, CountingWhatTheCountMakesIsRefusedAsSuch) {
  const Diagnostics diagnostics =
      engine_.PutRules("bad.rules",
                       "PREFIX : <http://example.org/>\nRULE { ?x :n ?c } WHERE { { SELECT ?x (COUNT(?y) AS "
                       "?c) { ?x :n ?y } GROUP BY ?x } }");
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_THAT(diagnostics[0].message, ::testing::HasSubstr("aggregates the results of itself"));
  EXPECT_THAT(diagnostics[0].hint, ::testing::HasSubstr("take the aggregate out of the cycle"));
}

TEST_F(RuleEngineTest, ARuleThatNeverEndsIsRefusedWithItsCycle) {
  const std::string text =
      "PREFIX : <http://example.org/>\n"
      "RULE { ?x :n ?m } WHERE { ?x :k ?n BIND(?n + 1 AS ?m) }\n"
      "RULE { ?x :k ?n } WHERE { ?x :n ?n }\n"
      "RULE { ?x :twice ?m } WHERE { ?x :n ?n BIND(?n * 2 AS ?m) }\n";
  const Diagnostics diagnostics = engine_.PutRules("bad.rules", text);
  ASSERT_EQ(diagnostics.size(), 1u) << Render(diagnostics, text);
  EXPECT_EQ(diagnostics[0].message,
            "may never end: ?m is computed from the results of the rule itself: bad.rules rule 1 (line "
            "2) needs "
            "bad.rules rule 2 (line 3) needs bad.rules rule 1 (line 2)");
  EXPECT_EQ(diagnostics[0].span.line, 2);
  EXPECT_EQ(engine_.rule_count(), 0u) << "nothing changed";
}

TEST_F(RuleEngineTest, TheSamePredicateMayBeNegatedForAnotherClass) {
  Put("RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r a :Busy } }");
  EXPECT_EQ(engine_.rule_count(), 1u);
  ASSERT_EQ(engine_.names().size(), 1u);
  EXPECT_EQ(engine_.rule_count(engine_.names()[0]), 1u);
  EXPECT_EQ(engine_.rule_count("nothing"), 0u);
}

TEST_F(RuleEngineTest, AnUnknownFunctionIsReportedAtItsRule) {
  const Diagnostics diagnostics = engine_.PutRules(
      "f.rules", "PREFIX : <http://example.org/>\nRULE { ?x a :A } WHERE { ?x :p ?y FILTER(:nope(?y)) }");
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].span.line, 2);
}

TEST_F(RuleEngineTest, WritingTheInferredGraphIsRefused) {
  Quad quad = world_.QuadOf("a p b");
  quad.graph = world_.dictionary.InternIri(kInferredGraph);
  const absl::Status status = engine_.Update(world_.writer, world_.writer.Apply({quad}, {})).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(RuleEngineTest, ACycleByAxiomsNamesTheAxioms) {
  ASSERT_THAT(engine_.PutRules("owl2rl", BuiltInRuleSet("owl2rl")), IsEmpty());
  Put("RULE :avail { ?r a :Available } WHERE { ?r a :Rob NOT { ?r a :Broken } }");
  Turn({"r a Rob"});
  const absl::StatusOr<Delta> delta = engine_.Update(
      world_.writer, world_.Apply({"Available rdfs:subClassOf Odd", "Odd rdfs:subClassOf Broken"}));
  EXPECT_EQ(delta.status().code(), absl::StatusCode::kFailedPrecondition);
  const std::string message(delta.status().message());
  EXPECT_THAT(message, HasSubstr("avail (line 2) negates consequences of itself by owl2rl cax-sco"));
  EXPECT_THAT(message,
              ::testing::ContainsRegex(
                  "\\(<http://example.org/Available> rdfs:subClassOf <http://example.org/(Odd|Broken)>\\)"));
  EXPECT_THAT(message, HasSubstr("<http://example.org/Broken>)"));
  EXPECT_THAT(message, HasSubstr("Take one of these axioms away"));
}

// Two entangled groups of rules, connected by axioms alone; a third set joins them, and is removed.
TEST_F(RuleEngineTest, FewerRulesAreNeverRefused) {
  const std::string knots =
      "PREFIX : <http://example.org/>\n"
      "RULE { ?x :status ?d } WHERE { ?c rdfs:subClassOf ?d . ?x :status ?c }\n"
      "RULE { ?x :status :Free } WHERE { ?x :status :On NOT { ?x :status :Busy } }\n"
      "RULE { ?x :kind ?d } WHERE { ?c rdfs:subClassOf ?d . ?x :kind ?c }\n"
      "RULE { ?x :kind :Small } WHERE { ?x :kind :On NOT { ?x :kind :Large } }\n";
  RuleEngine engine(world_.dictionary);
  ASSERT_FALSE(
      HasErrors(engine.PutRules("sub", "RULE { ?x ?q ?y } WHERE { ?p rdfs:subPropertyOf ?q . ?x ?p ?y }")));
  ASSERT_FALSE(HasErrors(engine.PutRules("knots", knots)));
  ASSERT_TRUE(engine.Update(world_.writer, world_.Apply({"a status On", "a kind On"})).ok());
  const std::vector<std::string> inferred = {"a kind Small", "a status Free"};
  EXPECT_EQ(world_.Inferred(), inferred);
  EXPECT_TRUE(engine.RemoveRules("sub"));
  EXPECT_EQ(engine.rule_count(), 4u);
  ASSERT_TRUE(engine.Update(world_.writer, {}).ok());
  EXPECT_EQ(world_.Inferred(), inferred);
}

}  // namespace
}  // namespace docent::rules
