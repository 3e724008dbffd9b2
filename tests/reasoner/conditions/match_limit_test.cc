// A condition keeps so many matches, or as many as the graph has facts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "reasoner/conditions/standing_conditions.h"
#include "tests/reasoner/test_world.h"

namespace docent::conditions {
namespace {

class MatchLimitTest : public ::testing::Test {
 protected:
  MatchLimitTest() { set_.LimitMatches(30); }

  ConditionId Register(const std::string& ask, const std::vector<std::string>& keys) {
    const auto id = set_.Register(world_.Parse(ask), world_.writer.current(), {keys, 0});
    EXPECT_TRUE(id.ok()) << id.status();
    return id.value_or(ConditionId());
  }
  // `count` facts from number `first` on.
  Delta Add(int first, int count) {
    std::vector<std::string> facts;
    for (int i = first; i < first + count; ++i) facts.push_back(absl::StrCat("x", i, " p y", i));
    return world_.Apply(facts, {});
  }
  // Which conditions overflow by it.
  std::vector<ConditionId> Update(const Delta& delta) {
    const auto changes = set_.Update(world_.writer.current(), delta, 0);
    EXPECT_TRUE(changes.ok()) << changes.status();
    std::vector<ConditionId> overflowed;
    for (const ConditionChange& change : *changes) {
      if (change.overflowed) overflowed.push_back(change.id);
    }
    return overflowed;
  }
  void Commit() {
    set_.Commit();
    world_.writer.Freeze(Revision(++revision_));
  }

  TestWorld world_;
  StandingConditions set_{world_.dictionary};
  uint64_t revision_ = 0;
};

constexpr char kPairs[] = "ASK { ?a :p ?b . ?c :p ?d }";
const std::vector<std::string> kAll = {"a", "b", "c", "d"};

TEST_F(MatchLimitTest, PairsOfFactsOverflowWhenRegistered) {
  Update(Add(0, 5));
  Commit();
  EXPECT_FALSE(set_.Overflowed(Register(kPairs, kAll))) << "25";
  set_.Rollback();
  Update(Add(5, 1));
  Commit();
  EXPECT_TRUE(set_.Overflowed(Register(kPairs, kAll))) << "36";
}

TEST_F(MatchLimitTest, PairsOfFactsOverflowWhenFactsCome) {
  Update(Add(0, 5));
  const ConditionId id = Register(kPairs, kAll);
  Commit();
  EXPECT_THAT(Update(Add(5, 1)), testing::ElementsAre(id));
  EXPECT_TRUE(set_.Overflowed(id));
}

TEST_F(MatchLimitTest, ARollbackTakesTheOverflowBack) {
  Update(Add(0, 5));
  const ConditionId id = Register(kPairs, kAll);
  Commit();
  EXPECT_THAT(Update(Add(5, 1)), testing::ElementsAre(id));
  set_.Rollback();
  world_.writer.Rollback();
  EXPECT_FALSE(set_.Overflowed(id));
  EXPECT_EQ(set_.Keys(id).size(), 25u);
  Update(world_.Apply({}, {"x0 p y0"}));
  EXPECT_EQ(set_.Keys(id).size(), 16u);
}

TEST_F(MatchLimitTest, AsManyAsTheGraphHasFactsAreKept) {
  const ConditionId id = Register("ASK { ?a :p ?b }", {"a", "b"});
  Commit();
  EXPECT_TRUE(Update(Add(0, 100)).empty());
  EXPECT_EQ(set_.Keys(id).size(), 100u);
}

TEST_F(MatchLimitTest, SolutionsAreTheFirstOfThoseThatAreKept) {
  Update(Add(0, 6));
  const ConditionId level = Register(kPairs, {});
  const auto too_many = set_.Solutions(level, world_.writer.current(), {}, 3);
  EXPECT_TRUE(absl::IsResourceExhausted(too_many.status())) << too_many.status();
  set_.LimitMatches(36);
  const auto all = set_.Solutions(level, world_.writer.current(), {}, SIZE_MAX);
  const auto first = set_.Solutions(level, world_.writer.current(), {}, 3);
  ASSERT_TRUE(all.ok() && first.ok());
  EXPECT_EQ(all->size(), 36u);
  EXPECT_EQ(*first, std::vector<Binding>(all->begin(), all->begin() + 3));
}

// Twenty times as many as of one.
TEST_F(MatchLimitTest, MatchesOfAllConditionsTogetherAreLimitedAtTheLimitAndOnePast) {
  Cancellation cancellation;
  for (int i = 0; i < 20; ++i) Register(absl::StrCat("ASK { ?a :p ?b . ?a :p ?c", i, " }"), {"a"});
  Register("ASK { ?x :q ?y }", {"x"});
  set_.Commit();
  const auto update = [&](const Delta& delta) {
    return set_.Update(world_.writer.current(), delta, 0, &cancellation).status();
  };
  EXPECT_TRUE(update(Add(0, 30)).ok()) << "600";
  Commit();
  const absl::Status more = update(world_.Apply({"y q z"}));
  EXPECT_EQ(more.code(), absl::StatusCode::kResourceExhausted) << more;
  EXPECT_THAT(std::string(more.message()), ::testing::HasSubstr("the limit is matches_live"));
  set_.Rollback();
  world_.writer.Rollback();
  EXPECT_TRUE(update(world_.Apply({"y q z"}, {"x0 p y0"})).ok()) << "581";
  Commit();
  const auto refused = set_.Register(world_.Parse("ASK { ?x :p ?y . ?x :p ?z }"), world_.writer.current(),
                                     {{"x", "y"}, 0, &cancellation});
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
  set_.Rollback();
  EXPECT_EQ(set_.size(), 21u);
  EXPECT_TRUE(
      set_.Register(world_.Parse("ASK { ?x :p ?y . ?x :p ?z }"), world_.writer.current(), {{"x", "y"}, 0})
          .ok())
      << "as a log is replayed";
}

TEST_F(MatchLimitTest, MatchesCostSteps) {
  set_.LimitMatches(SIZE_MAX);
  for (int i = 0; i < 50; ++i) Register(absl::StrCat("ASK { ?a :p ?b . ?a :p ?c", i, " }"), {"a"});
  set_.Commit();
  Cancellation cancellation;
  cancellation.AllowSteps(1000000);
  const auto changes = set_.Update(world_.writer.current(), Add(0, 200), 0, &cancellation);  // 10,000 matches
  EXPECT_EQ(changes.status().code(), absl::StatusCode::kResourceExhausted);
  set_.Rollback();
  world_.writer.Rollback();
  cancellation.AllowSteps(50000000);
  EXPECT_TRUE(set_.Update(world_.writer.current(), Add(0, 200), 0, &cancellation).ok());
}

}  // namespace
}  // namespace docent::conditions
