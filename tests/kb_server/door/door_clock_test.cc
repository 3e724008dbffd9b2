#include "kb_server/door/door_clock.h"

#include <chrono>
#include <thread>

#include "gtest/gtest.h"
#include "kb_server/door/inbox.h"

namespace docent::server {
namespace {

constexpr TimeMicros kHour = 3600 * TimeMicros{1'000'000};

TEST(DoorClockTest, AWallClockThatIsSetMovesNothing) {
  ManualClock wall(kHour);
  const SteadyClock clock(wall);
  const TimeMicros before = clock.Now();
  EXPECT_GE(before, kHour);
  wall.Set(0);
  EXPECT_GE(clock.Now(), before);
  wall.Set(5 * kHour);
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_GT(clock.Now(), before) << "it goes on";
  EXPECT_LT(clock.Now(), 2 * kHour);
}

TEST(DoorClockTest, AfterARestartWithAClockThatWasSetBackTimeGoesOnFromTheLog) {
  ManualClock source(kHour);
  DoorClock clock(&source);
  clock.NotBefore(3 * kHour);  // the newest turn
  EXPECT_EQ(clock.Now(), 3 * kHour);
  source.Advance(std::chrono::seconds(5));
  EXPECT_EQ(clock.Now(), 3 * kHour + 5'000'000) << "durations go on at once, not in two hours";
  clock.NotBefore(kHour);
  EXPECT_EQ(clock.Now(), 3 * kHour + 5'000'000);
}

TEST(DoorClockTest, StampsOfTurnsGoOnFromTheLog) {
  ManualClock source(kHour);
  DoorClock clock(&source);
  Inbox inbox(&clock, Limits{});
  inbox.StartAfter(3 * kHour);
  clock.NotBefore(3 * kHour);
  source.Advance(std::chrono::seconds(1));
  inbox.Push(WriteBatch(), nullptr);
  const auto taken = inbox.PopAll(std::nullopt, 1);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].batch.time_us, 3 * kHour + 1'000'000);
}

}  // namespace
}  // namespace docent::server
