// What the answers that clients follow hold together: a limit, who makes room for whom, and a client's share.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"
#include "kb_server/subscriptions/subscriptions.h"
#include "tests/reasoner/test_world.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

struct Follower final : Subscriber {
  void Wake() override {}
  void Fail(const absl::Status& status) override { failed = status; }

  SubscriptionAnswerPtr answer;
  absl::Status failed;
};

// Answers of a few hundred rows under a limit for all of them.
class SubscriptionMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<std::string> facts;
    for (int i = 0; i < 400; ++i) facts.push_back(absl::StrCat("s", i, " p ", i));
    world_.Apply(facts, {});
    Make({});
    ASSERT_TRUE(Open()->failed.ok());
    one_ = subscriptions_->bytes();
    ASSERT_GT(one_, 400 * sizeof(TermId));
  }

  void Make(const SubscriptionLimits& limits) {
    Subscriptions::Settings settings;
    settings.dictionary = &world_.dictionary;
    settings.clock = &clock_;
    settings.subscription_limits = limits;
    settings.epoch = "1";
    subscriptions_ = std::make_unique<Subscriptions>(settings);
    subscriptions_->PublishWhole(world_.writer.Freeze(Revision(++revision_)));
  }
  // So that there is room for so many answers.
  void MakeRoomFor(double answers) {
    SubscriptionLimits limits;
    limits.subscriptions_bytes = static_cast<size_t>(answers * static_cast<double>(one_));
    Make(limits);
  }
  std::shared_ptr<Follower> Follow(const std::string& query, ClientPtr client = nullptr) {
    auto follower = std::make_shared<Follower>();
    subscriptions_->Open(
        {query}, follower,
        [follower](const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
          if (answer.ok()) follower->answer = *answer;
          if (!answer.ok()) follower->failed = answer.status();
          return true;
        },
        std::move(client));
    subscriptions_->Drain();
    return follower;
  }
  // Follows an answer that no other shares.
  std::shared_ptr<Follower> Open(ClientPtr client = nullptr) {
    return Follow(absl::StrCat("PREFIX : <http://example.org/> SELECT ?s ?o { ?s :p ?o FILTER(?o != ",
                               1000 + ++opened_, ") }"),
                  std::move(client));
  }

  TestWorld world_;
  ManualClock clock_{1'000'000'000};
  uint64_t revision_ = 0;
  size_t one_ = 0;
  int opened_ = 0;
  std::unique_ptr<Subscriptions> subscriptions_;
};

TEST_F(SubscriptionMemoryTest, AllAnswersTogetherHaveALimit) {
  MakeRoomFor(2.5);
  const auto first = Open(), second = Open();
  EXPECT_TRUE(first->failed.ok() && second->failed.ok()) << "within it";
  const auto third = Open();
  EXPECT_TRUE(IsOverload(third->failed)) << "one past it";
  EXPECT_THAT(std::string(third->failed.message()), HasSubstr("subscriptions_bytes is "));
  const Delta delta = world_.Apply({"s1 p 5000"}, {});
  subscriptions_->Publish(world_.writer.Freeze(Revision(++revision_)), delta, clock_.Now());
  subscriptions_->Drain();
  EXPECT_TRUE(first->failed.ok());
  EXPECT_EQ(first->answer->size(), 401u) << "the others go on";
}

TEST_F(SubscriptionMemoryTest, QueriesCountAsTheirAnswersDo) {
  std::string many = "ASK { VALUES ?o {";
  for (int i = 0; i < 5000; ++i) absl::StrAppend(&many, " ", i);
  const auto query = [&](int i) { return absl::StrCat(many, "} ?s <http://example.org/p> ?o } #", i); };
  Make({});
  ASSERT_TRUE(Follow(query(0))->failed.ok());
  const size_t one = subscriptions_->bytes();
  EXPECT_GT(one, 2 * many.size());
  SubscriptionLimits limits;
  limits.subscriptions_bytes = 5 * one / 2;
  Make(limits);
  EXPECT_TRUE(Follow(query(1))->failed.ok());
  EXPECT_TRUE(Follow(query(2))->failed.ok());
  EXPECT_TRUE(IsOverload(Follow(query(3))->failed));
  EXPECT_TRUE(Follow("ASK { ?s ?p 1 }")->failed.ok()) << "there is room for a small one";
}

TEST_F(SubscriptionMemoryTest, WhatNobodyFollowsGoesForWhatIsFollowed) {
  MakeRoomFor(2.5);
  const auto first = Open(), second = Open();
  subscriptions_->Close(first);
  subscriptions_->Close(second);
  // Closed ones are noticed about once a second.
  while (!Open()->failed.ok()) absl::SleepFor(absl::Milliseconds(50));
}

TEST_F(SubscriptionMemoryTest, OfWhatNobodyFollowsALittleIsKept) {
  MakeRoomFor(7.5);  // one answer is more than an eighth
  const auto only = Open();
  EXPECT_GT(subscriptions_->bytes(), 0u);
  subscriptions_->Close(only);
  while (subscriptions_->bytes() > 0) absl::SleepFor(absl::Milliseconds(50));
}

TEST_F(SubscriptionMemoryTest, AWholeAnswerIsThereWhileItIsSent) {
  const auto follower = Open();
  const size_t before = subscriptions_->bytes();
  AnswerChangePtr whole = follower->answer->Whole();
  EXPECT_EQ(whole->appeared.size(), 400u);
  EXPECT_GT(subscriptions_->bytes(), before);
  const std::weak_ptr<const AnswerChange> there = whole;
  whole.reset();
  EXPECT_EQ(there.expired(), subscriptions_->bytes() == before) << "what is there counts";
}

TEST_F(SubscriptionMemoryTest, AClientLeavesRoomForOthers) {
  MakeRoomFor(8);
  const auto greedy = std::make_shared<Client>("greedy"), modest = std::make_shared<Client>("modest");
  std::vector<std::shared_ptr<Follower>> open;
  while (open.empty() || open.back()->failed.ok()) open.push_back(Open(greedy));
  EXPECT_TRUE(IsOverload(open.back()->failed));
  EXPECT_GE(open.size(), 4u);
  EXPECT_TRUE(Open(modest)->failed.ok());
}

}  // namespace
}  // namespace docent::server
