#include "kb_server/door/worker_pool.h"

#include <atomic>
#include <memory>

#include "absl/synchronization/barrier.h"
#include "absl/synchronization/blocking_counter.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "gtest/gtest.h"

namespace docent {
namespace {

TEST(WorkerPoolTest, OnlySoManyRunAtTheSameTime) {
  std::atomic<int> running = 0, most = 0, done = 0;
  {
    WorkerPool pool(2, 8, 100);
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(pool.Submit([&] {
        int now = ++running;
        int seen = most;
        while (now > seen && !most.compare_exchange_weak(seen, now)) continue;
        std::this_thread::yield();
        --running;
        ++done;
      }));
    }
  }
  EXPECT_EQ(done, 50) << "what was queued is finished";
  EXPECT_LE(most, 2);
}

TEST(WorkerPoolTest, WorkThatWaitsLetsOthersRun) {
  WorkerPool pool(2, 8, 100);
  absl::Notification go;
  absl::BlockingCounter waiting(7), ended(7);
  for (int i = 0; i < 7; ++i) {
    ASSERT_TRUE(pool.Submit([&] {
      {
        WorkerPool::Waiting wait(&pool);
        waiting.DecrementCount();
        go.WaitForNotification();
      }
      ended.DecrementCount();
    }));
  }
  waiting.Wait();
  absl::Notification ran;
  ASSERT_TRUE(pool.Submit([&] { ran.Notify(); }));
  EXPECT_TRUE(ran.WaitForNotificationWithTimeout(absl::Seconds(20)));
  go.Notify();
  ended.Wait();
}

TEST(WorkerPoolTest, WhoIsNotServedInTimeIsTold) {
  absl::Notification go, told, served;
  std::atomic<bool> begun = false;
  {
    WorkerPool pool(1, 2, 10);
    ASSERT_TRUE(pool.Submit([&] { go.WaitForNotification(); }));
    ASSERT_TRUE(
        pool.Submit([&] { begun = true; }, {absl::Now() + absl::Milliseconds(50), [&] { told.Notify(); }}));
    ASSERT_TRUE(pool.Submit([&] { served.Notify(); }, {absl::Now() + absl::Seconds(60), [] { FAIL(); }}));
    EXPECT_TRUE(told.WaitForNotificationWithTimeout(absl::Seconds(20)));
    go.Notify();
    served.WaitForNotification();
  }
  EXPECT_FALSE(begun);
}

TEST(WorkerPoolTest, BeyondTheOpenOnesWorkIsQueuedAndBeyondTheQueueItIsRefused) {
  absl::Notification go;
  std::atomic<int> done = 0;
  {
    WorkerPool pool(1, 2, 1);
    absl::BlockingCounter waiting(2);
    auto work = [&] {
      WorkerPool::Waiting wait(&pool);
      waiting.DecrementCount();
      go.WaitForNotification();
      ++done;
    };
    ASSERT_TRUE(pool.Submit(work));
    while (!pool.Submit(work)) std::this_thread::yield();  // the first has left the queue
    waiting.Wait();
    EXPECT_TRUE(pool.Submit([&] { ++done; })) << "at the limit";
    EXPECT_FALSE(pool.Submit([&] { ++done; })) << "one past it";
    EXPECT_EQ(done, 0) << "both threads wait";
    go.Notify();
  }
  EXPECT_EQ(done, 3);
}

TEST(WorkerPoolTest, WhatWorkHoldsIsGoneWhenItEnds) {
  WorkerPool pool(1, 1, 10);
  auto held = std::make_shared<int>(7);
  std::weak_ptr<int> watch = held;
  absl::Notification next;
  ASSERT_TRUE(pool.Submit([held = std::move(held)] {}));
  ASSERT_TRUE(pool.Submit([&] { next.Notify(); }));
  next.WaitForNotification();
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace docent
