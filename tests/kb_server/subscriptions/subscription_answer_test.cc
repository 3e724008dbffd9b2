#include "kb_server/subscriptions/subscription_answer.h"

#include <gtest/gtest.h>

#include <string>

namespace docent::server {
namespace {

// One row that stays and one with another value each time, long after the first values are useless.
TEST(SubscriptionAnswer, ComputedValuesComeAndGo) {
  Dictionary dictionary;
  SubscriptionAnswer answer(1, false, {"x"}, &dictionary, SubscriptionLimits{});
  for (uint64_t i = 1; i <= 5000; ++i) {
    SubscriptionAnswer::Rows rows;
    ++rows[{answer.Local(Term::Literal("stays"))}];
    ++rows[{answer.Local(Term::Literal(std::to_string(i)))}];
    ASSERT_EQ(answer.SetRows(Revision(i), std::move(rows), 0), i > 1);  // the first answer is no change
    if (i == 1) continue;
    const auto change = answer.Get(answer.newest());
    ASSERT_TRUE(change.ok() && *change != nullptr) << i;
    ASSERT_EQ((*change)->appeared.size(), 1u) << i;
    ASSERT_EQ((*change)->disappeared.size(), 1u) << i;
    EXPECT_EQ((*change)->appeared[0].values[0], Term::Literal(std::to_string(i)));
    EXPECT_EQ((*change)->disappeared[0].values[0], Term::Literal(std::to_string(i - 1)));
  }
  const AnswerChangePtr whole = answer.Whole();
  ASSERT_EQ(whole->appeared.size(), 2u);
  EXPECT_EQ(whole->appeared[0].values[0], Term::Literal("5000"));
  EXPECT_EQ(whole->appeared[1].values[0], Term::Literal("stays"));
}

// The same for a row that must last two rounds: the one that stays is reported, never those that disappear
// before.
TEST(SubscriptionAnswer, ComputedValuesThatMustLast) {
  Dictionary dictionary;
  SubscriptionAnswer answer(1, false, {"x"}, &dictionary, SubscriptionLimits{}, 2);
  for (uint64_t i = 1; i <= 5000; ++i) {
    SubscriptionAnswer::Rows rows;
    ++rows[{answer.Local(Term::Literal("stays"))}];
    ++rows[{answer.Local(Term::Literal(std::to_string(i)))}];
    const auto now_us = static_cast<TimeMicros>(i);
    ASSERT_FALSE(answer.SetRows(Revision(i), std::move(rows), now_us)) << i;
    ASSERT_EQ(answer.ripens_at_us(), i <= 3 ? 3 : now_us + 2) << i;
    ASSERT_EQ(answer.Ripen(Revision(i), now_us), i == 3) << i;
  }
  const AnswerChangePtr whole = answer.Whole();
  ASSERT_EQ(whole->appeared.size(), 1u);
  EXPECT_EQ(whole->appeared[0].values[0], Term::Literal("stays"));
  EXPECT_EQ(answer.size(), 2u);
}

void Become(SubscriptionAnswer* answer, uint64_t revision, const std::string& value) {
  SubscriptionAnswer::Rows rows;
  ++rows[{answer->Local(Term::Literal(value))}];
  answer->SetRows(Revision(revision), std::move(rows), 0);
}

TEST(SubscriptionAnswer, LargeChangesAreKeptUpToSoManyBytes) {
  Dictionary dictionary;
  SubscriptionLimits limits;
  limits.subscription_kept_bytes = 10000;
  SubscriptionAnswer answer(1, false, {"x"}, &dictionary, limits);
  for (uint64_t i = 1; i <= 20; ++i) Become(&answer, i, std::string(1000, static_cast<char>('a' + i)));
  ASSERT_EQ(answer.newest(), 19u);
  EXPECT_TRUE(answer.Get(19).ok());
  EXPECT_TRUE(answer.Get(17).ok());
  EXPECT_TRUE(absl::IsOutOfRange(answer.Get(10).status())) << "each has the old value and the new one";
  EXPECT_TRUE(absl::IsOutOfRange(answer.Sum(10).status()));
  Become(&answer, 21, std::string(1000000, 'x'));
  EXPECT_TRUE(answer.Get(20).ok()) << "the newest stays, however large";
  EXPECT_TRUE(absl::IsOutOfRange(answer.Get(19).status()));
}

TEST(SubscriptionAnswer, AllAnswersTogetherKeepSoManyBytes) {
  Dictionary dictionary;
  SubscriptionLimits limits;
  limits.subscriptions_kept_bytes = 10000;
  const auto all = std::make_shared<KeptBytes>(0);
  auto first = std::make_unique<SubscriptionAnswer>(1, false, std::vector<std::string>{"x"}, &dictionary,
                                                    limits, 0, all);
  SubscriptionAnswer second(2, false, {"x"}, &dictionary, limits, 0, all);
  for (uint64_t i = 1; i <= 4; ++i) Become(first.get(), i, std::string(1000, static_cast<char>('a' + i)));
  EXPECT_TRUE(first->Get(1).ok());
  for (uint64_t i = 1; i <= 4; ++i) Become(&second, i, std::string(1000, static_cast<char>('a' + i)));
  EXPECT_TRUE(second.Get(3).ok());
  EXPECT_TRUE(absl::IsOutOfRange(second.Get(1).status()));
  first.reset();
  for (uint64_t i = 5; i <= 6; ++i) Become(&second, i, std::string(1000, static_cast<char>('a' + i)));
  EXPECT_TRUE(second.Get(4).ok()) << "an answer that is gone makes room";
}

// The clock's time may be ahead of that of later turns.
TEST(SubscriptionAnswer, WhatIsToldStaysToldWhenTimeGoesBack) {
  Dictionary dictionary;
  SubscriptionAnswer answer(1, true, {}, &dictionary, SubscriptionLimits{}, 5);
  EXPECT_FALSE(answer.SetBoolean(Revision(1), true, 0));
  EXPECT_TRUE(answer.Ripen(Revision(1), 5));
  EXPECT_FALSE(answer.SetBoolean(Revision(2), true, 4));
  EXPECT_TRUE(answer.Whole()->boolean);
  EXPECT_EQ(answer.ripens_at_us(), std::nullopt);
  EXPECT_TRUE(answer.SetBoolean(Revision(3), false, 4));
  EXPECT_FALSE(answer.SetBoolean(Revision(4), true, 4));
  EXPECT_EQ(answer.ripens_at_us(), 9);
}

// A computed value that the dictionary learns before the rows are set is the same row.
TEST(SubscriptionAnswer, AValueLearntMeanwhileKeepsItsTime) {
  Dictionary dictionary;
  SubscriptionAnswer answer(1, false, {"x"}, &dictionary, SubscriptionLimits{}, 5);
  const Term value = Term::Literal("some text that is in no id");
  EXPECT_FALSE(answer.SetRows(Revision(1), {{{answer.Local(value)}, 1}}, 0));
  EXPECT_TRUE(answer.Ripen(Revision(1), 5));
  SubscriptionAnswer::Rows again = {{{answer.Local(value)}, 1}};
  dictionary.Intern(value);
  EXPECT_FALSE(answer.SetRows(Revision(2), std::move(again), 6));
  EXPECT_EQ(answer.Whole()->appeared.size(), 1u);
}

}  // namespace
}  // namespace docent::server
