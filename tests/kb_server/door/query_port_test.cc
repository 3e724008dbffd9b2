#include "kb_server/door/query_port.h"

#include <memory>
#include <string>

#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "graph/base/overload.h"
#include "graph/store/graph_writer.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

// What somebody who waits was told.
struct Told {
  QueryPort::Then Then() {
    return [this](const absl::Status& said) {
      status = said;
      told.Notify();
    };
  }
  absl::Status status;
  absl::Notification told;
};

class VersionWaitTest : public ::testing::Test {
 protected:
  void Publish(uint64_t revision) { port_.Publish(writer_.Freeze(Revision(revision))); }

  GraphWriter writer_{nullptr};
  QueryPort port_{WaitingLimits{.revisions_waiting = 2, .revisions_ahead = 10}};
};

TEST_F(VersionWaitTest, WhoNeedsWhatIsThereIsToldAtOnce) {
  Publish(3);
  Told told;
  port_.Await(Revision(3), absl::InfinitePast(), nullptr, told.Then());
  ASSERT_TRUE(told.told.HasBeenNotified());
  EXPECT_TRUE(told.status.ok());
}

TEST_F(VersionWaitTest, WhoWaitsIsToldByThePublisher) {
  Told second, third;
  port_.Await(Revision(3), absl::InfiniteFuture(), nullptr, third.Then());
  port_.Await(Revision(2), absl::InfiniteFuture(), nullptr, second.Then());
  EXPECT_EQ(port_.waiting(), 2u);
  Publish(2);
  EXPECT_TRUE(second.told.HasBeenNotified());
  EXPECT_FALSE(third.told.HasBeenNotified());
  Publish(4);
  EXPECT_TRUE(third.told.HasBeenNotified());
  EXPECT_TRUE(third.status.ok());
  EXPECT_EQ(port_.waiting(), 0u);
}

TEST_F(VersionWaitTest, FarAheadIsRefusedAtOnce) {
  Publish(5);
  Told at, past;
  port_.Await(Revision(15), absl::InfiniteFuture(), nullptr, at.Then());
  EXPECT_FALSE(at.told.HasBeenNotified()) << "at the limit";
  port_.Await(Revision(16), absl::InfiniteFuture(), nullptr, past.Then());
  ASSERT_TRUE(past.told.HasBeenNotified()) << "one past it";
  EXPECT_TRUE(absl::IsOutOfRange(past.status));
  EXPECT_THAT(std::string(past.status.message()), HasSubstr("revisions_ahead = 10"));
  port_.Stop();
}

TEST_F(VersionWaitTest, OnlySoManyWait) {
  Told first, second, third;
  port_.Await(Revision(1), absl::InfiniteFuture(), nullptr, first.Then());
  port_.Await(Revision(1), absl::InfiniteFuture(), nullptr, second.Then());
  EXPECT_FALSE(second.told.HasBeenNotified()) << "at the limit";
  port_.Await(Revision(1), absl::InfiniteFuture(), nullptr, third.Then());
  ASSERT_TRUE(third.told.HasBeenNotified()) << "one past it";
  EXPECT_TRUE(IsOverload(third.status));
  EXPECT_THAT(std::string(third.status.message()), HasSubstr("revisions_waiting is 2"));
  port_.Stop();
}

TEST_F(VersionWaitTest, WhoWaitsInVainIsToldWhatIsHere) {
  Publish(5);
  Told late;
  port_.Await(Revision(6), absl::Now(), nullptr, late.Then());
  late.told.WaitForNotification();
  EXPECT_TRUE(absl::IsDeadlineExceeded(late.status));
  EXPECT_THAT(std::string(late.status.message()), HasSubstr("revision 6 is not here yet; the newest is 5"));
}

TEST_F(VersionWaitTest, WhoHasGoneWaitsNoLonger) {
  auto cancellation = std::make_shared<Cancellation>();
  Told gone;
  port_.Await(Revision(6), absl::InfiniteFuture(), cancellation, gone.Then());
  cancellation->Cancel();
  gone.told.WaitForNotification();
  EXPECT_TRUE(absl::IsCancelled(gone.status));
  EXPECT_EQ(port_.waiting(), 0u);
}

TEST_F(VersionWaitTest, AStopRefusesThoseWhoWaitAndThoseWhoCome) {
  Told waits, comes;
  port_.Await(Revision(6), absl::InfiniteFuture(), nullptr, waits.Then());
  port_.Stop();
  ASSERT_TRUE(waits.told.HasBeenNotified());
  EXPECT_TRUE(absl::IsUnavailable(waits.status));
  port_.Await(Revision(6), absl::InfiniteFuture(), nullptr, comes.Then());
  ASSERT_TRUE(comes.told.HasBeenNotified());
  EXPECT_TRUE(absl::IsUnavailable(comes.status));
}

}  // namespace
}  // namespace docent::server
