#include "reasoner/conditions/lasting_condition.h"

#include "gmock/gmock.h"
#include "graph/rdf/dictionary.h"
#include "gtest/gtest.h"

namespace docent::conditions {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class LastingConditionTest : public ::testing::Test {
 protected:
  Binding Of(const std::string& x) { return {{"x", Id(x)}}; }
  Binding Of(const std::string& x, const std::string& y) { return {{"x", Id(x)}, {"y", Id(y)}}; }
  TermId Id(const std::string& name) { return dictionary_.InternIri("urn:" + name); }

  Dictionary dictionary_;
  // "?x is there for 5 (and ?y)", told by ?x.
  LastingCondition one_{{"x"}, {{{"x"}, 5}}};
};

TEST_F(LastingConditionTest, OpensOnceWhenTheTimeIsFull) {
  one_.SetPart(0, Of("a"), true, 10);
  one_.SetWhole(Of("a"), true);
  EXPECT_FALSE(one_.Settle(10).any());
  EXPECT_EQ(one_.NextDeadline(), 15);
  EXPECT_FALSE(one_.Settle(14).any());
  EXPECT_FALSE(one_.Admits(Of("a")));
  const LastingCondition::Changes changes = one_.Settle(15);
  EXPECT_TRUE(changes.rose);
  EXPECT_THAT(changes.appeared, ElementsAre(Of("a")));
  EXPECT_TRUE(one_.holds());
  EXPECT_TRUE(one_.Admits(Of("a")));
  EXPECT_EQ(one_.NextDeadline(), std::nullopt);
  EXPECT_FALSE(one_.Settle(100).any());
}

TEST_F(LastingConditionTest, ABreakBeginsTheTimeAnew) {
  one_.SetPart(0, Of("a"), true, 10);
  one_.SetWhole(Of("a"), true);
  one_.Settle(10);
  one_.SetPart(0, Of("a"), false, 14);
  one_.SetWhole(Of("a"), false);
  EXPECT_FALSE(one_.Settle(14).any());
  EXPECT_EQ(one_.NextDeadline(), std::nullopt);
  one_.SetPart(0, Of("a"), true, 16);
  one_.SetWhole(Of("a"), true);
  EXPECT_FALSE(one_.Settle(20).any());
  EXPECT_TRUE(one_.Settle(21).rose);
}

TEST_F(LastingConditionTest, WhatEndsWhenItsTimeIsFullOpensNothing) {
  one_.SetPart(0, Of("a"), true, 10);
  one_.SetWhole(Of("a"), true);
  one_.Settle(10);
  one_.SetPart(0, Of("a"), false, 15);
  one_.SetWhole(Of("a"), false);
  EXPECT_FALSE(one_.Settle(15).any());
}

TEST_F(LastingConditionTest, EachBindingHasItsOwnTime) {
  for (const auto& [name, begins] : {std::pair("a", 10), std::pair("b", 12)}) {
    one_.SetPart(0, Of(name), true, begins);
    one_.SetWhole(Of(name), true);
  }
  EXPECT_THAT(one_.Settle(15).appeared, ElementsAre(Of("a")));
  const LastingCondition::Changes second = one_.Settle(17);
  EXPECT_FALSE(second.rose);
  EXPECT_THAT(second.appeared, ElementsAre(Of("b")));
  one_.SetWhole(Of("a"), false);
  const LastingCondition::Changes third = one_.Settle(18);
  EXPECT_FALSE(third.fell);
  EXPECT_THAT(third.disappeared, ElementsAre(Of("a")));
  one_.SetPart(0, Of("b"), false, 18);
  EXPECT_TRUE(one_.Settle(18).fell);
}

// The visitor's time has passed long before the robot comes: it opens when the robot comes.
TEST_F(LastingConditionTest, TheRestOfTheWholeHasNoTime) {
  LastingCondition condition({"x", "y"}, {{{"x"}, 5}});
  condition.SetPart(0, Of("a"), true, 10);
  condition.Settle(10);
  EXPECT_FALSE(condition.Settle(15).any());
  condition.SetWhole(Of("a", "r"), true);
  EXPECT_THAT(condition.Settle(40).appeared, ElementsAre(Of("a", "r")));
  condition.SetWhole(Of("a", "s"), true);
  EXPECT_THAT(condition.Settle(41).appeared, ElementsAre(Of("a", "s")));
  EXPECT_FALSE(condition.Admits(Of("b", "r")));
}

TEST_F(LastingConditionTest, AllPartsMustHaveTheirTime) {
  LastingCondition condition({}, {{{"x"}, 5}, {{"y"}, 8}});
  EXPECT_THAT(condition.variables(), ElementsAre("x", "y"));
  condition.SetPart(0, Of("a"), true, 0);
  condition.SetPart(1, {{"y", Id("r")}}, true, 1);
  condition.SetWhole(Of("a", "r"), true);
  EXPECT_FALSE(condition.Settle(8).any());
  EXPECT_EQ(condition.NextDeadline(), 9);
  const LastingCondition::Changes changes = condition.Settle(9);
  EXPECT_TRUE(changes.rose);
  EXPECT_THAT(changes.appeared, IsEmpty()) << "nobody asked for keys";
}

TEST_F(LastingConditionTest, RollbackIsAsIfNothingHadBeen) {
  one_.SetPart(0, Of("a"), true, 10);
  one_.SetWhole(Of("a"), true);
  one_.Settle(10);
  one_.Commit();
  one_.SetPart(0, Of("b"), true, 15);
  one_.SetWhole(Of("b"), true);
  EXPECT_TRUE(one_.Settle(15).rose);
  one_.SetPart(0, Of("a"), false, 15);
  one_.SetWhole(Of("a"), false);
  EXPECT_TRUE(one_.Settle(15).fell);
  one_.Rollback();
  EXPECT_FALSE(one_.holds());
  EXPECT_EQ(one_.NextDeadline(), 15);
  EXPECT_THAT(one_.Settle(15).appeared, ElementsAre(Of("a")));
  EXPECT_FALSE(one_.Settle(30).any()) << "b was never there";
}

TEST_F(LastingConditionTest, TimesArePutBack) {
  one_.SetPart(0, Of("a"), true, 10);
  one_.SetPart(0, Of("b"), true, 13);
  one_.SetWhole(Of("a"), true);
  one_.SetWhole(Of("b"), true);
  one_.Settle(16);
  LastingCondition other({"x"}, {{{"x"}, 5}});
  for (const char* name : {"a", "b"}) {
    other.SetPart(0, Of(name), true, 100);
    other.SetWhole(Of(name), true);
  }
  for (const LastingCondition::Since& since : one_.Times()) other.SetTime(since);
  EXPECT_THAT(other.Settle(0).appeared, ElementsAre(Of("a")));
  EXPECT_EQ(other.NextDeadline(), 18);
  EXPECT_THAT(other.Settle(18).appeared, UnorderedElementsAre(Of("b")));
}

}  // namespace
}  // namespace docent::conditions
