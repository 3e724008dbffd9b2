// Rules with negation beside rules that make axioms.
#include "reasoner/rules/negation_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/rules/rule_engine_fixture.h"

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class NegationOrderTest : public RuleEngineTest {};

// With the rule set rdfs: its results for each word are axioms, but irrelevant ones.
class NegationBesideRdfsTest : public NegationOrderTest {
 protected:
  void SetUp() override {
    ASSERT_THAT(engine_.PutRules("rdfs", BuiltInRuleSet("rdfs")), IsEmpty());
    Turn({});
  }
  // Facts in which `word` occurs as "… word …", about the example's own things.
  std::vector<std::string> With(const std::string& word) {
    std::vector<std::string> found;
    for (const std::string& fact : world_.Inferred()) {
      if (absl::StrContains(fact, word)) found.push_back(fact);
    }
    return found;
  }
  std::string Refusal(const std::vector<std::string>& add, const std::vector<std::string>& remove = {}) {
    const absl::StatusOr<Delta> delta = engine_.Update(world_.writer, world_.Apply(add, remove));
    engine_.Rollback();
    world_.writer.Rollback();
    if (delta.ok()) return "";
    EXPECT_EQ(delta.status().code(), absl::StatusCode::kFailedPrecondition);
    return std::string(delta.status().message());
  }
};

constexpr char kFreeRobots[] =
    "RULE :free { ?r :free :yes } WHERE { ?r a :Robot NOT { ?r :busy :yes } }\n"
    "RULE :idle { ?r a :Idle } WHERE { ?r :free :yes NOT { ?r :task ?t } }\n"
    "RULE :count { :hall :robots ?n } WHERE { { SELECT (COUNT(?r) AS ?n) WHERE { ?r a :Machine } } }\n";

TEST_F(NegationBesideRdfsTest, FollowsFactsAndAxiomsInBothDirections) {
  Put(kFreeRobots);
  Turn({"r1 a Robot", "r2 a Robot", "r1 busy yes", "Robot rdfs:subClassOf Machine"});
  EXPECT_THAT(With(" free "), ElementsAre("r2 free yes"));
  EXPECT_THAT(With(" a http://example.org/Idle"), IsEmpty());
  EXPECT_THAT(With(" a Idle"), ElementsAre("r2 a Idle"));
  EXPECT_THAT(With("Idle http"), SizeIs(2)) << "a part of itself, and of rdfs:Resource";
  EXPECT_THAT(With("hall robots"), ElementsAre("hall robots 2"));
  Turn({"guiding rdfs:subPropertyOf busy", "r2 guiding yes"}, {"r1 busy yes"});
  EXPECT_THAT(With(" free "), ElementsAre("r1 free yes"));
  EXPECT_THAT(With(" a Idle"), ElementsAre("r1 a Idle"));
  Turn({"r3 a Drone", "Drone rdfs:subClassOf Robot", "r1 task t"}, {"guiding rdfs:subPropertyOf busy"});
  EXPECT_THAT(With(" free "), ElementsAre("r1 free yes", "r2 free yes", "r3 free yes"));
  EXPECT_THAT(With(" a Idle"), ElementsAre("r2 a Idle", "r3 a Idle"));
  EXPECT_THAT(With("hall robots"), ElementsAre("hall robots 3"));
  Turn({}, {"r1 a Robot", "r2 a Robot", "r3 a Drone"});
  EXPECT_THAT(With(" free "), IsEmpty());
  EXPECT_THAT(With("Idle"), IsEmpty()) << "nor is it a class any more";
  EXPECT_THAT(With("hall robots"), ElementsAre("hall robots 0"));
}

TEST_F(NegationBesideRdfsTest, FollowsChangesOfTheRules) {
  Turn({"r1 a Robot", "r2 a Robot", "r1 busy yes"});
  const std::vector<std::string> without = world_.Inferred();
  Put(kFreeRobots);
  Turn({});
  EXPECT_THAT(With(" free "), ElementsAre("r2 free yes"));
  Put("RULE { ?r :free :yes } WHERE { ?r a :Robot . ?r :busy :yes }");
  Turn({});
  EXPECT_THAT(With(" free "), ElementsAre("r1 free yes"));
  Put(kFreeRobots);
  EXPECT_TRUE(engine_.RemoveRules("rdfs"));
  Turn({});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall robots 0", "r2 a Idle", "r2 free yes"));
  ASSERT_THAT(engine_.PutRules("rdfs", BuiltInRuleSet("rdfs")), IsEmpty());
  EXPECT_TRUE(engine_.RemoveRules("test.rules"));
  Turn({});
  EXPECT_EQ(world_.Inferred(), without);
}

TEST_F(NegationBesideRdfsTest, TheOrderIsThatOfTheAxioms) {
  Put("RULE { ?x :late ?y } WHERE { ?x :k ?y NOT { ?x :early ?y } }\nRULE { ?x :sooner ?y } WHERE { ?x :k ?y "
      "NOT { ?x :m ?y } }");
  Turn({"a k b", "sooner rdfs:subPropertyOf early"});
  EXPECT_THAT(With(" late "), IsEmpty());
  Turn({"a m b"});
  EXPECT_THAT(With("a late"), ElementsAre("a late b"));
  Turn({"late rdfs:subPropertyOf m"}, {"sooner rdfs:subPropertyOf early", "a m b"});
  EXPECT_THAT(With("a sooner"), IsEmpty());
  EXPECT_THAT(Refusal({"sooner rdfs:subPropertyOf early"}),
              HasSubstr("negation through recursion, by the existing axioms"));
}

TEST_F(NegationBesideRdfsTest, ACircleIsRefused) {
  Put(kFreeRobots);
  Turn({"r1 a Robot"});
  const std::string message = Refusal({"free rdfs:subPropertyOf busy"});
  EXPECT_THAT(message, HasSubstr("test.rules free (line 2) negates consequences of itself by rdfs rdfs7"));
  EXPECT_THAT(message, HasSubstr("(<http://example.org/free> rdfs:subPropertyOf <http://example.org/busy>)"));
  Turn({"r2 a Robot"});
  EXPECT_THAT(With(" free "), ElementsAre("r1 free yes", "r2 free yes"));
}

TEST_F(NegationBesideRdfsTest, NegatingThatSomethingIsAPartOfItselfComesAfterWhatMakesItSo) {
  Put("RULE { ?x a :First } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :second ?y } WHERE { ?x :k ?y NOT { :First rdfs:subClassOf :First } }");
  Turn({"a k b"});
  EXPECT_THAT(With(" second "), IsEmpty());
  Turn({"a m b"});
  EXPECT_THAT(With("a second"), ElementsAre("a second b"));
}

TEST_F(NegationBesideRdfsTest, RealAxiomsAreRefused) {
  for (const char* head :
       {"?x rdfs:subClassOf :Odd", "?x rdfs:subPropertyOf :odd", "?x rdfs:domain ?y", "?x rdfs:range :Odd",
        "?x a ?y", "?x a rdfs:ContainerMembershipProperty", "?x a rdfs:Datatype", "?x rdf:_1 ?y"}) {
    Put(absl::StrCat("RULE :r { ", head, " } WHERE { ?x :k ?y NOT { ?x :m ?y } }"));
    const std::string message = Refusal({"a k b"});
    EXPECT_THAT(
        message,
        HasSubstr("test.rules r (line 2) negates or aggregates, and its results may be axioms for rdfs "))
        << head;
  }
  Put("RULE { ?x rdfs:subClassOf ?x } WHERE { ?x :k ?y NOT { ?x :m ?y } }");
  EXPECT_EQ(Refusal({"a k b"}), "");
}

// Axioms about schema words turn other facts into axioms.
TEST_F(NegationBesideRdfsTest, WhatUsersAxiomsMakeAxiomsIsRefused) {
  Put("RULE :r { ?x :k2 ?y . ?x a :C } WHERE { ?x :k ?y NOT { ?x :m ?y } }");
  Turn({"a k b"});
  const std::string axiom = "its results may be axioms for rdfs ";
  for (const char* fact :
       {"k2 rdfs:subPropertyOf rdfs:subClassOf", "k2 rdfs:subPropertyOf rdfs:domain",
        "C rdfs:subClassOf rdfs:Datatype", "C rdfs:subClassOf rdfs:ContainerMembershipProperty",
        "rdfs:Resource rdfs:subClassOf Odd", "rdfs:Class rdfs:subClassOf rdfs:Datatype",
        "rdf:type rdfs:subPropertyOf rdfs:subClassOf", "rdfs:subClassOf rdfs:subPropertyOf rdfs:domain",
        "rdfs:subClassOf rdfs:subPropertyOf rdfs:subPropertyOf"}) {
    EXPECT_THAT(Refusal({fact}), HasSubstr(axiom)) << fact;
  }
  for (const char* fact : {"rdfs:subClassOf rdfs:subPropertyOf broader", "rdf:type rdfs:subPropertyOf isA",
                           "C rdfs:subClassOf rdfs:Resource", "k2 rdfs:range rdfs:Class",
                           "C rdfs:subClassOf rdfs:Class", "rdfs:Class rdfs:subClassOf Odd",
                           "rdfs:member rdfs:domain Odd", "Odd rdfs:subClassOf rdfs:Datatype"}) {
    EXPECT_EQ(Refusal({fact}), "") << fact;
  }
}

// rdfs:Resource is above all classes: its superclasses decide whether being a class matters.
TEST_F(NegationBesideRdfsTest, AnAxiomAboutResourceIsSeenThatMakesNoOther) {
  Put("RULE :r { ?x a :C } WHERE { ?x :k ?y NOT { ?x :m ?y } }\nRULE { rdfs:Resource rdfs:subClassOf ?c } "
      "WHERE { ?c :above :all }");
  Turn({"a k b"});
  EXPECT_THAT(Refusal({"Odd above all"}), HasSubstr("may be axioms for rdfs rdfs9"));
  Turn({"b k c"});
  EXPECT_THAT(With(" a C"), ElementsAre("a a C", "b a C"));
}

TEST_F(NegationBesideRdfsTest, ClassesMayBeNegatedThatNothingNegatingMakes) {
  Put("RULE { ?c :kind :other } WHERE { ?c a rdfs:Class . ?c :listed :yes NOT { ?c rdfs:subClassOf :Machine "
      "} }");
  Turn({"Robot rdfs:subClassOf Machine", "Plant rdfs:subClassOf Thing", "Robot listed yes",
        "Plant listed yes"});
  EXPECT_THAT(With(" kind "), ElementsAre("Plant kind other"));
  Turn({"Thing rdfs:subClassOf Machine"});
  EXPECT_THAT(With(" kind "), IsEmpty());
}

// By scm-dom1, the superclasses of rdfs:Resource are its domains, too.
TEST_F(NegationBesideRdfsTest, BesideOwl2RlAsWellItIsRefused) {
  ASSERT_THAT(engine_.PutRules("owl2rl", BuiltInRuleSet("owl2rl")), IsEmpty());
  Turn({});
  Put(kFreeRobots);
  EXPECT_THAT(Refusal({"r1 a Robot"}), HasSubstr("may be axioms for owl2rl"));
}

// Here superclasses of :Top matter if :Top is a part of :Odd, which itself matters to no rule.
constexpr char kPartsOfTop[] =
    "RULE { ?c rdfs:subClassOf :Top } WHERE { ?x a ?c . ?x :k ?y }\n"
    "RULE { ?a rdfs:subClassOf ?c } WHERE { ?a rdfs:subClassOf ?b . ?b rdfs:subClassOf ?c }\n"
    "RULE :odd { ?x ?c :odd } WHERE { ?b rdfs:subClassOf ?c . ?x a ?b FILTER(?c = :Odd) FILTER(?b != :Top) "
    "}\n"
    "RULE { ?x a :C } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n";

TEST_F(NegationOrderTest, AnAxiomThatMattersToAxiomsAloneIsSeenWhenItComes) {
  Put(kPartsOfTop);
  Turn({"a k b"});
  EXPECT_THAT(world_.Inferred(),
              ElementsAre("C http://www.w3.org/2000/01/rdf-schema#subClassOf Top", "a a C"));
  Turn({"a m b"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
  const absl::Status status =
      engine_.Update(world_.writer, world_.Apply({"Top rdfs:subClassOf Odd"})).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("its results may be axioms for test.rules odd"));
}

TEST_F(NegationOrderTest, AxiomsThatTwoRulesWithNegationMakeAreSeenTogether) {
  Put(absl::StrCat(kPartsOfTop, "RULE { :Top rdfs:subClassOf :Odd } WHERE { ?x :k2 ?y NOT { ?x :m2 ?y } }"));
  const absl::Status status = engine_.Update(world_.writer, world_.Apply({"a k b"})).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("its results may be axioms for test.rules odd"));
}

}  // namespace
}  // namespace docent::rules
