#include "kb_server/door/worker_pool.h"

#include <atomic>
#include <memory>

#include "absl/synchronization/barrier.h"
#include "absl/synchronization/blocking_counter.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

TEST(WorkerPoolTest, OnlySoManyRunAtTheSameTime) {
  std::atomic<int> running = 0, most = 0, done = 0;
  {
    WorkerPool pool({2, 8, 100});
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(pool.Submit([&] {
                        int now = ++running;
                        int seen = most;
                        while (now > seen && !most.compare_exchange_weak(seen, now)) continue;
                        std::this_thread::yield();
                        --running;
                        ++done;
                      })
                      .ok());
    }
  }
  EXPECT_EQ(done, 50) << "what was queued is finished";
  EXPECT_LE(most, 2);
}

TEST(WorkerPoolTest, WorkThatWaitsLetsOthersRun) {
  WorkerPool pool({2, 8, 100});
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
                    })
                    .ok());
  }
  waiting.Wait();
  absl::Notification ran;
  ASSERT_TRUE(pool.Submit([&] { ran.Notify(); }).ok());
  EXPECT_TRUE(ran.WaitForNotificationWithTimeout(absl::Seconds(20)));
  go.Notify();
  ended.Wait();
}

TEST(WorkerPoolTest, WhoIsNotServedInTimeIsTold) {
  absl::Notification go, told, served;
  std::atomic<bool> begun = false;
  {
    WorkerPool pool({1, 2, 10});
    ASSERT_TRUE(pool.Submit([&] { go.WaitForNotification(); }).ok());
    ASSERT_TRUE(
        pool.Submit([&] { begun = true; }, {absl::Now() + absl::Milliseconds(50), [&] { told.Notify(); }})
            .ok());
    ASSERT_TRUE(
        pool.Submit([&] { served.Notify(); }, {absl::Now() + absl::Seconds(60), [] { FAIL(); }}).ok());
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
    WorkerPool pool({1, 2, 1});
    absl::BlockingCounter waiting(2);
    auto work = [&] {
      WorkerPool::Waiting wait(&pool);
      waiting.DecrementCount();
      go.WaitForNotification();
      ++done;
    };
    ASSERT_TRUE(pool.Submit(work).ok());
    while (!pool.Submit(work).ok()) std::this_thread::yield();  // the first has left the queue
    waiting.Wait();
    EXPECT_TRUE(pool.Submit([&] { ++done; }).ok()) << "at the limit";
    const absl::Status refused = pool.Submit([&] { ++done; });
    EXPECT_TRUE(IsOverload(refused)) << "one past it";
    EXPECT_NE(refused.message().find("the limit queries_waiting is 1"), absl::string_view::npos);
    EXPECT_EQ(done, 0) << "both threads wait";
    go.Notify();
  }
  EXPECT_EQ(done, 3);
}

// Uses the processor for a while, as an evaluation does.
void Compute(Cancellation* cancellation, absl::Duration how_long) {
  const absl::Time end = absl::Now() + how_long;
  while (absl::Now() < end && cancellation->CheckNow().ok()) continue;
}

TEST(WorkerPoolTest, ShortWorkPassesLongWork) {
  WorkerPoolLimits limits{2, 40, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(5);
  std::atomic<bool> stop = false;
  std::atomic<int> ended = 0;
  {
    WorkerPool pool(limits);
    for (int i = 0; i < 30; ++i) {
      ASSERT_TRUE(pool.Submit([&] {
                        Cancellation cancellation;
                        WorkerPool::SharedWork shared(&pool, &cancellation);
                        while (!stop) Compute(&cancellation, absl::Milliseconds(1));
                        ++ended;
                      })
                      .ok());
    }
    for (int i = 0; i < 20; ++i) {
      absl::Notification done;
      ASSERT_TRUE(pool.Submit([&] { done.Notify(); }).ok());
      EXPECT_TRUE(done.WaitForNotificationWithTimeout(absl::Seconds(60)));
      EXPECT_EQ(ended, 0);
    }
    stop = true;
  }
  EXPECT_EQ(ended, 30) << "long work goes on where there is room";
}

TEST(WorkerPoolTest, LongWorkRunsInItsPlacesAlone) {
  WorkerPoolLimits limits{2, 40, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(2);
  std::atomic<int> running = 0, most = 0;
  WorkerPool pool(limits);
  for (int i = 0; i < 12; ++i) {
    ASSERT_TRUE(pool.Submit([&] {
                      Cancellation cancellation;
                      WorkerPool::SharedWork shared(&pool, &cancellation);
                      Compute(&cancellation, absl::Milliseconds(30));  // it is among the others then
                      const int now = ++running;
                      int seen = most;
                      while (now > seen && !most.compare_exchange_weak(seen, now)) continue;
                      Compute(&cancellation, absl::Milliseconds(20));
                      --running;
                    })
                    .ok());
  }
  absl::SleepFor(absl::Milliseconds(300));
  EXPECT_LE(most, 3);
}

TEST(WorkerPoolTest, WorkThatNeverLooksDoesNotHoldAShortPlaceForLong) {
  WorkerPoolLimits limits{1, 8, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(5);
  absl::Notification go, served;
  WorkerPool pool(limits);
  ASSERT_TRUE(pool.Submit([&] { go.WaitForNotification(); }).ok());
  ASSERT_TRUE(pool.Submit([&] { served.Notify(); }).ok());
  EXPECT_TRUE(served.WaitForNotificationWithTimeout(absl::Seconds(60)));
  go.Notify();
}

TEST(WorkerPoolTest, WorkThatIsHeldUpEndsWhenItIsCancelled) {
  WorkerPoolLimits limits{1, 8, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(1);
  absl::Notification go, ended;
  Cancellation second;
  WorkerPool pool(limits);
  ASSERT_TRUE(pool.Submit([&] {
                    Cancellation cancellation;
                    WorkerPool::SharedWork shared(&pool, &cancellation);
                    while (!go.HasBeenNotified()) Compute(&cancellation, absl::Milliseconds(1));
                  })
                  .ok());
  ASSERT_TRUE(pool.Submit([&] {
                    WorkerPool::SharedWork shared(&pool, &second);
                    Compute(&second, absl::InfiniteDuration());
                    ended.Notify();
                  })
                  .ok());
  absl::SleepFor(absl::Milliseconds(50));
  EXPECT_FALSE(ended.HasBeenNotified());
  second.Cancel();
  EXPECT_TRUE(ended.WaitForNotificationWithTimeout(absl::Seconds(60)));
  go.Notify();
}

TEST(WorkerPoolTest, TheClientThatIsWaitedForTheLongestIsCrowdedOut) {
  WorkerPoolLimits limits{1, 2, 100};
  limits.crowded_time = absl::Milliseconds(20);
  absl::Notification first_waits, gone, served;
  std::atomic<bool> stop = false;
  std::atomic<int> first = 0, second = 0;
  {
    WorkerPool pool(limits);
    const auto wait_for_client = [&](std::atomic<int>* crowded) {
      WorkerPool::Waiting waiting(&pool, WorkerPool::Waiting::What::kClient);
      if (!first_waits.HasBeenNotified()) first_waits.Notify();
      while (!stop) {
        absl::SleepFor(absl::Milliseconds(5));
        if (!waiting.Crowded()) continue;
        ++*crowded;
        return;
      }
    };
    ASSERT_TRUE(pool.Submit([&] { wait_for_client(&first); }).ok());
    first_waits.WaitForNotification();
    absl::SleepFor(absl::Milliseconds(50));
    ASSERT_TRUE(pool.Submit([&] { wait_for_client(&second); }).ok());
    absl::SleepFor(absl::Milliseconds(100));
    EXPECT_EQ(first + second, 0) << "nobody else wants their threads";
    ASSERT_TRUE(pool.Submit([&] { served.Notify(); }).ok());
    EXPECT_TRUE(served.WaitForNotificationWithTimeout(absl::Seconds(60)));
    EXPECT_EQ(first, 1);
    EXPECT_EQ(second, 0);
    stop = true;
  }
}

TEST(WorkerPoolTest, WhatWorkHoldsIsGoneWhenItEnds) {
  WorkerPool pool({1, 1, 10});
  auto held = std::make_shared<int>(7);
  std::weak_ptr<int> watch = held;
  absl::Notification next;
  ASSERT_TRUE(pool.Submit([held = std::move(held)] {}).ok());
  ASSERT_TRUE(pool.Submit([&] { next.Notify(); }).ok());
  next.WaitForNotification();
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace docent::server
