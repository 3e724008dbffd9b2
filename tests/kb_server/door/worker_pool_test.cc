#include "kb_server/door/worker_pool.h"

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/synchronization/blocking_counter.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "graph/base/overload.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

void Unexpected(const absl::Status& why) {
  ADD_FAILURE() << "refused: " << why;
}

Work WorkOf(std::function<void()> run, ClientPtr client = nullptr) {
  return {.run = std::move(run), .refuse = Unexpected, .client = std::move(client)};
}

ClientPtr NewClient(const std::string& name) {
  return std::make_shared<Client>(name);
}

// Work that begins, and goes on until it is told to end.
struct Held {
  std::function<void()> Run() {
    return [this] {
      begun.Notify();
      go.WaitForNotification();
    };
  }
  absl::Notification begun, go;
};

TEST(WorkerPoolTest, OnlySoManyRunAtTheSameTime) {
  std::atomic<int> running = 0, most = 0;
  absl::BlockingCounter done(50);
  WorkerPool pool({2, 8, 100});
  for (int i = 0; i < 50; ++i) {
    pool.Submit(WorkOf([&] {
      int now = ++running;
      int seen = most;
      while (now > seen && !most.compare_exchange_weak(seen, now)) continue;
      std::this_thread::yield();
      --running;
      done.DecrementCount();
    }));
  }
  done.Wait();
  EXPECT_LE(most, 2);
}

TEST(WorkerPoolTest, WorkThatWaitsLetsOthersRun) {
  WorkerPool pool({2, 8, 100});
  absl::Notification go;
  absl::BlockingCounter waiting(7), ended(7);
  for (int i = 0; i < 7; ++i) {
    pool.Submit(WorkOf([&] {
      {
        const WorkerPool::Waiting wait;
        waiting.DecrementCount();
        go.WaitForNotification();
      }
      ended.DecrementCount();
    }));
  }
  waiting.Wait();
  absl::Notification ran;
  pool.Submit(WorkOf([&] { ran.Notify(); }));
  ran.WaitForNotification();
  go.Notify();
  ended.Wait();
}

TEST(WorkerPoolTest, MoreThanSoManyDoNotWaitForOthers) {
  WorkerPoolLimits limits{1, 8, 100};
  limits.stalled = 1;
  WorkerPool pool(limits);
  absl::Notification waits, go, ended;
  pool.Submit(WorkOf([&] {
    const WorkerPool::Waiting wait;
    EXPECT_TRUE(wait.status().ok()) << "at the limit";
    waits.Notify();
    go.WaitForNotification();
  }));
  waits.WaitForNotification();
  pool.Submit(WorkOf([&] {
    const WorkerPool::Waiting wait;
    EXPECT_TRUE(IsOverload(wait.status())) << "one past it";
    EXPECT_THAT(std::string(wait.status().message()), HasSubstr("queries_stalled is 1"));
    const WorkerPool::Waiting client(WorkerPool::Waiting::What::kClient);
    EXPECT_TRUE(client.status().ok()) << "a client is something else";
    ended.Notify();
  }));
  ended.WaitForNotification();
  go.Notify();
}

TEST(WorkerPoolTest, WhoIsNotServedInTimeIsTold) {
  Held held;
  absl::Notification told, served;
  WorkerPool pool({1, 2, 10});
  pool.Submit(WorkOf(held.Run()));
  held.begun.WaitForNotification();
  pool.Submit({.run = [] { ADD_FAILURE() << "it has begun"; },
               .refuse =
                   [&](const absl::Status& why) {
                     EXPECT_TRUE(absl::IsDeadlineExceeded(why));
                     told.Notify();
                   },
               .until = absl::Now()});
  Work in_time = WorkOf([&] { served.Notify(); });
  in_time.until = absl::InfiniteFuture();
  pool.Submit(std::move(in_time));
  told.WaitForNotification();
  held.go.Notify();
  served.WaitForNotification();
}

TEST(WorkerPoolTest, BeyondTheQueueWorkIsRefused) {
  Held held;
  absl::Notification done;
  absl::Status refused;
  WorkerPool pool({1, 2, 1});
  pool.Submit(WorkOf(held.Run()));
  held.begun.WaitForNotification();
  pool.Submit(WorkOf([&] { done.Notify(); }));  // at the limit
  pool.Submit({.run = [] { ADD_FAILURE() << "one past it"; },
               .refuse = [&](const absl::Status& why) { refused = why; }});
  EXPECT_TRUE(IsOverload(refused));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("the limit queries_waiting is 1"));
  held.go.Notify();
  done.WaitForNotification();
}

TEST(WorkerPoolTest, AClientMayHaveThreeTimesOfTheQueueWhatIsFree) {
  Held held;
  const ClientPtr greedy = NewClient("greedy"), other = NewClient("other");
  absl::BlockingCounter done(7);
  int refused = 0;
  WorkerPool pool({1, 2, 8});
  pool.Submit(WorkOf(held.Run()));
  held.begun.WaitForNotification();
  for (int i = 0; i < 20; ++i) {
    pool.Submit({.run = [&] { done.DecrementCount(); },
                 .refuse =
                     [&](const absl::Status& why) {
                       EXPECT_TRUE(IsOverload(why));
                       EXPECT_THAT(std::string(why.message()), HasSubstr("of this client"));
                       ++refused;
                     },
                 .client = greedy});
  }
  EXPECT_EQ(refused, 14) << "six times three quarters of eight";
  pool.Submit(WorkOf([&] { done.DecrementCount(); }, other));
  held.go.Notify();
  done.Wait();
}

TEST(WorkerPoolTest, TheClientThatHadLessGoesFirstWhateverWaitsBefore) {
  Held held;
  const ClientPtr much = NewClient("much"), little = NewClient("little");
  std::vector<std::string> order;
  absl::BlockingCounter done(4);
  WorkerPool pool({1, 1, 100});
  pool.Submit(WorkOf(
      [&] {
        held.Run()();
        const absl::Time end = absl::Now() + absl::Milliseconds(5);
        while (absl::Now() < end) continue;  // of a processor
      },
      much));
  held.begun.WaitForNotification();
  const auto say = [&](const std::string& name) {
    return [&, name] {
      order.push_back(name);
      done.DecrementCount();
    };
  };
  for (const char* name : {"much 1", "much 2", "much 3"}) pool.Submit(WorkOf(say(name), much));
  pool.Submit(WorkOf(say("little"), little));
  held.go.Notify();
  done.Wait();
  EXPECT_THAT(order, ::testing::ElementsAre("little", "much 1", "much 2", "much 3"));
}

// Uses the processor until it is told to end, or cancelled.
std::function<void()> Computing(WorkerPool* pool, std::shared_ptr<Cancellation> cancellation,
                                std::atomic<bool>* stop, absl::BlockingCounter* begun = nullptr) {
  return [=] {
    const WorkerPool::SharedWork shared(pool, cancellation.get());
    if (begun != nullptr) begun->DecrementCount();
    while (!*stop && cancellation->CheckNow().ok()) continue;
  };
}

TEST(WorkerPoolTest, SmallWorkOfAnotherClientPassesLargeWork) {
  WorkerPoolLimits limits{2, 80, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(5);
  std::atomic<bool> stop = false;
  absl::BlockingCounter begun(60);
  WorkerPool pool(limits);
  for (int i = 0; i < 60; ++i) {
    pool.Submit(WorkOf(Computing(&pool, std::make_shared<Cancellation>(), &stop, &begun),
                       NewClient("heavy " + std::to_string(i))));
  }
  begun.Wait();  // all of them have begun, although there are three places
  for (int i = 0; i < 20; ++i) {
    absl::Notification done;
    pool.Submit(WorkOf([&] { done.Notify(); }, NewClient("small " + std::to_string(i))));
    done.WaitForNotification();
  }
  while (pool.load().begun > 60)
    absl::SleepFor(absl::Milliseconds(1));  // the last small one says so before it ends
  EXPECT_EQ(pool.load().begun, 60u) << "no heavy one has ended";
  stop = true;
}

TEST(WorkerPoolTest, WhoHasNothingBegunBeginsBeyondWhatMayBeOpen) {
  WorkerPoolLimits limits{1, 2, 100};
  limits.first = 2;
  absl::Notification go;
  absl::BlockingCounter waiting(4), ended(2);
  WorkerPool pool(limits);
  const auto wait = [&] {
    const WorkerPool::Waiting place_is_free;
    waiting.DecrementCount();
    go.WaitForNotification();
  };
  std::vector<ClientPtr> clients;
  for (int i = 0; i < 4; ++i) {
    clients.push_back(NewClient(std::to_string(i)));
    pool.Submit(WorkOf(wait, clients.back()));
  }
  waiting.Wait();  // two are open, and two more have begun
  pool.Submit(WorkOf([&] { ended.DecrementCount(); }, NewClient("one more")));
  pool.Submit(WorkOf([&] { ended.DecrementCount(); }, clients[0]));
  EXPECT_EQ(pool.load().queued, 2u) << "there is no thread";
  go.Notify();
  ended.Wait();
}

TEST(WorkerPoolTest, SmallWorkPassesLargeWorkThatHoldsAllThreads) {
  WorkerPoolLimits limits{2, 20, 100};
  limits.first = 60;
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(5);
  std::atomic<bool> stop = false;
  absl::BlockingCounter begun(60);
  WorkerPool pool(limits);
  for (int i = 0; i < 60; ++i) {
    pool.Submit(WorkOf(Computing(&pool, std::make_shared<Cancellation>(), &stop, &begun),
                       NewClient("heavy " + std::to_string(i))));
  }
  begun.Wait();
  for (int i = 0; i < 20; ++i) {
    absl::Notification done;
    pool.Submit(WorkOf([&] { done.Notify(); }, NewClient("small " + std::to_string(i))));
    done.WaitForNotification();
  }
  stop = true;
}

TEST(WorkerPoolTest, WhatNeverLooksDoesNotHoldAShortPlaceForLong) {
  WorkerPoolLimits limits{1, 8, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(5);
  Held held;
  absl::Notification served, second;
  WorkerPool pool(limits);
  pool.Submit(WorkOf(held.Run()));
  pool.Submit(WorkOf([&] { served.Notify(); }));
  served.WaitForNotification();
  pool.Submit(WorkOf([&] { second.Notify(); }));
  second.WaitForNotification();
  held.go.Notify();
}

TEST(WorkerPoolTest, WorkThatIsHeldUpEndsWhenItIsCancelled) {
  WorkerPoolLimits limits{1, 8, 100};
  limits.short_running = 1;
  limits.short_time = absl::Milliseconds(1);
  std::atomic<bool> never = false;
  std::vector<std::shared_ptr<Cancellation>> cancellations;
  absl::BlockingCounter ended(2);
  const ClientPtr client = NewClient("both");
  WorkerPool pool(limits);
  for (int i = 0; i < 2; ++i) {
    cancellations.push_back(std::make_shared<Cancellation>());
    pool.Submit(WorkOf(
        [&, compute = Computing(&pool, cancellations.back(), &never)] {
          compute();
          ended.DecrementCount();
        },
        client));
  }
  while (pool.load().held_up == 0) absl::SleepFor(absl::Milliseconds(1));
  for (const auto& cancellation : cancellations) cancellation->Cancel();
  ended.Wait();
}

TEST(WorkerPoolTest, AStopCancelsWhatRunsAndRefusesWhatWaits) {
  std::atomic<bool> never = false;
  absl::BlockingCounter begun(1);
  absl::Notification ended;
  auto cancellation = std::make_shared<Cancellation>();
  absl::Status queued, late;
  WorkerPool pool({1, 1, 10});
  Work endless = WorkOf([&, compute = Computing(&pool, cancellation, &never, &begun)] {
    compute();
    ended.Notify();
  });
  endless.cancellation = cancellation;
  pool.Submit(std::move(endless));
  begun.Wait();
  pool.Submit({.run = [] { ADD_FAILURE(); }, .refuse = [&](const absl::Status& why) { queued = why; }});
  pool.Stop();
  EXPECT_TRUE(absl::IsUnavailable(queued)) << queued;
  ended.WaitForNotification();
  pool.Submit({.run = [] { ADD_FAILURE(); }, .refuse = [&](const absl::Status& why) { late = why; }});
  EXPECT_TRUE(absl::IsUnavailable(late)) << late;
}

TEST(WorkerPoolTest, TheClientThatIsWaitedForTheLongestIsCrowdedOut) {
  WorkerPoolLimits limits{1, 2, 100};
  limits.crowded_time = absl::Milliseconds(20);
  absl::Notification first_waits, second_waits, served;
  std::atomic<bool> stop = false;
  std::atomic<int> first = 0, second = 0;
  WorkerPool pool(limits);
  const auto wait_for_client = [&](std::atomic<int>* crowded, absl::Notification* waits) {
    WorkerPool::Waiting waiting(WorkerPool::Waiting::What::kClient);
    EXPECT_FALSE(waiting.Crowded()) << "nobody else wants the thread";
    waits->Notify();
    while (!stop) {
      absl::SleepFor(absl::Milliseconds(5));
      if (!waiting.Crowded()) continue;
      ++*crowded;
      return;
    }
  };
  pool.Submit(WorkOf([&] { wait_for_client(&first, &first_waits); }));
  first_waits.WaitForNotification();
  absl::SleepFor(absl::Milliseconds(50));  // so much longer is it waited for
  pool.Submit(WorkOf([&] { wait_for_client(&second, &second_waits); }));
  second_waits.WaitForNotification();
  pool.Submit(WorkOf([&] {
    EXPECT_EQ(first, 1);
    EXPECT_EQ(second, 0);
    served.Notify();
  }));
  served.WaitForNotification();
  stop = true;
}

TEST(WorkerPoolTest, WhatWorkHoldsIsGoneWhenItEnds) {
  WorkerPool pool({1, 1, 10});
  auto held = std::make_shared<int>(7);
  std::weak_ptr<int> watch = held;
  absl::Notification next;
  pool.Submit(WorkOf([held = std::move(held)] {}));
  pool.Submit(WorkOf([&] { next.Notify(); }));
  next.WaitForNotification();
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace docent::server
