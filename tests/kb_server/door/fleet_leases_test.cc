#include "kb_server/door/fleet_leases.h"

#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace docent {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class FleetLeasesTest : public ::testing::Test {
 protected:
  void Renew(const std::string& description = "d") {
    leases_.Renew("R", description, [this](bool tell) { decided_.push_back(tell); });
  }
  void PassALease() { clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs)); }

  ManualClock clock_{1'000'000};
  FleetLeases leases_{&clock_};
  std::vector<bool> decided_;
};

TEST_F(FleetLeasesTest, TheGraphIsToldOfANewRobotAndOfAChangedDescriptionOnly) {
  Renew();
  leases_.Told("R", "d", true);
  Renew();
  Renew("other");
  leases_.Told("R", "other", true);
  Renew("other");
  EXPECT_THAT(decided_, ElementsAre(true, false, true, false));
  EXPECT_THAT(leases_.TakeLost(), IsEmpty());
}

TEST_F(FleetLeasesTest, WhatTheGraphRefusedIsToldAgain) {
  Renew();
  leases_.Told("R", "d", false);
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, true));
  leases_.Told("R", "d", false);
  PassALease();
  EXPECT_THAT(leases_.TakeLost(), IsEmpty()) << "the graph never had it";
}

TEST_F(FleetLeasesTest, ARobotThatJoinsWhileItsLossIsUnderWayIsToldAfterIt) {
  Renew();
  leases_.Told("R", "d", true);
  PassALease();
  EXPECT_THAT(leases_.TakeLost(), ElementsAre("R"));
  EXPECT_THAT(leases_.TakeLost(), IsEmpty());
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
  leases_.Expect("R");
  PassALease();
  EXPECT_THAT(leases_.TakeLost(), ElementsAre("R"));
  leases_.ToldLost("R", false);
  EXPECT_THAT(leases_.TakeLost(), IsEmpty()) << "not at once";
  PassALease();
  EXPECT_THAT(leases_.TakeLost(), ElementsAre("R"));
  leases_.ToldLost("R", true);
  PassALease();
  EXPECT_THAT(leases_.TakeLost(), IsEmpty());
}

TEST_F(FleetLeasesTest, ALossThatWasRefusedWhileTheRobotCameBackIsNoNews) {
  Renew();
  leases_.Told("R", "d", true);
  PassALease();
  EXPECT_THAT(leases_.TakeLost(), ElementsAre("R"));
  Renew();
  leases_.ToldLost("R", false);
  EXPECT_THAT(decided_, ElementsAre(true, false));
  EXPECT_THAT(leases_.TakeLost(), IsEmpty());
}

TEST_F(FleetLeasesTest, AfterARestartAJoinIsToldOnce) {
  leases_.Expect("R");
  Renew();
  leases_.Told("R", "d", true);
  Renew();
  EXPECT_THAT(decided_, ElementsAre(true, false));
}

}  // namespace
}  // namespace docent
