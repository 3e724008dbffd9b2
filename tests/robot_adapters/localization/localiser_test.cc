#include "robot_adapters/localization/localiser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "tests/robot_adapters/localization/small_drive.h"

namespace docent::robot {
namespace {

struct Errors {
  double rmse_m = 0;
  double rmse_rad = 0;
  double last_m = 0;
};

Errors Drive(Localiser& localiser, const std::vector<DriveStep>& steps) {
  Errors errors;
  for (const DriveStep& step : steps) {
    const absl::StatusOr<Estimate> e = localiser.Update(step.odometry, step.scan);
    EXPECT_TRUE(e.ok()) << e.status();
    errors.last_m = maps::Distance(e->pose().position(), step.truth.position());
    errors.rmse_m += errors.last_m * errors.last_m;
    errors.rmse_rad += std::pow(maps::WrapAngle(e->heading_rad - step.truth.heading_rad), 2);
  }
  errors.rmse_m = std::sqrt(errors.rmse_m / static_cast<double>(steps.size()));
  errors.rmse_rad = std::sqrt(errors.rmse_rad / static_cast<double>(steps.size()));
  return errors;
}

TEST(Localiser, FollowsTheRobotToACentimetreOrTwo) {
  for (const uint64_t seed : {1, 2, 3}) {
    const SmallDrive drive(seed);
    Localiser localiser(SmallHall(), {}, seed);
    ASSERT_TRUE(localiser.InitialiseAt(drive.start, 0.2, 0.1).ok());
    const Errors errors = Drive(localiser, drive.steps);
    EXPECT_LT(errors.rmse_m, 0.022) << "seed " << seed;
    EXPECT_LT(errors.rmse_rad, 0.3 * 3.14159 / 180) << "seed " << seed;
    EXPECT_TRUE(localiser.estimate().localised);
    EXPECT_EQ(localiser.estimate().relocalisations, 0);
    EXPECT_LT(std::sqrt(localiser.estimate().covariance[0]), 0.05);
    EXPECT_GT(localiser.estimate().neff, 1);
  }
}

TEST(Localiser, StartsFromNothingButOneScan) {
  const SmallDrive drive(4);
  Localiser localiser(SmallHall(), {}, 4);
  ASSERT_TRUE(localiser.InitialiseGlobally(drive.first_scan).ok());
  EXPECT_EQ(localiser.Particles().size(), 5000u);
  const Errors errors = Drive(localiser, drive.steps);
  EXPECT_LT(errors.rmse_m, 0.03);
  EXPECT_EQ(localiser.Particles().size(), 1000u) << "thinned once sure";
}

TEST(Localiser, ACarriedOffRobotFindsItselfAgain) {
  const SmallDrive drive(5);
  const size_t half = drive.steps.size() / 2;
  Localiser localiser(SmallHall(), {}, 5);
  ASSERT_TRUE(localiser.InitialiseAt(drive.start, 0.2, 0.1).ok());
  Drive(localiser, {drive.steps.begin(), drive.steps.begin() + half / 4});
  const Errors errors = Drive(localiser, {drive.steps.begin() + half, drive.steps.end()});
  EXPECT_LT(errors.last_m, 0.05);
  EXPECT_GE(localiser.estimate().relocalisations, 1);
}

TEST(Localiser, WithoutRelocalisationItSaysThatItIsLost) {
  const SmallDrive drive(5);
  LocaliserSettings settings;
  settings.relocalise = false;
  Localiser localiser(SmallHall(), settings, 5);
  ASSERT_TRUE(localiser.InitialiseAt({10, 2.2, -1.57}, 0.02, 0.02).ok());
  Drive(localiser, {drive.steps.begin(), drive.steps.begin() + 20});
  EXPECT_FALSE(localiser.estimate().localised);
  EXPECT_GT(localiser.estimate().lost_share, settings.lost_above);
  EXPECT_EQ(localiser.estimate().relocalisations, 0);
}

std::vector<maps::Pose2> PosesOf(uint64_t seed, const SmallDrive& drive) {
  Localiser localiser(SmallHall(), {}, seed);
  EXPECT_TRUE(localiser.InitialiseGlobally(drive.first_scan).ok());
  std::vector<maps::Pose2> poses;
  for (const DriveStep& step : drive.steps)
    poses.push_back(localiser.Update(step.odometry, step.scan)->pose());
  return poses;
}

TEST(Localiser, TheSameSeedGivesTheSamePosesWhateverElseRuns) {
  const SmallDrive drive(6);
  const std::vector<maps::Pose2> alone = PosesOf(6, drive);
  std::vector<maps::Pose2> first, second;
  std::thread one([&] { first = PosesOf(6, drive); });
  std::thread two([&] { second = PosesOf(7, drive); });
  one.join();
  two.join();
  EXPECT_EQ(alone, first);
  EXPECT_NE(alone, second);
}

TEST(Localiser, BadInputIsRefusedAndChangesNothing) {
  const SmallDrive drive(8);
  Localiser localiser(SmallHall(), {}, 8);
  const DriveStep& step = drive.steps[0];
  EXPECT_EQ(localiser.Update(step.odometry, step.scan).status().code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(localiser.InitialiseAt(drive.start, 0, 0.1).code(), absl::StatusCode::kInvalidArgument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(localiser.InitialiseAt({nan, 0, 0}, 0.1, 0.1).code(), absl::StatusCode::kInvalidArgument);
  maps::LaserScan blind = step.scan;
  std::fill(blind.range_m.begin(), blind.range_m.end(), 0.0f);
  EXPECT_EQ(localiser.InitialiseGlobally(blind).code(), absl::StatusCode::kNotFound);
  ASSERT_TRUE(localiser.InitialiseAt(drive.start, 0.1, 0.1).ok());
  const maps::Pose2 before = localiser.estimate().pose();
  EXPECT_EQ(localiser.Update({nan, 0, 0}, step.scan).status().code(), absl::StatusCode::kInvalidArgument);
  maps::LaserScan broken = step.scan;
  broken.range_m[3] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(localiser.Update(step.odometry, broken).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(localiser.estimate().pose(), before);
  EXPECT_TRUE(localiser.Update(step.odometry, step.scan).ok());
}

TEST(Localiser, ABlindScanMovesTheParticlesByTheOdometryOnly) {
  const SmallDrive drive(9);
  Localiser localiser(SmallHall(), {}, 9);
  ASSERT_TRUE(localiser.InitialiseAt({8, 4.6, 0}, 0.01, 0.01).ok());
  maps::LaserScan blind = drive.first_scan;
  std::fill(blind.range_m.begin(), blind.range_m.end(), 0.0f);
  const absl::StatusOr<Estimate> e = localiser.Update({0.3, 0, 0}, blind);
  ASSERT_TRUE(e.ok()) << e.status();
  EXPECT_NEAR(e->x_m, 8.3, 0.01);
  EXPECT_NEAR(e->y_m, 4.6, 0.01);
}

TEST(LocaliserSettings, DefaultsAreValidAndEachRangeIsHeld) {
  EXPECT_TRUE(Validate(LocaliserSettings()).ok());
  LocaliserSettings settings;
  settings.particles = 49;
  EXPECT_NE(Validate(settings).message().find("particles = 49 is not in 50..100000"), std::string::npos);
  settings = {};
  settings.sensor.temper = 0;
  EXPECT_FALSE(Validate(settings).ok());
  settings = {};
  settings.motion.min_xy_m = 0;
  EXPECT_FALSE(Validate(settings).ok());
  settings = {};
  settings.lost_above = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Validate(settings).ok());
}

}  // namespace
}  // namespace docent::robot
