// Small loads with many consequences: their cost, and that they are refused beyond the limit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/test_world.h"

namespace docent::rules {
namespace {

using ::testing::HasSubstr;
using Facts = std::vector<std::string>;

// "a0 p a1", "a1 p a2", …
Facts Chain(const std::string& property, int length) {
  Facts facts;
  for (int i = 1; i < length; ++i) facts.push_back(absl::StrCat("n", i - 1, " ", property, " n", i));
  return facts;
}
// "a0 p a1", "a0 p a2", …
Facts Star(const std::string& property, int size) {
  Facts facts;
  for (int i = 1; i < size; ++i) facts.push_back(absl::StrCat("n0 ", property, " n", i));
  return facts;
}
// `whole` has a list of `size` classes, properties or things at `property`.
Facts List(const std::string& whole, const std::string& property, int size) {
  Facts facts = {absl::StrCat(whole, " ", property, " l0")};
  for (int i = 0; i < size; ++i) {
    facts.push_back(absl::StrCat("l", i, " rdf:first n", i));
    facts.push_back(absl::StrCat("l", i, " rdf:rest ", i + 1 < size ? absl::StrCat("l", i + 1) : "rdf:nil"));
  }
  return facts;
}
Facts Together(Facts facts, const Facts& more) {
  facts.insert(facts.end(), more.begin(), more.end());
  return facts;
}

class DearLoad {
 public:
  DearLoad() {
    EXPECT_TRUE(engine_.PutRules("owl2rl", BuiltInRuleSet("owl2rl")).empty());
    EXPECT_TRUE(Update({}, {}, Limits{}.steps_per_turn).ok());
  }
  // Allows `steps` steps; spent_ is then the number used.
  absl::Status Update(const Facts& add, const Facts& remove, uint64_t steps) {
    Cancellation cancellation;
    cancellation.AllowSteps(steps);
    const absl::StatusOr<Delta> delta =
        engine_.Update(world_.writer, world_.Apply(add, remove), &cancellation);
    spent_ = steps - static_cast<uint64_t>(std::max<int64_t>(cancellation.steps_left(), 0));
    if (!delta.ok()) {
      engine_.Rollback();
      world_.writer.Rollback();
      return delta.status();
    }
    engine_.Commit();
    world_.writer.Commit();
    return absl::OkStatus();
  }
  bool Holds(const std::string& fact) {
    const Quad quad = world_.QuadOf(fact);
    return world_.writer.current().ContainsMatch({quad.subject, quad.predicate, quad.object, TermId()});
  }
  size_t size() const { return world_.writer.current().size(); }
  uint64_t firings() const { return engine_.counters().firings; }
  uint64_t spent() const { return spent_; }

 private:
  TestWorld world_;
  RuleEngine engine_{world_.dictionary};
  uint64_t spent_ = 0;
};

constexpr uint64_t kAnySteps = uint64_t{1} << 60;

// The rules alone would make the pairs of n equal things n times each.
TEST(EqualThings, PairsAreMadeOnceEach) {
  for (const Facts& told : {Star("owl:sameAs", 200), Chain("owl:sameAs", 200)}) {
    DearLoad load;
    const uint64_t before = load.firings();
    const size_t size = load.size();
    ASSERT_TRUE(load.Update(told, {}, kAnySteps).ok());
    EXPECT_EQ(load.size() - size, 200u * 200u);
    EXPECT_EQ(load.firings() - before, 200u * 200u);
    EXPECT_TRUE(load.Holds("n199 owl:sameAs n17"));
    EXPECT_TRUE(load.Holds("n17 owl:sameAs n17"));
  }
}

TEST(EqualThings, OneMoreCostsItsOwnPairs) {
  DearLoad load;
  ASSERT_TRUE(load.Update(Star("owl:sameAs", 300), {}, kAnySteps).ok());
  ASSERT_TRUE(load.Update({"n0 likes x", "y likes n1"}, {}, kAnySteps).ok());
  const uint64_t firings = load.firings();
  ASSERT_TRUE(load.Update({"n7 owl:sameAs late"}, {}, 1000000).ok());
  EXPECT_LT(load.firings() - firings, 1000u);
  EXPECT_TRUE(load.Holds("late owl:sameAs n299"));
  EXPECT_TRUE(load.Holds("late likes x"));
  EXPECT_TRUE(load.Holds("y likes late"));
}

TEST(EqualThings, OnePairLessCostsALookAtTheirFacts) {
  DearLoad load;
  ASSERT_TRUE(load.Update(Together(Star("owl:sameAs", 300), {"n0 likes x"}), {}, kAnySteps).ok());
  ASSERT_TRUE(load.Update({}, {"n0 owl:sameAs n7"}, 10000000).ok());
  EXPECT_FALSE(load.Holds("n7 owl:sameAs n8"));
  EXPECT_FALSE(load.Holds("n7 likes x"));
  EXPECT_TRUE(load.Holds("n8 likes x"));
  EXPECT_TRUE(load.Holds("n8 owl:sameAs n299"));
}

// A fact under the names of two terms: n² facts, each of them once.
TEST(EqualThings, AFactAmongThemIsWrittenOutOnceUnderEachName) {
  DearLoad load;
  const uint64_t before = load.firings();
  ASSERT_TRUE(load.Update(Together(Star("owl:sameAs", 100), {"n3 knows n4"}), {}, kAnySteps).ok());
  EXPECT_EQ(load.firings() - before, 2u * 100u * 100u);
  EXPECT_TRUE(load.Holds("n99 knows n98"));
}

// Cutting a long chain leaves half of its consequences without a proof, and each search for one was long.
TEST(Chains, CuttingOneDoesNotLookForProofsForEver) {
  DearLoad load;
  ASSERT_TRUE(load.Update(Together({"p a owl:TransitiveProperty"}, Chain("p", 200)), {}, kAnySteps).ok());
  const uint64_t to_build = load.spent();
  ASSERT_TRUE(load.Update({}, {"n99 p n100"}, kAnySteps).ok());
  EXPECT_LT(load.spent(), 3 * to_build);
  EXPECT_FALSE(load.Holds("n0 p n199"));
  EXPECT_TRUE(load.Holds("n0 p n99"));
  EXPECT_TRUE(load.Holds("n100 p n199"));
}

// Axioms about a list are joined pair by pair; each pair was compared with all others.
TEST(Lists, DisjointClassesCostTheirPairs) {
  DearLoad load;
  const Facts told = Together({"D a owl:AllDisjointClasses"}, List("D", "owl:members", 100));
  ASSERT_TRUE(load.Update(told, {}, 20000000).ok());
  ASSERT_TRUE(load.Update({"x a n3", "x a n4"}, {}, 1000000).ok());
  ASSERT_TRUE(load.Update({}, {"D a owl:AllDisjointClasses"}, 20000000).ok());
}

struct Case {
  std::string name;
  Facts told;
};
void PrintTo(const Case& each, std::ostream* out) {
  *out << each.name;
}

class DearLoads : public ::testing::TestWithParam<Case> {};

// With the steps of a small part of a second, so that the test is short. A refused load leaves no change, and
// the next one succeeds.
TEST_P(DearLoads, AreRefusedAndLeaveNothing) {
  DearLoad load;
  const size_t size = load.size();
  const uint64_t firings = load.firings();
  const absl::Status status = load.Update(GetParam().told, {}, 10000000);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("owl2rl "));
  EXPECT_THAT(std::string(status.message()), HasSubstr("the limits steps_per_turn and steps_per_fact"));
  EXPECT_LT(load.firings() - firings, 10000000u);
  EXPECT_EQ(load.size(), size);
  EXPECT_TRUE(load.Update({"n0 owl:sameAs n1", "n1 p n2"}, {}, 1000000).ok());
  EXPECT_TRUE(load.Holds("n0 p n2"));
}

INSTANTIATE_TEST_SUITE_P(
    OfEachKind, DearLoads,
    ::testing::Values(
        Case{"EqualThings", Star("owl:sameAs", 1000)}, Case{"ChainOfEqualThings", Chain("owl:sameAs", 1000)},
        Case{"FunctionalProperty", Together({"p a owl:FunctionalProperty"}, Star("p", 1000))},
        Case{"CardinalityOfOne",
             Together({"C owl:maxCardinality 1", "C owl:onProperty p", "n0 a C"}, Star("p", 1000))},
        Case{"TransitiveChain", Together({"p a owl:TransitiveProperty"}, Chain("p", 1000))},
        Case{"SymmetricTransitiveStar",
             Together({"p a owl:TransitiveProperty", "p a owl:SymmetricProperty"}, Star("p", 1000))},
        Case{"SubclassChain", Chain("rdfs:subClassOf", 1000)},
        Case{"EquivalentClasses", Star("owl:equivalentClass", 1000)},
        Case{"SubpropertyChain", Chain("rdfs:subPropertyOf", 1000)},
        Case{"EquivalentProperties", Star("owl:equivalentProperty", 1000)},
        Case{"PropertyChain", Together(Together({"p owl:propertyChainAxiom k", "k rdf:first p",
                                                 "k rdf:rest m", "m rdf:first p", "m rdf:rest rdf:nil"},
                                                Chain("p", 1000)),
                                       {})},
        Case{"DisjointClasses", Together({"D a owl:AllDisjointClasses"}, List("D", "owl:members", 1000))},
        Case{"DisjointProperties",
             Together({"D a owl:AllDisjointProperties"}, List("D", "owl:members", 1000))}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace docent::rules
