// Rules that never end or infer too much.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/match.h"
#include "graph/base/query_limits.h"
#include "graph/base/rule_limits.h"
#include "reasoner/rules/rule_parser.h"
#include "tests/reasoner/rules/rule_engine_fixture.h"

namespace docent::rules {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RuleLimitsTest : public ::testing::Test {
 protected:
  absl::Status Run(const Limits& limits, const std::string& rules, const std::vector<std::string>& add,
                   const std::vector<std::string>& base = {}) {
    TestWorld world;
    RuleEngine engine(world.dictionary, limits);
    EXPECT_THAT(engine.PutRules("loop.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
    if (!engine.Update(world.writer, world.Apply(base)).ok()) return absl::InternalError("the base facts");
    engine.Commit();
    world.writer.Freeze(Revision(1));
    const absl::Status status = engine.Update(world.writer, world.Apply(add)).status();
    if (!status.ok()) {
      engine.Rollback();
      world.writer.Rollback();
      EXPECT_THAT(world.Inferred(), IsEmpty());
      EXPECT_TRUE(engine.Update(world.writer, world.Apply({"other fact x"})).ok()) << "the engine goes on";
    }
    return status;
  }
  TestWorld world_;
};

TEST_F(RuleLimitsTest, ARuleThatFeedsItselfIsStoppedAndNamed) {
  Limits limits;
  limits.rule_rounds = 50;
  const absl::Status status =
      Run(limits, "RULE { ?x :n ?m } WHERE { ?x :n ?n BIND(?n + 1 AS ?m) FILTER(?n < 100000) }", {"a n 1"});
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("loop.rules rule 1 (line 2) goes beyond the limit rule_rounds = 50"));
}

TEST_F(RuleLimitsTest, PatternsOfABodyAreLimitedAtTheLimitAndOnePast) {
  const auto errors = [](size_t patterns, RuleTextOrigin origin) {
    std::string text = "PREFIX : <http://example.org/>\nRULE { ?x :p 1 } WHERE { ?x :q 1";
    for (size_t i = 1; i < patterns; ++i) absl::StrAppend(&text, " . ?x :q", i, " 1");
    return Render(ParseRules(text + " }", "r.rules", {}, nullptr, origin).diagnostics, "");
  };
  EXPECT_EQ(errors(kRuleLimits.rule_patterns, RuleTextOrigin::kNew), "");
  EXPECT_THAT(
      errors(kRuleLimits.rule_patterns + 1, RuleTextOrigin::kNew),
      HasSubstr("r.rules:2:1: error: the body has 10001 triple patterns; the limit rule_patterns is 10000"));
  EXPECT_EQ(errors(kRuleLimits.rule_patterns + 1, RuleTextOrigin::kAccepted), "") << "of an old log";
}

TEST_F(RuleLimitsTest, ListsOfABodyAreLimitedAsThoseOfQueries) {
  const size_t limit = QueryLimits{}.query_list_elements;
  std::string text = "PREFIX : <http://example.org/>\nRULE { ?x :p 1 } WHERE { ?x :q ?y FILTER(?y IN (0";
  for (size_t i = 0; i < limit; ++i) absl::StrAppend(&text, ",", i);
  text += ")) }";
  EXPECT_THAT(Render(ParseRules(text, "r.rules", {}, nullptr, RuleTextOrigin::kNew).diagnostics, ""),
              HasSubstr("query_list_elements = 100000"));
  EXPECT_TRUE(ParseRules(text, "r.rules", {}, nullptr, RuleTextOrigin::kAccepted).ok()) << "of an old log";
}

TEST_F(RuleLimitsTest, ABodyOfMoreThan32PatternsHasTheSameResults) {
  std::string body = "?x :q0 ?y";
  for (int i = 1; i < 40; ++i) absl::StrAppend(&body, " . ?x :q", i, " ?y", i);
  TestWorld world;
  RuleEngine engine(world.dictionary, {});
  EXPECT_THAT(
      engine.PutRules("r", "PREFIX : <http://example.org/>\nRULE { ?x :all ?y } WHERE { " + body + " }"),
      IsEmpty());
  std::vector<std::string> facts;
  for (int i = 0; i < 40; ++i) facts.push_back(absl::StrCat("a q", i, " b", i));
  ASSERT_TRUE(engine.Update(world.writer, world.Apply(facts)).ok());
  EXPECT_THAT(world.Inferred(), ::testing::SizeIs(1));
}

TEST_F(RuleLimitsTest, VariablesOfABodyAreLimited) {
  std::string text = "PREFIX : <http://example.org/>\nRULE { ?x :p 1 } WHERE { ?x :q ?y";
  for (int i = 0; i < 33000; ++i) absl::StrAppend(&text, " . ?x :q ?y", i);
  TestWorld world;
  RuleEngine engine(world.dictionary, {});
  EXPECT_THAT(Render(engine.PutRules("r", text + " }", RuleTextOrigin::kAccepted), ""),
              HasSubstr("has 33002 variables; the limit body_variables is 32000"));
}

TEST_F(RuleLimitsTest, WhatDependsOnEverythingIsLimitedInPairs) {
  const auto errors = [](int rules, RuleTextOrigin origin) {
    std::string text = "PREFIX : <http://example.org/>\n";
    for (int i = 0; i < rules; ++i)
      absl::StrAppend(&text, "RULE { ?x ?q ?y } WHERE { ?x :p", i, " ?y . ?y :is", i, " ?q }\n");
    TestWorld world;
    RuleEngine engine(world.dictionary, {});
    return Render(engine.PutRules("r", text, origin), "");
  };
  EXPECT_EQ(errors(1000, RuleTextOrigin::kNew), "");
  EXPECT_THAT(errors(4000, RuleTextOrigin::kNew), HasSubstr("the limit rule_dependencies = 10000000"));
}

// Each of them is on a cycle, and most on many.
TEST_F(RuleLimitsTest, OfManyRulesThatMayNeverEndTheFirstAreTold) {
  std::string text = "PREFIX : <http://example.org/>\n";
  for (int i = 0; i < 1000; ++i)
    absl::StrAppend(&text, "RULE { ?x ?p ?m } WHERE { ?x :p", i, " ?n . ?x :of ?p BIND(?n + 1 AS ?m) }\n");
  TestWorld world;
  RuleEngine engine(world.dictionary, {});
  const Diagnostics diagnostics = engine.PutRules("r", text);
  EXPECT_EQ(diagnostics.size(), 20u);
  EXPECT_THAT(Render(diagnostics, ""),
              HasSubstr("may never end: ?m is computed from the results of the rule itself"));
}

TEST_F(RuleLimitsTest, InferredFactsAreLimitedAtTheLimitAndOnePast) {
  Limits limits;
  limits.inferred_per_turn = 4;
  const std::string rule = "RULE { ?y :of ?x } WHERE { ?x :p ?y }";
  EXPECT_TRUE(Run(limits, rule, {"a p b1", "a p b2", "a p b3", "a p b4"}).ok());
  const absl::Status status = Run(limits, rule, {"a p b1", "a p b2", "a p b3", "a p b4", "a p b5"});
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("inferred_per_turn = 4"));
}

// A rule that makes longer texts of its own results.
TEST_F(RuleLimitsTest, TermsThatRulesComputeInATurnAreLimited) {
  RuleEngine engine(world_.dictionary);
  EXPECT_THAT(engine.PutRules("grow.rules",
                              "PREFIX : <http://example.org/>\nRULE { ?x :n ?m } WHERE { ?x :n ?n "
                              "BIND(CONCAT(?n, \"x\") AS ?m) FILTER(STRLEN(?n) < 2000000) }"),
              IsEmpty());
  ASSERT_TRUE(engine.Update(world_.writer, {}).ok());
  engine.Commit();
  Cancellation cancellation;
  const auto update = [&](size_t length) {
    const absl::Status status =
        engine.Update(world_.writer, world_.Apply({"s n '" + std::string(length, 'y')}), &cancellation)
            .status();
    engine.Rollback();
    world_.writer.Rollback();
    return status;
  };
  const absl::Status status = update(1000000);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("grow.rules rule 1 (line 2)"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("computed_bytes_per_turn is 268435456"));
  EXPECT_TRUE(update(1999990).ok()) << "counted again from nothing";
}

// It had no result, so the time limit was never checked.
TEST_F(RuleEngineTest, AJoinWithoutResultsIsStoppedAndNamed) {
  std::vector<std::string> facts;
  for (int i = 0; i < 200; ++i) facts.push_back(absl::StrCat("k", i, " p ", i));
  Turn(facts);
  for (
      const char* body : {
          "?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = -1)",              // leaves
          "?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?f < ?b && ?f < ?d && ?b < ?f)",  // on ids
          "?a :p ?b . ?c :p ?d . ?e :p ?f . ?a :q ?f",  // a pattern without a match
          "{ ?a :p ?b } UNION { ?b :p ?a } ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = -1)",  // the SPARQL evaluator
          "?a :p ?b . ?c :p ?d . ?e :p ?f BIND(?b + ?d + ?f AS ?g) FILTER(?g = -1)",
      }) {
    const std::string document =
        absl::StrCat("PREFIX : <http://example.org/>\nRULE :cross { ?a :r ?d } WHERE { ", body, " }");
    ASSERT_THAT(engine_.PutRules("cross.rules", document), IsEmpty()) << body;
    Cancellation cancellation;
    cancellation.AllowSteps(100000);
    const absl::StatusOr<Delta> delta = engine_.Update(world_.writer, {}, &cancellation);
    if (std::string_view(body).find(":q") != std::string_view::npos) {
      EXPECT_TRUE(delta.ok()) << "the pattern without a match is asked first";
    } else {
      EXPECT_EQ(delta.status().code(), absl::StatusCode::kResourceExhausted) << body;
      EXPECT_THAT(std::string(delta.status().message()),
                  HasSubstr("cross.rules cross (line 2): evaluation stopped after 100000"));
      EXPECT_THAT(std::string(delta.status().message()), HasSubstr("steps_per_turn"));
    }
    engine_.Rollback();
    world_.writer.Rollback();
  }
  Turn({"x p y"});
  EXPECT_THAT(world_.Inferred(), IsEmpty()) << "the rule set was not taken";
}

// Inferred facts cost steps like any other work: the inferences of a turn do not raise its limit.
TEST_F(RuleEngineTest, WhatIsInferredCostsSteps) {
  Put("RULE { ?y a :Hot } WHERE { ?x a :Hot . ?x :next ?y }");
  std::vector<std::string> facts;
  for (int i = 0; i < 5000; ++i) facts.push_back(absl::StrCat("a", i, " next a", i + 1));
  Turn(facts);
  for (const bool enough : {false, true}) {
    Cancellation cancellation;
    cancellation.AllowSteps(enough ? 2000000 : 200000);
    const absl::StatusOr<Delta> delta =
        engine_.Update(world_.writer, world_.Apply({"a0 a Hot"}), &cancellation);
    EXPECT_EQ(delta.ok(), enough) << delta.status();
    EXPECT_THAT(std::string(delta.status().message()), HasSubstr(enough ? "" : "steps_per_turn"));
    engine_.Rollback();
    world_.writer.Rollback();
  }
}

TEST_F(RuleLimitsTest, RoundsAreAllowedUpToTheLimit) {
  Limits limits;
  limits.rule_rounds = 3;
  const std::string rule = "RULE { ?y a :Hot } WHERE { ?x a :Hot . ?x :next ?y }";
  EXPECT_TRUE(Run(limits, rule, {"a1 a Hot"}, {"a1 next a2", "a2 next a3"}).ok());
  EXPECT_EQ(Run(limits, rule, {"a1 a Hot"}, {"a1 next a2", "a2 next a3", "a3 next a4"}).code(),
            absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace docent::rules
