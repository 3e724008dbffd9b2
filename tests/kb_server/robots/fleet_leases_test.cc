#include "kb_server/robots/fleet_leases.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class FleetLeasesTest : public ::testing::Test {
 protected:
  void Renew(const std::string& description = "d") {
    leases_.Renew("R", incarnation_, description, [this](bool tell) { decided_.push_back(tell); });
  }
  std::vector<std::string> Lost() {
    std::vector<std::string> robots;
    for (const FleetLeases::Lost& lost : leases_.TakeLost()) {
      robots.push_back(lost.robot);
      seen_us_ = lost.seen_us;
    }
    return robots;
  }
  // What is to be told is told when the test calls ToldLost.
  void Leave(const std::string& incarnation = "i1") {
    leases_.Leave("R", incarnation, [this](const FleetLeases::Lost* lost) {
      left_.push_back(lost != nullptr);
      if (lost != nullptr) seen_us_ = lost->seen_us;
    });
  }
  void PassALease() { clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs)); }

  ManualClock clock_{1'000'000};
  FleetLeases leases_{&clock_};
  std::string incarnation_ = "i1";
  std::vector<bool> decided_, left_;
  TimeMicros seen_us_ = -1;  // of the robot that was lost last
};

TEST_F(FleetLeasesTest, WhatTheGraphHasNoLongerIsToldAgain) {
  Renew();
  leases_.Untell("R");  // while it is under way nothing is known
  leases_.Told("R", "d", true);
  Renew();
  leases_.Untell("R");
  leases_.Untell("somebody else");
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, false, true));
}

TEST_F(FleetLeasesTest, WhoIsLostWasLastSeenWhenItRenewed) {
  Renew();
  leases_.Told("R", "d", true);
  const TimeMicros renewed_us = clock_.Now();
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R"));
  EXPECT_EQ(seen_us_, renewed_us);
  leases_.Expect("S", "s:1", "i1");
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("S"));
  EXPECT_EQ(seen_us_, 0) << "not by this server";
}

TEST_F(FleetLeasesTest, WhereTimeIsSimulatedLeasesLastInTheTimeOfThisWorldAndTheGraphIsToldTheOther) {
  ManualClock simulated(7'000'000);
  FleetLeases leases(&simulated, &clock_);
  leases.Renew("R", "i1", "d", [](bool) {});
  leases.Told("R", "d", true);
  simulated.Advance(std::chrono::hours(9));
  EXPECT_TRUE(leases.TakeLost().empty()) << "its adapter was heard of a moment ago";
  PassALease();
  const std::vector<FleetLeases::Lost> lost = leases.TakeLost();
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].seen_us, 7'000'000);
}

TEST_F(FleetLeasesTest, OneAdapterSpeaksForARobotWhileItsLeaseLives) {
  EXPECT_EQ(leases_.Claim("R", "a:1"), "");
  Renew();
  leases_.Told("R", "d", true);
  EXPECT_EQ(leases_.Claim("R", "b:2"), "a:1");
  EXPECT_EQ(leases_.RivalOf("R"), "b:2");
  EXPECT_EQ(leases_.Claim("R", "a:1"), "") << "it goes on";
  EXPECT_EQ(leases_.Claim("R", "b:2", "a:1"), "") << "no adapter is at the first address any more";
  EXPECT_EQ(leases_.RivalOf("R"), "") << "it speaks for the robot itself now";
  EXPECT_EQ(leases_.Claim("R", "a:1"), "b:2");
  PassALease();
  EXPECT_EQ(leases_.RivalOf("R"), "") << "it has not asked again";
  EXPECT_EQ(leases_.Claim("R", "c:3"), "");
}

TEST_F(FleetLeasesTest, AfterARestartTheAdapterThatTheGraphHasSpeaksForOneLease) {
  leases_.Expect("R", "a:1", "i1");
  EXPECT_EQ(leases_.Claim("R", "b:2"), "a:1");
  EXPECT_EQ(leases_.Claim("R", "a:1"), "");
}

TEST_F(FleetLeasesTest, TheGraphIsToldOfANewRobotAndOfAChangedDescriptionOnly) {
  Renew();
  leases_.Told("R", "d", true);
  Renew();
  Renew("other");
  leases_.Told("R", "other", true);
  Renew("other");
  EXPECT_THAT(decided_, ElementsAre(true, false, true, false));
  EXPECT_THAT(Lost(), IsEmpty());
}

TEST_F(FleetLeasesTest, WhatTheGraphRefusedIsToldAgain) {
  Renew();
  leases_.Told("R", "d", false);
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, true));
  leases_.Told("R", "d", false);
  PassALease();
  EXPECT_THAT(Lost(), IsEmpty()) << "the graph never had it";
}

TEST_F(FleetLeasesTest, ARobotThatJoinsWhileItsLossIsUnderWayIsToldAfterIt) {
  Renew();
  leases_.Told("R", "d", true);
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R"));
  EXPECT_THAT(Lost(), IsEmpty());
  decided_.clear();
  Renew();
  Renew();
  EXPECT_THAT(decided_, IsEmpty()) << "the graph has yet to say what it has";
  leases_.ToldLost("R", true);
  EXPECT_THAT(decided_, ElementsAre(true));
  leases_.Told("R", "d", true);
  EXPECT_THAT(decided_, ElementsAre(true, false));
}

TEST_F(FleetLeasesTest, ALossThatWasRefusedIsToldOneLeaseLater) {
  leases_.Expect("R", "r:1", "i1");
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R"));
  leases_.ToldLost("R", false);
  EXPECT_THAT(Lost(), IsEmpty()) << "not at once";
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R"));
  leases_.ToldLost("R", true);
  PassALease();
  EXPECT_THAT(Lost(), IsEmpty());
}

TEST_F(FleetLeasesTest, ALossThatWasRefusedWhileTheRobotCameBackIsNoNews) {
  Renew();
  leases_.Told("R", "d", true);
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R"));
  Renew();
  leases_.ToldLost("R", false);
  EXPECT_THAT(decided_, ElementsAre(true, false));
  EXPECT_THAT(Lost(), IsEmpty());
}

TEST_F(FleetLeasesTest, WhoLeavesIsLostAtOnceAndOnce) {
  Renew();
  leases_.Told("R", "d", true);
  clock_.Advance(std::chrono::milliseconds(1));
  Leave();
  EXPECT_THAT(left_, ElementsAre(true));
  EXPECT_EQ(seen_us_, clock_.Now());
  EXPECT_THAT(Lost(), IsEmpty()) << "its loss is under way";
  Leave();  // waits for that
  leases_.ToldLost("R", true);
  Leave();
  EXPECT_THAT(left_, ElementsAre(true, false, false)) << "a Leave may be repeated";
  EXPECT_THAT(Lost(), IsEmpty());
  EXPECT_EQ(leases_.Claim("R", "b:2"), "") << "another adapter may speak for it";
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, true));
}

TEST_F(FleetLeasesTest, ALeaveOfAnotherIncarnationOrOfAnUnknownRobotChangesNothing) {
  Leave();
  Renew();
  leases_.Told("R", "d", true);
  incarnation_ = "i2";
  Renew();
  Leave("i1");
  EXPECT_THAT(left_, ElementsAre(false, false));
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R")) << "its lease lived as long as ever";
  leases_.ToldLost("R", true);

  leases_.Expect("R", "a:1", "i3");
  Leave("i2");
  Leave("i3");
  EXPECT_THAT(left_, ElementsAre(false, false, false, true)) << "after a restart of the server, too";
}

TEST_F(FleetLeasesTest, WhoLeavesWhileItsJoinIsUnderWayIsLostAfterIt) {
  Renew();
  Leave();
  EXPECT_THAT(left_, IsEmpty());
  incarnation_ = "i2";
  Renew("other");
  leases_.Told("R", "d", true);
  EXPECT_THAT(left_, ElementsAre(true));
  leases_.ToldLost("R", true);
  EXPECT_THAT(decided_, ElementsAre(true, true)) << "the next life is told after the loss";
  leases_.Told("R", "other", true);
  EXPECT_THAT(Lost(), IsEmpty());
}

TEST_F(FleetLeasesTest, ALeaveThatTheGraphRefusedIsALossOneLeaseLater) {
  Renew();
  leases_.Told("R", "d", true);
  Leave();
  leases_.ToldLost("R", false);
  EXPECT_THAT(Lost(), IsEmpty());
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("R"));
}

TEST_F(FleetLeasesTest, AfterARestartAJoinIsToldOnce) {
  leases_.Expect("R", "r:1", "i1");
  Renew();
  leases_.Told("R", "d", true);
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, false));
}

}  // namespace
}  // namespace docent::server
