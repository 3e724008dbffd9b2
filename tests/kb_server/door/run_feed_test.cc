#include "kb_server/door/run_feed.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<RunEvent> Turn(uint64_t revision, int count = 1) {
  RunEvent event;
  event.revision = Revision(revision);
  event.run = "r";
  return std::vector<RunEvent>(count, event);
}

// Revisions of the events from number `number` on.
std::vector<uint64_t> From(const RunFeed& feed, uint64_t number) {
  std::vector<uint64_t> revisions;
  for (;; ++number) {
    absl::StatusOr<RunEventPtr> event = feed.Get(number);
    if (!event.ok() || *event == nullptr) return revisions;
    revisions.push_back((*event)->revision.value());
  }
}

TEST(RunFeedTest, EventsAreKeptAndFoundByRevision) {
  RunFeed feed(100);
  EXPECT_EQ(*feed.FirstAfter(Revision(0)), feed.Next());
  feed.Publish(Turn(3, 2));
  feed.Publish(Turn(5));
  EXPECT_THAT(From(feed, *feed.FirstAfter(Revision(0))), ElementsAre(3, 3, 5));
  EXPECT_THAT(From(feed, *feed.FirstAfter(Revision(3))), ElementsAre(5));
  EXPECT_THAT(From(feed, *feed.FirstAfter(Revision(4))), ElementsAre(5));
  EXPECT_EQ(*feed.FirstAfter(Revision(9)), feed.Next());
  EXPECT_EQ(*feed.Get(feed.Next()), nullptr);
}

TEST(RunFeedTest, BeyondTheLimitTheOldestAreForgottenAndThatIsSaid) {
  RunFeed feed(3);
  feed.Publish(Turn(1));
  feed.Publish(Turn(2, 2));
  uint64_t first = *feed.FirstAfter(Revision(0));
  EXPECT_THAT(From(feed, first), ElementsAre(1, 2, 2)) << "at the limit";
  feed.Publish(Turn(3, 2));  // one of revision 1 and one of revision 2 go
  EXPECT_EQ(feed.Get(first).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(feed.Get(first).status().message()), HasSubstr("run_events_kept is 3"));
  EXPECT_EQ(feed.FirstAfter(Revision(1)).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_THAT(From(feed, *feed.FirstAfter(Revision(2))), ElementsAre(3, 3));
}

TEST(RunFeedTest, WhatWasKeptAlreadyIsNotKeptTwiceAndIsNoNews) {
  RunFeed feed(100);
  int heard = 0;
  feed.Subscribe([&] { ++heard; });
  feed.BeginAfter(Revision(4));
  EXPECT_EQ(feed.FirstAfter(Revision(3)).status().code(), absl::StatusCode::kOutOfRange);
  feed.Keep(Turn(5));
  EXPECT_EQ(heard, 0);
  feed.Publish(Turn(6));
  feed.BeginAfter(Revision(0));
  feed.Keep(Turn(5));
  feed.Keep(Turn(6));
  feed.Publish(Turn(7));
  EXPECT_EQ(heard, 2);
  EXPECT_THAT(From(feed, *feed.FirstAfter(Revision(4))), ElementsAre(5, 6, 7));
}

TEST(RunFeedTest, ASubscriberHearsOfEachTurnUntilItLeaves) {
  RunFeed feed(100);
  int stays = 0, leaves = 0;
  feed.Subscribe([&] { ++stays; });
  const uint64_t id = feed.Subscribe([&] {
    ++leaves;
    EXPECT_NE(*feed.Get(feed.Next() - 1), nullptr) << "the events are there";
  });
  feed.Publish(Turn(1, 2));
  feed.Publish({});
  feed.Publish(Turn(2, 2));
  feed.Unsubscribe(id);
  feed.Publish(Turn(3));
  EXPECT_EQ(leaves, 2);
  EXPECT_EQ(stays, 3);
}

}  // namespace
}  // namespace docent::server
