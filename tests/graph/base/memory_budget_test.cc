#include "graph/base/memory_budget.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace docent {
namespace {

constexpr size_t kMiB = 1u << 20;
const absl::Status kOwn = absl::ResourceExhaustedError("its own");

TEST(MemoryBudgetTest, HoldsAtTheLimitAndBeyond) {
  MemoryBudget all("all_bytes", 100);
  EXPECT_TRUE(all.Take(100));
  EXPECT_FALSE(all.HasRoom(1));
  EXPECT_FALSE(all.Take(1));
  EXPECT_FALSE(all.Take(SIZE_MAX));
  EXPECT_EQ(all.taken(), 100u);
  all.Give(1);
  EXPECT_TRUE(all.Take(1));
  EXPECT_NE(all.Refusal().message().find("all_bytes = 100"), std::string::npos);
}

void GiveAllBack(MemoryUse* use) {
  use->Release(use->used());
  use->Settle();
}

TEST(MemoryBudgetTest, AUseAloneIsBoundedByItsOwnLimit) {
  MemoryUse use(1000);
  EXPECT_TRUE(use.Add(1000));
  EXPECT_FALSE(use.Add(1));
  EXPECT_EQ(use.Refusal(kOwn), kOwn);
  use.Release(1);
  EXPECT_TRUE(use.Add(0));
  GiveAllBack(&use);
  EXPECT_TRUE(use.Add(1000));
}

TEST(MemoryBudgetTest, UsesShareWhatThereIsAndGiveItBack) {
  MemoryBudget all("all_bytes", 10 * kMiB);
  MemoryUse first(8 * kMiB, &all), second(8 * kMiB, &all);
  EXPECT_TRUE(first.Add(1000));
  EXPECT_EQ(all.taken(), 0u) << "little is not counted";
  EXPECT_TRUE(first.Add(8 * kMiB - 1000));
  EXPECT_FALSE(second.Add(4 * kMiB));
  EXPECT_EQ(second.Refusal(kOwn), all.Refusal());
  GiveAllBack(&second);
  GiveAllBack(&first);
  EXPECT_EQ(all.taken(), 0u);
  EXPECT_TRUE(second.Add(4 * kMiB));
  EXPECT_FALSE(second.Add(5 * kMiB));
  EXPECT_EQ(second.Refusal(kOwn), kOwn);
  {
    MemoryUse third(8 * kMiB, &all);
    EXPECT_TRUE(third.Add(3 * kMiB));
  }
  GiveAllBack(&second);
  EXPECT_EQ(all.taken(), 0u);
}

TEST(MemoryBudgetTest, WhatIsReleasedIsThereForOthers) {
  MemoryBudget all("all_bytes", 100 * kMiB);
  MemoryUse use(SIZE_MAX, &all);
  EXPECT_TRUE(use.Add(90 * kMiB));
  EXPECT_TRUE(use.HasRoom(5 * kMiB));
  EXPECT_FALSE(use.HasRoom(20 * kMiB));
  EXPECT_LE(all.taken(), 91 * kMiB) << "looking takes nothing";
  use.Release(80 * kMiB);
  EXPECT_GE(all.taken(), 10 * kMiB - 256 * 1024);
  EXPECT_LE(all.taken(), 12 * kMiB);
  EXPECT_TRUE(use.Add(80 * kMiB));
  MemoryUse small(10 * kMiB, &all);
  EXPECT_FALSE(small.HasRoom(11 * kMiB));
  EXPECT_EQ(small.Refusal(kOwn, 11 * kMiB), kOwn);
}

TEST(MemoryBudgetTest, WhatIsKeptToBeQuickerLeavesRoomForOthers) {
  MemoryBudget all("all_bytes", 4 * kMiB);
  MemoryUse first(100 * kMiB, &all), second(100 * kMiB, &all);
  EXPECT_TRUE(first.MayKeep(kMiB));
  EXPECT_FALSE(first.MayKeep(3 * kMiB));
  EXPECT_TRUE(second.Add(3 * kMiB));
  EXPECT_FALSE(first.MayKeep(kMiB));
}

TEST(MemoryBudgetTest, ManyThreadsNeverHoldMoreThanTheLimit) {
  MemoryBudget all("all_bytes", 64 * kMiB);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&all] {
      for (int i = 0; i < 2000; ++i) {
        MemoryUse use(40 * kMiB, &all);
        while (use.used() < 30 * kMiB && use.Add(kMiB)) {
        }
        EXPECT_LE(all.taken(), 64 * kMiB);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(all.taken(), 0u);
}

}  // namespace
}  // namespace docent
