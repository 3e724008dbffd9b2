#include "kb_server/door/send_budget.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "absl/time/clock.h"

namespace docent::server {
namespace {

// A stream that gives back its memory when it is cut.
struct Stream {
  explicit Stream(SendBudget* budget)
      : share(budget, [this](const absl::Status& status) {
          reason = status;
          share.Release(held);
          held = 0;
          cut = true;
        }) {}
  void Hold(size_t bytes) {
    held += bytes;
    share.Add(bytes);
  }
  std::atomic<bool> cut{false};
  absl::Status reason;
  size_t held = 0;
  SendBudget::Share share;
};

void AwaitCuts(const SendBudget& budget, uint64_t count) {
  for (int i = 0; i < 6000 && budget.cut() < count; ++i) absl::SleepFor(absl::Milliseconds(10));
  ASSERT_EQ(budget.cut(), count);
}

TEST(SendBudget, UpToTheLimitNobodyIsCut) {
  SendBudget budget(1000);
  Stream one(&budget), two(&budget);
  one.Hold(400);
  two.Hold(600);
  absl::SleepFor(absl::Milliseconds(50));
  EXPECT_EQ(budget.cut(), 0u);
  EXPECT_EQ(budget.taken(), 1000u);
}

TEST(SendBudget, TheLargestStreamIsCut) {
  SendBudget budget(1000);
  Stream small(&budget), large(&budget), last(&budget);
  small.Hold(300);
  large.Hold(600);
  last.Hold(101);
  AwaitCuts(budget, 1);
  EXPECT_TRUE(large.cut);
  EXPECT_FALSE(small.cut || last.cut);
  EXPECT_EQ(large.reason.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(std::string(large.reason.message()).find("streams_bytes = 1000"), std::string::npos);
  EXPECT_EQ(budget.taken(), 401u);
}

TEST(SendBudget, OfEqualStreamsThoseThatTookNothingForTheLongestTimeAreCut) {
  SendBudget budget(1000);
  std::vector<std::unique_ptr<Stream>> streams;
  for (int i = 0; i < 10; ++i) {
    streams.push_back(std::make_unique<Stream>(&budget));
    streams.back()->Hold(100);
    absl::SleepFor(absl::Milliseconds(2));
  }
  streams[0]->share.Release(0);
  streams[0]->Hold(100);  // the largest, and it takes what it has
  AwaitCuts(budget, 2);
  EXPECT_TRUE(streams[0]->cut);
  EXPECT_TRUE(streams[1]->cut) << "and the oldest of the others, so that there is some room";
}

TEST(SendBudget, AStreamThatEndsGivesBackItsShare) {
  SendBudget budget(1000);
  auto one = std::make_unique<Stream>(&budget);
  one->Hold(900);
  one.reset();
  EXPECT_EQ(budget.taken(), 0u);
  Stream two(&budget);
  two.Hold(900);
  absl::SleepFor(absl::Milliseconds(20));
  EXPECT_EQ(budget.cut(), 0u);
}

TEST(SendBudget, StreamsMayComeAndGoWhileOthersAreCut) {
  SendBudget budget(10000);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&budget] {
      for (int i = 0; i < 2000; ++i) {
        std::atomic<bool> cut = false;
        SendBudget::Share share(&budget, [&cut](const absl::Status&) { cut = true; });
        share.Add(4000);
        std::this_thread::yield();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(budget.taken(), 0u);
}

}  // namespace
}  // namespace docent::server
