#include "robot_adapters/localization/sensor_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/robot_adapters/localization/small_drive.h"

namespace docent::robot {
namespace {

const maps::Pose2 kTruth = {7.2, 4.9, 0.4};

class SensorModelTest : public ::testing::Test {
 protected:
  SensorModelTest() {
    std::mt19937_64 random(3);
    scan_ = scanner_.Scan(kTruth, {}, random);
    ends_ = EndsOf(scan_, 180);
  }
  double At(double x, double y, double heading) const { return model_.LogLikelihood(ends_, {x, y, heading}); }

  const maps::AnalyticScanner scanner_{SmallLayout(), {}};
  const SensorModel model_{SmallHall()->laser_field(), {}};
  maps::LaserScan scan_;
  BeamEnds ends_;
};

TEST_F(SensorModelTest, TheTruePoseScoresBestAndWorseTheFartherAway) {
  const double truth = At(7.2, 4.9, 0.4);
  EXPECT_GT(truth, 0.1 * ends_.size() * model_.worst_beam()) << "most beams are explained";
  double before = truth;
  for (const double off : {0.05, 0.10, 0.30}) {
    const double here = At(7.2 + off, 4.9, 0.4);
    EXPECT_LT(here, before) << off;
    before = here;
  }
  EXPECT_LT(At(7.2, 4.9, 0.45), truth);
  EXPECT_LT(At(2, 4, 0.4), 0.5 * ends_.size() * model_.worst_beam());
}

// The error of MRPT's COctoMap: unknown space counted as log 1, so a pose beyond the map was the best of all.
TEST_F(SensorModelTest, APoseOutsideTheMapIsTheWorstThereIs) {
  const double worst = static_cast<double>(ends_.size()) * model_.worst_beam();
  for (const maps::Pose2 outside : {maps::Pose2{200, 200, 0}, {-100, 4, 1}, {1e7, -1e7, 0}}) {
    EXPECT_NEAR(model_.LogLikelihood(ends_, outside), worst, 1e-3);
  }
  EXPECT_LT(worst, At(7.2, 4.9, 0.4) - 10);
}

TEST_F(SensorModelTest, NoBeamsSayNothing) {
  EXPECT_EQ(model_.LogLikelihood(BeamEnds(), kTruth), 0);
}

TEST_F(SensorModelTest, BeamsAreThinnedEvenlyAndLostOnesLeftOut) {
  maps::LaserScan scan;
  scan.first_bearing_rad = -1;
  scan.bearing_step_rad = 0.02;
  scan.max_range_m = 10;
  scan.range_m.assign(100, 2.0f);
  EXPECT_EQ(EndsOf(scan, 180).size(), 100u);
  const BeamEnds few = EndsOf(scan, 10);
  ASSERT_EQ(few.size(), 10u);
  EXPECT_NEAR(std::atan2(few.y_m[1], few.x_m[1]), -0.8, 1e-5);
  scan.range_m[0] = 0;
  scan.range_m[1] = 10;
  scan.range_m[2] = 25;
  EXPECT_EQ(EndsOf(scan, 180).size(), 97u);
  scan.sensor_in_robot = {0.5, -0.25, 0};
  EXPECT_EQ(EndsOf(scan, 1).sensor, (maps::Point2{0.5, -0.25}));
}

TEST_F(SensorModelTest, OnlyAWrongPoseLooksThroughWalls) {
  const maps::DistanceGrid& field = SmallHall()->laser_field();
  EXPECT_LT(ShareThroughWalls(field, ends_, kTruth, 0.3), 0.02);
  EXPECT_GT(ShareThroughWalls(field, ends_, {2, 1, -2}, 0.3), 0.2);
  const std::vector<maps::Disc> crowd = {{{8, 5.2}, 0.25}, {{7, 4}, 0.25}, {{6, 5.5}, 0.25}};
  const BeamEnds crowded = EndsOf(scanner_.ExactScan(kTruth, crowd), 180);
  EXPECT_LT(ShareThroughWalls(field, crowded, kTruth, 0.3), 0.02)
      << "people shorten beams, they lengthen none";
  EXPECT_EQ(ShareThroughWalls(field, BeamEnds(), kTruth, 0.3), 0);
}

}  // namespace
}  // namespace docent::robot
