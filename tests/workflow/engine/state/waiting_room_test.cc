#include "workflow/engine/state/waiting_room.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const RobotId kR1("urn:r1"), kR2("urn:r2");
bool OffersAll(const std::string&) {
  return true;
}

CommandOwner Of(const std::string& run) {
  return {RunId(run), 0, 0};
}

TEST(WaitingRoomTest, TheOldestComesFirstWhateverItWaitsFor) {
  WaitingRoom room;
  room.Wait(3, Of("C"), {RobotId(), "guide"});
  room.Wait(2, Of("B"), {kR1, "clean"});
  room.Block(1, RunId("A"), {kR1, kR2});
  auto next = room.Next(kR1, 0, OffersAll);
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->second, RunId("A"));
  next = room.Next(kR1, 1, OffersAll);
  EXPECT_EQ(next->second, RunId("B"));
  next = room.Next(kR1, 2, OffersAll);
  EXPECT_EQ(next->second, RunId("C"));
  EXPECT_FALSE(room.Next(kR1, 3, OffersAll).has_value());
  next = room.Next(kR2, 1, OffersAll);
  EXPECT_EQ(next->second, RunId("C"));  // B wants r1 only
}

TEST(WaitingRoomTest, WhoLeavesOrWishesOtherwiseIsNotBarredAnyMore) {
  WaitingRoom room;
  room.Wait(1, Of("A"), {RobotId(), "guide"});
  room.Bar(Of("A"));
  room.Wait(1, Of("A"), {RobotId(), "guide"});
  EXPECT_THAT(room.barred(), ElementsAre(Of("A")));
  room.Wait(1, Of("A"), {kR1, "guide"});
  EXPECT_THAT(room.barred(), IsEmpty());
  room.Bar(Of("A"));
  room.Leave(Of("A"));
  EXPECT_THAT(room.barred(), IsEmpty());
}

TEST(WaitingRoomTest, ARobotIsNotGivenToAWishThatItCannotFulfil) {
  WaitingRoom room;
  room.Wait(1, Of("A"), {RobotId(), "fly"});
  room.Wait(2, Of("B"), {RobotId(), "guide"});
  auto next = room.Next(kR1, 0, [](const std::string& operation) { return operation == "guide"; });
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->second, RunId("B"));
}

TEST(WaitingRoomTest, WhoLeavesOrWaitsForSomethingElseIsNotFound) {
  WaitingRoom room;
  room.Wait(1, Of("A"), {RobotId(), "guide"});
  room.Wait(1, Of("A"), {kR2, "guide"});
  EXPECT_FALSE(room.Next(kR1, 0, OffersAll).has_value());
  EXPECT_THAT(room.Oldest({kR2, "guide"}, 5), ElementsAre(Of("A")));
  room.Leave(Of("A"));
  room.Leave(Of("A"));
  EXPECT_THAT(room.Oldest({kR2, "guide"}, 5), IsEmpty());
  room.Block(4, RunId("D"), {kR1});
  room.Block(4, RunId("D"), {kR2});
  EXPECT_FALSE(room.Next(kR1, 0, OffersAll).has_value());
  room.Block(4, RunId("D"), {});
  EXPECT_FALSE(room.Next(kR2, 0, OffersAll).has_value());
}

TEST(WaitingRoomTest, WhoWaitsForARobotIsCounted) {
  WaitingRoom room;
  room.Wait(1, Of("A"), {kR1, "guide"});
  room.Wait(2, Of("B"), {kR1, "clean"});
  room.Wait(3, Of("C"), {RobotId(), "guide"});
  EXPECT_EQ(room.WaitingFor(kR1), 2u);
  room.Leave(Of("A"));
  EXPECT_EQ(room.WaitingFor(kR1), 1u);
  room.Leave(Of("B"));
  EXPECT_EQ(room.WaitingFor(kR1), 0u);
}

}  // namespace
}  // namespace docent::engine
