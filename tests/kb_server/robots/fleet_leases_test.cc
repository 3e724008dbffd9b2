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
    leases_.Renew("R", description, [this](bool tell) { decided_.push_back(tell); });
  }
  std::vector<std::string> Lost() {
    std::vector<std::string> robots;
    for (const FleetLeases::Lost& lost : leases_.TakeLost()) {
      robots.push_back(lost.robot);
      seen_us_ = lost.seen_us;
    }
    return robots;
  }
  void PassALease() { clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs)); }

  ManualClock clock_{1'000'000};
  FleetLeases leases_{&clock_};
  std::vector<bool> decided_;
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
  leases_.Expect("S", "s:1");
  PassALease();
  EXPECT_THAT(Lost(), ElementsAre("S"));
  EXPECT_EQ(seen_us_, 0) << "not by this server";
}

TEST_F(FleetLeasesTest, WhereTimeIsSimulatedLeasesLastInTheTimeOfThisWorldAndTheGraphIsToldTheOther) {
  ManualClock simulated(7'000'000);
  FleetLeases leases(&simulated, &clock_);
  leases.Renew("R", "d", [](bool) {});
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
  EXPECT_EQ(leases_.Claim("R", "a:1"), "b:2");
  PassALease();
  EXPECT_EQ(leases_.RivalOf("R"), "") << "it has not asked again";
  EXPECT_EQ(leases_.Claim("R", "c:3"), "");
}

TEST_F(FleetLeasesTest, AfterARestartTheAdapterThatTheGraphHasSpeaksForOneLease) {
  leases_.Expect("R", "a:1");
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
  leases_.Expect("R", "r:1");
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

TEST_F(FleetLeasesTest, AfterARestartAJoinIsToldOnce) {
  leases_.Expect("R", "r:1");
  Renew();
  leases_.Told("R", "d", true);
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, false));
}

}  // namespace
}  // namespace docent::server
