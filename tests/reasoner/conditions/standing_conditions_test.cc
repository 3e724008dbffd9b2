#include "reasoner/conditions/standing_conditions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reasoner/test_world.h"

namespace docent::conditions {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class StandingConditionsTest : public ::testing::Test {
 protected:
  ConditionId Register(const std::string& ask, const std::vector<std::string>& keys = {}) {
    const absl::StatusOr<ConditionId> id =
        set_.Register(world_.Parse(ask), world_.writer.current(), {keys, 0});
    EXPECT_TRUE(id.ok()) << id.status();
    set_.Commit();
    return id.value_or(ConditionId());
  }

  // "1 rose +{x=a} -{x=b}" for each change.
  std::vector<std::string> Turn(const std::vector<std::string>& add,
                                const std::vector<std::string>& remove = {}, TimeMicros now_us = 0) {
    const Delta delta = world_.Apply(add, remove);
    const auto changes = set_.Update(world_.writer.current(), delta, now_us);
    EXPECT_TRUE(changes.ok()) << changes.status();
    std::vector<std::string> texts;
    for (const ConditionChange& change : *changes) {
      std::string text = std::to_string(change.id.value());
      text += change.edge == ConditionChange::Edge::kRose   ? " rose"
              : change.edge == ConditionChange::Edge::kFell ? " fell"
                                                            : " bindings";
      for (const Binding& b : change.appeared) text += " +" + Text(b);
      for (const Binding& b : change.disappeared) text += " -" + Text(b);
      texts.push_back(std::move(text));
    }
    return texts;
  }
  void Commit() {
    set_.Commit();
    world_.writer.Freeze(Revision(++revision_));
  }
  void Rollback() {
    set_.Rollback();
    world_.writer.Rollback();
  }

  std::string Text(const Binding& binding) const {
    std::string text = "{";
    for (const auto& [name, id] : binding)
      text += (text.size() > 1 ? "," : "") + name + "=" + world_.Text(id);
    return text + "}";
  }
  std::vector<std::string> Texts(const std::vector<Binding>& bindings) const {
    std::vector<std::string> texts;
    for (const Binding& b : bindings) texts.push_back(Text(b));
    return texts;
  }

  TestWorld world_;
  StandingConditions set_{world_.dictionary};
  uint64_t revision_ = 0;
};

TEST_F(StandingConditionsTest, RisesAndFallsAtTheEdges) {
  const ConditionId id = Register("ASK { :R01 :at ?b . :John :at ?b }");
  EXPECT_FALSE(set_.Holds(id));
  EXPECT_THAT(Turn({"R01 at B03"}), IsEmpty());
  EXPECT_THAT(Turn({"John at B03"}), ElementsAre("1 rose"));
  EXPECT_TRUE(set_.Holds(id));
  EXPECT_THAT(Turn({"John at B04", "R01 at B04"}), IsEmpty()) << "holds in one more way";
  EXPECT_THAT(Turn({}, {"John at B03"}), IsEmpty()) << "still holds in the other";
  EXPECT_THAT(Turn({}, {"R01 at B04"}), ElementsAre("1 fell"));
}

TEST_F(StandingConditionsTest, TheLevelAtRegistrationIsKnownAndIsNoEdge) {
  world_.Apply({"a p b"});
  EXPECT_TRUE(set_.Holds(Register("ASK { :a :p ?x }")));
  EXPECT_THAT(Turn({"a p c"}), IsEmpty());
}

TEST_F(StandingConditionsTest, ATripleInASecondGraphChangesNothing) {
  Register("ASK { :a :p ?x }");
  EXPECT_THAT(Turn({"a p b"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({"a p b @g"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"a p b"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"a p b @g"}), ElementsAre("1 fell"));
}

TEST_F(StandingConditionsTest, ThresholdsCompareByValue) {
  Register("ASK { :R :battery ?b FILTER(?b < 0.2) }");
  EXPECT_THAT(Turn({"R battery 0.5"}), IsEmpty());
  EXPECT_EQ(set_.evaluations(), 0u) << "a number above the threshold is rejected by the index";
  EXPECT_THAT(Turn({"R battery 0.2"}, {"R battery 0.5"}), IsEmpty());
  EXPECT_THAT(Turn({"R battery 0.19"}, {"R battery 0.2"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({"R battery 0.1"}, {"R battery 0.19"}), IsEmpty());
  EXPECT_THAT(Turn({"R battery 'empty"}, {"R battery 0.1"}), ElementsAre("1 fell"));
}

TEST_F(StandingConditionsTest, NegationHasItsOwnEdges) {
  Register("ASK { ?r a :Robot FILTER NOT EXISTS { ?r :task ?t } }");
  EXPECT_THAT(Turn({"r1 a Robot", "r1 task t1"}), IsEmpty());
  EXPECT_THAT(Turn({"r1 task t2"}, {"r1 task t1"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"r1 task t2"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({"r2 task t2"}), IsEmpty());
  EXPECT_THAT(Turn({"r1 task t3"}), ElementsAre("1 fell"));
}

// The witness of a condition that a negation made fall is kept until a change breaks it.
TEST_F(StandingConditionsTest, WhatANegationMadeFallRisesByWhatIsThereThen) {
  Register("ASK { :r1 :at ?p FILTER NOT EXISTS { :r1 :task ?t } }");
  EXPECT_THAT(Turn({"r1 at hall"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({"r1 task t1"}), ElementsAre("1 fell"));
  EXPECT_THAT(Turn({}, {"r1 at hall"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"r1 task t1"}), IsEmpty());
  EXPECT_THAT(Turn({"r1 at room"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({"r1 task t2"}), ElementsAre("1 fell"));
  EXPECT_THAT(Turn({"r1 task t3"}), IsEmpty());
  EXPECT_THAT(Turn({"r1 at yard"}, {"r1 at room"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"r1 task t2"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"r1 task t3"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({"r1 task t4"}), ElementsAre("1 fell"));
  EXPECT_THAT(Turn({}, {"r1 task t4"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({}, {"r1 at yard"}), ElementsAre("1 fell"));
}

TEST_F(StandingConditionsTest, ANegationAboutAKeyTakesThatKeyAlone) {
  Register("ASK { ?r :at ?p FILTER NOT EXISTS { ?r :task ?t } FILTER NOT EXISTS { ?p :closed ?c } }", {"r"});
  EXPECT_THAT(Turn({"r1 at hall", "r1 at room", "r2 at hall"}), ElementsAre("1 rose +{r=r1} +{r=r2}"));
  EXPECT_THAT(Turn({"r1 task t1"}), ElementsAre("1 bindings -{r=r1}"));
  EXPECT_THAT(Turn({}, {"r1 task t1"}), ElementsAre("1 bindings +{r=r1}"));
  EXPECT_THAT(Turn({"hall closed now"}), ElementsAre("1 bindings -{r=r2}")) << "r1 is in the room, too";
  EXPECT_THAT(Turn({"room closed now"}), ElementsAre("1 fell -{r=r1}"));
  EXPECT_THAT(Turn({"r1 task t2"}, {"hall closed now"}), ElementsAre("1 rose +{r=r2}"));
}

TEST_F(StandingConditionsTest, AKeptWitnessOutlivesARollback) {
  Register("ASK { :r1 :at ?p FILTER NOT EXISTS { :r1 :task ?t } }");
  EXPECT_THAT(Turn({"r1 at hall"}), ElementsAre("1 rose"));
  Commit();
  EXPECT_THAT(Turn({"r1 task t1"}), ElementsAre("1 fell"));
  EXPECT_THAT(Turn({"r1 at yard"}, {"r1 at hall"}), IsEmpty());
  Rollback();
  EXPECT_THAT(Turn({"r1 task t1"}), ElementsAre("1 fell"));
  Commit();
  EXPECT_THAT(Turn({}, {"r1 task t1"}), ElementsAre("1 rose"));
  Rollback();
  EXPECT_THAT(Turn({}, {"r1 at hall"}), IsEmpty());
  EXPECT_THAT(Turn({}, {"r1 task t1"}), IsEmpty());
  EXPECT_THAT(Turn({"r1 at yard"}), ElementsAre("1 rose"));
}

TEST_F(StandingConditionsTest, AMovingExtremeFlipsTheThresholdsThatItCrosses) {
  for (int i = 1; i <= 30; ++i) Register("ASK { ?r :load ?l FILTER(?l > " + std::to_string(i) + ") }");
  EXPECT_EQ(Turn({"a load 20.5"}).size(), 20u);
  EXPECT_THAT(Turn({"b load 21.5"}), ElementsAre("21 rose"));
  EXPECT_THAT(Turn({}, {"b load 21.5"}), ElementsAre("21 fell"));
  EXPECT_EQ(Turn({"c load 12"}, {"a load 20.5"}).size(), 9u) << "12 to 20 fall";
  EXPECT_THAT(Turn({"d load 13"}), ElementsAre("12 rose"));
  Register("ASK { ?r :load ?l FILTER(?l > 12.5) }");
  set_.Remove(ConditionId(12));
  EXPECT_THAT(Turn({}, {"d load 13"}), ElementsAre("31 fell"));
  Commit();
  EXPECT_THAT(Turn({"e load 15"}), ElementsAre("13 rose", "14 rose", "31 rose"));
  EXPECT_EQ(Turn({}, {"e load 15", "c load 12"}).size(), 14u);
  EXPECT_EQ(Turn({"f load 99"}).size(), 30u);
}

TEST_F(StandingConditionsTest, MinusOptionalUnionAndExists) {
  const ConditionId minus = Register("ASK { ?x :p ?y MINUS { ?x :q ?z } }");
  const ConditionId no_label = Register("ASK { ?x :p ?y OPTIONAL { ?x :label ?l } FILTER(!BOUND(?l)) }");
  const ConditionId either = Register("ASK { { ?x :p :never } UNION { ?x :q ?z } }");
  const ConditionId exists = Register("ASK { ?x :p ?y FILTER EXISTS { ?y :q ?x } }");
  EXPECT_THAT(Turn({"a p b"}), ElementsAre("1 rose", "2 rose"));
  EXPECT_THAT(Turn({"a q c", "a label 'A"}), ElementsAre("1 fell", "2 fell", "3 rose"));
  EXPECT_THAT(Turn({"b q a"}), ElementsAre("4 rose"));
  EXPECT_THAT(Turn({}, {"a q c", "a label 'A", "b q a"}),
              ElementsAre("1 rose", "2 rose", "3 fell", "4 fell"));
  EXPECT_TRUE(set_.Holds(minus) && set_.Holds(no_label));
  EXPECT_FALSE(set_.Holds(either) || set_.Holds(exists));
}

TEST_F(StandingConditionsTest, SubSelectsAndPathsAreFollowedWhole) {
  Register(
      "ASK { ?hall a :Hall { SELECT ?hall (COUNT(?v) AS ?n) { ?v :in ?hall } GROUP BY ?hall } FILTER(?n >= "
      "2) }");
  EXPECT_THAT(Turn({"h a Hall", "v1 in h"}), IsEmpty());
  EXPECT_THAT(Turn({"v2 in h"}), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({}, {"v1 in h"}), ElementsAre("1 fell"));
}

TEST_F(StandingConditionsTest, WhatDependsOnTheClockIsAskedAtEveryUpdate) {
  Register("ASK { :a :due ?t FILTER(NOW() > \"2026-01-01T00:00:00Z\"^^xsd:dateTime) }");
  Turn({"a due 5"});
  EXPECT_THAT(Turn({}, {}, TimeMicros{1767225601} * 1000000), ElementsAre("1 rose"));
  EXPECT_THAT(Turn({}, {}, TimeMicros{1767225599} * 1000000), ElementsAre("1 fell"));
}

TEST_F(StandingConditionsTest, KeyBindingsAppearAndDisappear) {
  const ConditionId id = Register("ASK { ?v a :Visitor . ?v :at ?b . ?b :in :hall }", {"v"});
  EXPECT_THAT(Turn({"ann a Visitor", "ann at b1", "b1 in hall", "b2 in hall"}),
              ElementsAre("1 rose +{v=ann}"));
  EXPECT_THAT(Turn({"bob a Visitor", "bob at b1", "cyd a Visitor", "cyd at b2"}),
              ElementsAre("1 bindings +{v=bob} +{v=cyd}"));
  EXPECT_THAT(Turn({"ann at b2"}, {"ann at b1"}), IsEmpty()) << "another way to be there";
  EXPECT_THAT(Turn({}, {"b1 in hall"}), ElementsAre("1 bindings -{v=bob}"));
  EXPECT_THAT(Texts(set_.Keys(id)), ElementsAre("{v=ann}", "{v=cyd}"));
  EXPECT_THAT(Turn({}, {"ann at b2", "cyd at b2"}), ElementsAre("1 fell -{v=ann} -{v=cyd}"));
  EXPECT_THAT(Turn({"ann at b2"}), ElementsAre("1 rose +{v=ann}")) << "it appears again";
}

// Few keys are searched linearly, many are hashed.
TEST_F(StandingConditionsTest, FewKeysBecomeManyAndFewAgain) {
  const ConditionId id = Register("ASK { ?r :task ?t . ?t :for :John }", {"r"});
  Turn({"t for John"});
  Commit();
  const auto robots = [](int from, int to) {
    std::vector<std::string> facts;
    for (int i = from; i < to; ++i) facts.push_back("r" + std::to_string(i) + " task t");
    return facts;
  };
  EXPECT_THAT(Turn({"r10 task t"}), ElementsAre("1 rose +{r=r10}"));
  EXPECT_THAT(Turn(robots(11, 17)), ElementsAre(::testing::StartsWith("1 bindings +{r=r11}")));
  EXPECT_THAT(Turn({}, {"r13 task t"}), ElementsAre("1 bindings -{r=r13}"));
  EXPECT_THAT(Turn({"r20 task t"}), ElementsAre("1 bindings +{r=r20}"));
  Commit();
  EXPECT_EQ(set_.Keys(id).size(), 7u);
  Turn(robots(21, 40), {"r11 task t"});
  EXPECT_EQ(set_.Keys(id).size(), 25u);
  Rollback();
  EXPECT_THAT(Texts(set_.Keys(id)),
              ElementsAre("{r=r10}", "{r=r11}", "{r=r12}", "{r=r14}", "{r=r15}", "{r=r16}", "{r=r20}"));
  Turn(robots(21, 40));
  EXPECT_THAT(Turn({}, {"r30 task t"}), ElementsAre("1 bindings -{r=r30}"));
  EXPECT_THAT(Turn({"r30 task t"}), ElementsAre("1 bindings +{r=r30}"));
  EXPECT_THAT(Turn({}, {"t for John"}), ElementsAre(::testing::StartsWith("1 fell -{r=r10}")));
  EXPECT_THAT(set_.Keys(id), IsEmpty());
  EXPECT_THAT(Turn({"t for John"}), ElementsAre(::testing::StartsWith("1 rose +{r=r10}")));
  EXPECT_EQ(set_.Keys(id).size(), 26u);
}

TEST_F(StandingConditionsTest, KeysOfAUnionAreThoseOfTheQuery) {
  const ConditionId id = Register("ASK { { ?x :p :c } UNION { ?y :q :d } }", {"x"});
  EXPECT_THAT(Turn({"a p c"}), ElementsAre("1 rose +{x=a}"));
  EXPECT_THAT(Turn({"b q d"}), ElementsAre("1 bindings +{}"));
  EXPECT_THAT(Turn({"e p c"}), ElementsAre("1 bindings +{x=e}"));
  EXPECT_THAT(Turn({}, {"b q d"}), ElementsAre("1 bindings -{}"));
  EXPECT_EQ(set_.Keys(id).size(), 2u);
}

TEST_F(StandingConditionsTest, SolutionsComeInTermOrderUpToTheLimit) {
  world_.Apply({"r at b2", "r at b1", "r at b3", "r at b1 @other"});
  const ConditionId id = Register("ASK { ?r :at ?b . FILTER NOT EXISTS { ?b a [] } }");
  const auto two = set_.Solutions(id, world_.writer.current(), {}, 2);
  ASSERT_TRUE(two.ok());
  EXPECT_THAT(Texts(*two), ElementsAre("{r=r,b=b1}", "{r=r,b=b2}"));
  EXPECT_EQ(set_.Solutions(ConditionId(99), world_.writer.current(), {}, 2).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(StandingConditionsTest, SolutionsAgreeWithTheFixedValues) {
  world_.Apply({"r at b1", "s at b1", "r at b2", "r q x"});
  const auto solutions = [&](ConditionId id, const char* name, const char* value) {
    const auto found = set_.Solutions(id, world_.writer.current(), {{name, world_.Id(value)}}, 10);
    return found.ok() ? Texts(*found) : std::vector<std::string>{found.status().ToString()};
  };
  const ConditionId flat = Register("ASK { ?r :at ?b }");
  EXPECT_THAT(solutions(flat, "r", "r"), ElementsAre("{r=r,b=b1}", "{r=r,b=b2}"));
  EXPECT_THAT(solutions(flat, "b", "b1"), ElementsAre("{r=r,b=b1}", "{r=s,b=b1}"));
  EXPECT_THAT(solutions(flat, "b", "b9"), IsEmpty());
  EXPECT_THAT(solutions(flat, "other", "r"), IsEmpty());
  // ?x is bound in some solutions only: those that leave it open do not have the value
  const ConditionId open = Register("ASK { ?r :at ?b OPTIONAL { ?r :q ?x } }");
  EXPECT_THAT(solutions(open, "x", "x"), ElementsAre("{r=r,b=b1,x=x}", "{r=r,b=b2,x=x}"));
}

TEST_F(StandingConditionsTest, RemovedConstraintsAreSilent) {
  const ConditionId a = Register("ASK { :a :p ?x }");
  const ConditionId b = Register("ASK { :a :p ?x }");
  EXPECT_EQ(set_.size(), 2u);
  set_.Remove(a);
  EXPECT_THAT(Turn({"a p b"}), ElementsAre("2 rose"));
  Commit();
  EXPECT_FALSE(set_.Holds(a));
  EXPECT_TRUE(set_.Holds(b));
  set_.Remove(b);
  set_.Remove(b);
  Commit();
  EXPECT_EQ(set_.size(), 0u);
  EXPECT_THAT(Turn({}, {"a p b"}), IsEmpty());
  EXPECT_THAT(Turn({"a p b"}), IsEmpty());
}

TEST_F(StandingConditionsTest, RollbackForgetsTheTurn) {
  const ConditionId kept = Register("ASK { ?x :p ?y . ?y :q ?z }");
  const ConditionId keys = Register("ASK { ?x :p ?y }", {"x"});
  Turn({"a p b", "b q c"});
  Commit();
  Turn({"d p e"}, {"b q c", "a p b"});
  const auto inside = set_.Register(world_.Parse("ASK { :d :p ?x }"), world_.writer.current());
  ASSERT_TRUE(inside.ok());
  set_.Remove(keys);
  EXPECT_FALSE(set_.Holds(kept));
  Rollback();
  EXPECT_TRUE(set_.Holds(kept));
  EXPECT_FALSE(set_.Holds(*inside));
  EXPECT_EQ(set_.size(), 2u);
  EXPECT_THAT(Texts(set_.Keys(keys)), ElementsAre("{x=a}"));
  EXPECT_THAT(Turn({}, {"b q c"}), ElementsAre("1 fell"));
  EXPECT_THAT(Turn({"d p b"}, {"a p b"}), ElementsAre("2 bindings +{x=d} -{x=a}"));
}

// A condition that watched only the pattern without a match must not miss the pattern without a match after a
// rollback.
TEST_F(StandingConditionsTest, RollbackRestoresWhatIsWatched) {
  Register("ASK { ?x :p ?y . ?y :q ?z }");
  Turn({"b q c"});
  Commit();
  Turn({"a p b"}, {"b q c"});
  Rollback();
  EXPECT_THAT(Turn({"a p b"}), ElementsAre("1 rose"));
}

TEST_F(StandingConditionsTest, RegisteringWhatASilentlyRemovedOneAskedStartsAnew) {
  const ConditionId first = Register("ASK { :a :p ?x }");
  set_.Remove(first);
  const ConditionId second = Register("ASK { :a :p ?x }");
  EXPECT_THAT(Turn({"a p b"}), ElementsAre("2 rose"));
  EXPECT_TRUE(set_.Holds(second));
}

TEST_F(StandingConditionsTest, OnlyWhatAChangeCanTouchIsEvaluated) {
  for (int i = 0; i < 500; ++i) {
    Register("ASK { ?v :at ?b . ?b :in :hall" + std::to_string(i) + " }");
    Register("ASK { :r" + std::to_string(i) + " :at ?b FILTER NOT EXISTS { ?b :closed ?c } }");
  }
  Turn({"b1 in hall7"});
  const uint64_t before = set_.evaluations();
  EXPECT_THAT(Turn({"ann at b1"}), ElementsAre("15 rose"));
  EXPECT_LE(set_.evaluations() - before, 2u) << "the 499 halls without a booth do not watch who is where";
}

TEST_F(StandingConditionsTest, AConditionThatABulkOfChangesMatchesIsEvaluatedOnce) {
  Register("ASK { ?x :p ?y . ?y :q :end }");
  const ConditionId keys = Register("ASK { ?x :p ?y . ?y :r ?z }", {"x"});
  std::vector<std::string> bulk = {"n5 r z"};
  for (int i = 0; i < 2000; ++i) bulk.push_back("m" + std::to_string(i) + " p n" + std::to_string(i % 10));
  Turn({"n1 q end"});
  const uint64_t before = set_.evaluations();
  EXPECT_EQ(Turn(bulk).size(), 2u);
  EXPECT_LE(set_.evaluations() - before, 3u);
  EXPECT_EQ(set_.Keys(keys).size(), 200u);
}

TEST_F(StandingConditionsTest, WrongQueriesAreRefused) {
  EXPECT_EQ(
      set_.Register(world_.Parse("ASK { :a :p ?x }"), world_.writer.current(), {{"nope"}, 0}).status().code(),
      absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(
      set_.Register(world_.Parse("CONSTRUCT WHERE { :a :p ?x }"), world_.writer.current()).status().code(),
      absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(
      set_.Register(world_.Parse("ASK { :a :p ?x FILTER(:nope(?x)) }"), world_.writer.current()).ok());
  EXPECT_EQ(set_.size(), 0u);
}

TEST_F(StandingConditionsTest, AChangeThatConcernsAllOfAShapeIsJoinedOnce) {
  Turn({"item7 ownedBy owner7", "item8 ownedBy owner8"});
  Commit();
  for (int i = 0; i < 100; ++i) {
    Register("ASK { ?v :carries ?i . ?i :ownedBy :owner" + std::to_string(i) + " }");
  }
  const uint64_t before = set_.evaluations();
  EXPECT_THAT(Turn({"zoe carries item7"}), ElementsAre("8 rose"));
  EXPECT_LE(set_.evaluations() - before,
            8u);  // the few registered before there was a template_, and the template
  EXPECT_THAT(Turn({"zoe carries nothing"}), IsEmpty());
  EXPECT_THAT(Turn({"zoe carries item8"}, {"zoe carries item7"}), ElementsAre("8 fell", "9 rose"));
  Rollback();
  EXPECT_THAT(Turn({"zoe carries item8", "item8 ownedBy owner50"}), ElementsAre("9 rose", "51 rose"));
}

TEST_F(StandingConditionsTest, AShapeWithMoreSolutionsThanConstraintsAsksThemOneByOne) {
  std::vector<std::string> quads;
  for (int i = 0; i < 500; ++i) quads.push_back("hub links leaf" + std::to_string(i));
  Turn(quads);
  Commit();
  for (int i = 0; i < 20; ++i) Register("ASK { ?v :at ?h . ?h :links :leaf" + std::to_string(25 * i) + " }");
  EXPECT_EQ(Turn({"zoe at hub"}).size(), 20u);
  EXPECT_EQ(Turn({}, {"zoe at hub"}).size(), 20u);
}

// A condition that holds keeps watching; after a hit without effect it stops, and must watch again when it
// falls.
TEST_F(StandingConditionsTest, WhatHoldsAndIsHitInVainRisesAgainAfterItFell) {
  for (int i = 0; i < 20; ++i) Register("ASK { ?v :at :room . ?v :wants :topic" + std::to_string(i) + " }");
  Turn({"ann at room", "bob at room"});
  Commit();
  for (int round = 0; round < 3; ++round) {
    EXPECT_THAT(Turn({"ann wants topic7"}), ElementsAre("8 rose"));
    Commit();
    EXPECT_THAT(Turn({"bob wants topic7"}), IsEmpty());
    Commit();
    EXPECT_THAT(Turn({}, {"ann wants topic7"}), IsEmpty()) << "bob does";
    Commit();
    EXPECT_THAT(Turn({}, {"bob wants topic7"}), ElementsAre("8 fell"));
    Commit();
  }
}

TEST_F(StandingConditionsTest, NegationsThatDifferInOneConstantShareTheirBody) {
  std::vector<std::string> quads;
  for (int i = 0; i < 20; ++i) quads.push_back("p" + std::to_string(i) + " at hall");
  Turn(quads);
  Commit();
  for (int i = 0; i < 20; ++i) {
    const std::string p = ":p" + std::to_string(i);
    EXPECT_TRUE(set_.Holds(Register("ASK { " + p + " :at ?r . FILTER NOT EXISTS { " + p + " :badge ?b } }")));
  }
  EXPECT_THAT(Turn({"p9 badge b1"}), ElementsAre("10 fell"));
  Commit();
  EXPECT_THAT(Turn({"p9 badge b2"}, {"p9 badge b1"}), IsEmpty());
  Commit();
  EXPECT_THAT(Turn({"p3 badge b1"}, {"p9 badge b2"}), ElementsAre("4 fell", "10 rose"));
  Rollback();
  EXPECT_THAT(Turn({}, {"p9 badge b2", "p3 at hall"}), ElementsAre("4 fell", "10 rose"));
}

uint64_t FakeNanos() {
  static uint64_t now = 0;
  return now += 10;
}

TEST_F(StandingConditionsTest, EvaluationsThatNothingNarrowsAreCounted) {
  set_.SetStopWatch(FakeNanos);
  Register("ASK { ?s :until ?t . FILTER(?t < NOW()) }");
  Register("ASK { ?v :at :room }");
  Turn({"ann at room"});
  EXPECT_EQ(set_.counters().whole_evaluations, 1u) << "NOW() alone";
  EXPECT_EQ(set_.counters().whole_ns, 10u);
}

}  // namespace
}  // namespace docent::conditions
