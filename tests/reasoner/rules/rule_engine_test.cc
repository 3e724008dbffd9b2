#include "reasoner/rules/rule_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reasoner/rules/rule_engine_fixture.h"

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST_F(RuleEngineTest, InfersAndRetracts) {
  Put("RULE { ?x :at ?c } WHERE { ?x :at ?b . ?b :in ?c }");
  Turn({"r at b3", "b3 in hall", "hall in city"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r at city", "r at hall"));
  Turn({}, {"b3 in hall"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, TheDeltaIsNetAndHoldsToldAndInferred) {
  Put("RULE { ?y :knows ?x } WHERE { ?x :knows ?y }");
  const Delta first = Turn({"a knows b"});
  EXPECT_EQ(first.added.size(), 2u);  // told a-b, inferred b-a
  EXPECT_TRUE(first.removed.empty());
  const Delta none = Turn({"a knows b @other"});
  EXPECT_EQ(none.added.size(), 1u) << "the same triple in a second graph infers nothing";
  EXPECT_EQ(Turn({}, {"a knows b"}).removed.size(), 1u) << "still told in the other graph";
  EXPECT_EQ(Turn({}, {"a knows b @other"}).removed.size(), 2u);
}

TEST_F(RuleEngineTest, WhatBranchesOfAUnionAssignComesAndGoesWithThem) {
  Put("RULE { ?x :y ?y } WHERE { { ?x :p ?y } UNION { ?x :q ?z BIND(:n AS ?y) } }");
  Turn({"x p m", "x p n", "x q k", "z q k"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("x y m", "x y n", "z y n"));
  Turn({"w q k"}, {"x q k"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("w y n", "x y m", "x y n", "z y n"))
      << "x y n by the other branch";
  Turn({}, {"x p n", "x p m"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("w y n", "z y n"));
}

// CLIPS never removes these: the two facts support each other.
TEST_F(RuleEngineTest, InversePropertiesDoNotSupportEachOther) {
  Put("RULE { ?o :memberOf ?s } WHERE { ?s :member ?o }\nRULE { ?o :member ?s } WHERE { ?s :memberOf ?o }");
  Turn({"d member u", "d member v"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("u memberOf d", "v memberOf d"));
  Turn({"u memberOf d"}, {"d member u"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("d member u", "v memberOf d"));
  Turn({}, {"u memberOf d"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("v memberOf d"));
}

// Jena's RETE loses these, although the fact has other support.
TEST_F(RuleEngineTest, SharedSupportStays) {
  Put("RULE { ?x a :Agent } WHERE { ?x a :Robot }\nRULE { ?x a :Agent } WHERE { ?x :speaks ?l }");
  Turn({"r a Robot", "r speaks english"});
  EXPECT_EQ(Turn({}, {"r a Robot"}).removed.size(), 1u);
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Agent"));
  Turn({}, {"r speaks english"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, AToldFactIsNotInferredBesides) {
  Put("RULE { ?x a :Agent } WHERE { ?x a :Robot }\nRULE { ?x a :Thing } WHERE { ?x a :Agent }");
  Turn({"r a Robot", "r a Agent"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Thing"));
  const Delta untold = Turn({}, {"r a Agent"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Agent", "r a Thing")) << "it still follows";
  EXPECT_EQ(untold.removed.size(), 1u);
  EXPECT_EQ(untold.added.size(), 1u);
  Turn({"r a Agent @g"}, {"r a Robot"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Thing"));
  Turn({}, {"r a Agent @g"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, FactsUntoldTogetherStillFollowFromEachOther) {
  Turn({"a p1 b", "a p2 b", "a p3 b"});  // p1 is asked about before p2, from which it follows
  Put("RULE { ?x :p1 ?y } WHERE { ?x :p2 ?y }\nRULE { ?x :p2 ?y } WHERE { ?x :p3 ?y }");
  Turn({});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
  Turn({}, {"a p1 b", "a p2 b"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a p1 b", "a p2 b"));
}

TEST_F(RuleEngineTest, RulesMayHaveNamesAndTheOtherFormsOfTheDraft) {
  Put("RULE :first { ?x :q ?y } WHERE { ?x :p ?y NOT { ?x :not ?y } SET(?z := 1) }\n"
      "IF { ?x :q ?y } THEN { ?y :r ?x }");
  Turn({"a p b", "c p d", "c not d"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b", "b r a"));
}

TEST_F(RuleEngineTest, RuleChangesAreMaintainedNotComputedAnew) {
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }\nRULE { ?x :s ?y } WHERE { ?x :q ?y }");
  std::vector<std::string> facts;
  for (int i = 0; i < 200; ++i) facts.push_back("n" + std::to_string(i) + " p m");
  Turn(facts);
  const uint64_t firings = engine_.counters().firings;
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }\nRULE { ?x :s ?y } WHERE { ?x :q ?y }\nDATA { :a :b :c }");
  EXPECT_EQ(Turn({}).added.size(), 1u);
  EXPECT_LE(engine_.counters().firings, firings + 1);
}

TEST_F(RuleEngineTest, ATransitiveClosureFollowsCutsAndCycles) {
  Put("RULE { ?a :r ?c } WHERE { ?a :e ?c }\nRULE { ?a :r ?c } WHERE { ?a :r ?b . ?b :e ?c }");
  Turn({"x1 e x2", "x2 e x3", "x3 e x1"});
  EXPECT_EQ(world_.Inferred().size(), 9u);
  Turn({}, {"x3 e x1"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("x1 r x2", "x1 r x3", "x2 r x3"));
  Turn({"x1 e x3"}, {"x2 e x3"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("x1 r x2", "x1 r x3"));
}

TEST_F(RuleEngineTest, NegationFollowsBothDirections) {
  Put("RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r a :Busy } }\n"
      "RULE { ?r a :Busy } WHERE { ?r :task ?t }\n"
      "RULE { :hall :has ?r } WHERE { ?r a :Free }");
  Turn({"r1 a Robot", "r2 a Robot", "r1 task t1"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall has r2", "r1 a Busy", "r2 a Free"));
  Turn({"r2 task t2"}, {"r1 task t1"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall has r1", "r1 a Free", "r2 a Busy"));
  Turn({"r2 a Busy"}, {"r2 task t2"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall has r1", "r1 a Free")) << "told Busy negates as well";
}

TEST_F(RuleEngineTest, FiltersAndBindCompute) {
  Put("RULE { ?r :low true } WHERE { ?r :battery ?b FILTER(?b < 0.2) }\n"
      "RULE { ?r :percent ?p } WHERE { ?r :battery ?b BIND(?b * 100 AS ?p) }");
  Turn({"r battery 0.5"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r percent 50"));
  Turn({"r battery 0.1"}, {"r battery 0.5"});
  EXPECT_EQ(world_.Inferred().size(), 2u);
  EXPECT_THAT(world_.Inferred(), ElementsAre("r low true", "r percent 10"));
}

TEST_F(RuleEngineTest, RulesChangeAtRunTime) {
  Turn({"a p b"});
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }");
  EXPECT_EQ(Turn({}).added.size(), 1u);
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b"));
  Put("RULE { ?x :s ?y } WHERE { ?x :q ?y }", "second.rules");
  Put("RULE { ?y :q ?x } WHERE { ?x :p ?y }");
  Turn({"c p d"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("b q a", "b s a", "d q c", "d s c"));
  EXPECT_TRUE(engine_.RemoveRules("test.rules"));
  EXPECT_FALSE(engine_.RemoveRules("test.rules"));
  EXPECT_EQ(Turn({}).removed.size(), 4u);
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, DataIsInferred) {
  Put("DATA { :near :inverse :near }");
  Turn({});
  EXPECT_THAT(world_.Inferred(), ElementsAre("near inverse near"));
}

TEST_F(RuleEngineTest, HeadsThatAreNoTriplesAreLeftOut) {
  Put("RULE { ?y :of ?x } WHERE { ?x :p ?y }");
  Turn({"a p 5", "a p b"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("b of a"));
}

TEST_F(RuleEngineTest, AVariablePredicateIsARuleLikeOthers) {
  Put("RULE { ?s ?q ?o } WHERE { ?s ?p ?o . ?p :subPropertyOf ?q }");
  Turn({"p subPropertyOf q", "q subPropertyOf r", "a p b"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b", "a r b"));
  Turn({}, {"q subPropertyOf r"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b"));
}

TEST_F(RuleEngineTest, RollbackRestoresRuleSets) {
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }");
  Turn({"a p b"});
  Put("RULE { ?x :q2 ?y } WHERE { ?x :p ?y }");
  Put("RULE { ?x :s ?y } WHERE { ?x :p ?y }", "second.rules");
  ASSERT_TRUE(engine_.Update(world_.writer, world_.Apply({"c p d"})).ok());
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q2 b", "a s b", "c q2 d", "c s d"));
  engine_.Rollback();
  world_.writer.Rollback();
  EXPECT_THAT(engine_.names(), ElementsAre("test.rules"));
  Turn({"e p f"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b", "e q f"));
}

// What decides goes by the graph and the rules alone: a turn that is replayed decides as it did.
TEST_F(RuleEngineTest, WhatRulesReadDoesNotDependOnAStartOrARefusedTurn) {
  const std::string rules = "RULE { ?x :q ?y } WHERE { ?x :p ?y }";
  Put(rules);
  Turn({"a p b"});
  const Quad read = world_.QuadOf("a p c"), other = world_.QuadOf("a t b");
  const auto expect = [&](const RuleEngine& engine, const char* when) {
    EXPECT_TRUE(engine.Reads(read)) << when;
    EXPECT_FALSE(engine.Reads(other)) << when;
  };
  expect(engine_, "in the life");
  ASSERT_TRUE(engine_.Update(world_.writer, world_.Apply({"c p d"})).ok());
  engine_.Rollback();
  world_.writer.Rollback();
  ASSERT_TRUE(engine_.Update(world_.writer, {}).ok());
  expect(engine_, "after a turn that was refused, and nothing told since");
  RuleEngine restored(world_.dictionary);
  ASSERT_THAT(restored.PutRules("test.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
  restored.Adopt();
  ASSERT_TRUE(restored.Update(world_.writer, {}).ok());
  expect(restored, "after a start");
}

}  // namespace
}  // namespace docent::rules
