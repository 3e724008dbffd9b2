#include "reasoner/rules/stratification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Stratification, DependenciesComeFirst) {
  const Stratification s = Stratify(3, {{0, 1, true}, {1, 2, false}});
  EXPECT_THAT(s.negative_cycle, IsEmpty());
  EXPECT_LT(s.stratum[2], s.stratum[1]);
  EXPECT_LT(s.stratum[1], s.stratum[0]);
}

TEST(Stratification, PositiveRecursionSharesAStratum) {
  const Stratification s = Stratify(3, {{0, 1, false}, {1, 0, false}, {2, 0, true}});
  EXPECT_THAT(s.negative_cycle, IsEmpty());
  EXPECT_EQ(s.stratum[0], s.stratum[1]);
  EXPECT_GT(s.stratum[2], s.stratum[0]);
}

TEST(Stratification, ANegativeCycleIsShownFromTheNegation) {
  const Stratification s = Stratify(4, {{0, 1, false}, {1, 2, true}, {2, 3, false}, {3, 1, false}});
  EXPECT_THAT(s.negative_cycle, ElementsAre(1, 2, 3));
}

TEST(Stratification, ARuleThatNegatesItself) {
  EXPECT_THAT(Stratify(2, {{1, 1, true}}).negative_cycle, ElementsAre(1));
}

TEST(Stratification, ALongChainNeedsNoDeepStack) {
  constexpr uint32_t kRules = 200000;
  std::vector<RuleDependency> chain;
  for (uint32_t r = 0; r + 1 < kRules; ++r) chain.push_back({r, r + 1, false});
  const Stratification s = Stratify(kRules, chain);
  EXPECT_EQ(s.count, static_cast<int>(kRules));
  EXPECT_EQ(s.stratum[kRules - 1], 0);
}

}  // namespace
}  // namespace docent::rules
