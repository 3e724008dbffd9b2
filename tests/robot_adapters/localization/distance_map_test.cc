#include "robot_adapters/localization/distance_map.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/poses/CPose3D.h>

#include "tests/robot_adapters/localization/small_drive.h"

namespace docent::robot {
namespace {

TEST(DistanceMap, AScanGoesToMrptAndBack) {
  maps::ScannerSettings settings;
  settings.sensor_in_robot = {0.2, -0.1, 0.3};
  std::mt19937_64 random(5);
  const maps::LaserScan scan = maps::AnalyticScanner(SmallLayout(), settings).Scan({2, 4, 0.2}, {}, random);
  const maps::LaserScan back = FromMrpt(*ToMrpt(scan));
  const BeamEnds before = EndsOf(scan, 1000), after = EndsOf(back, 1000);
  ASSERT_EQ(before.size(), after.size());
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(before.x_m[i], after.x_m[i], 1e-4);
    EXPECT_NEAR(before.y_m[i], after.y_m[i], 1e-4);
  }
}

TEST(DistanceMap, WeighsAsTheSensorModelDoesPreparedOrNot) {
  const auto model = std::make_shared<SensorModel>(SmallHall()->laser_field(), SensorModelSettings());
  std::mt19937_64 random(
      6);  // noise: the ends of exact beams lie on borders of cells, where rounding decides
  const maps::LaserScan scan = maps::AnalyticScanner(SmallLayout(), {}).Scan({2.003, 4.007, 0.2}, {}, random);
  const auto observation = ToMrpt(scan);
  DistanceMap map(model, 180);
  EXPECT_FALSE(map.isEmpty());
  const mrpt::poses::CPose3D pose(2.1, 4, 0, 0.2, 0, 0);
  const double expected = model->LogLikelihood(EndsOf(scan, 180), {2.1, 4, 0.2});
  EXPECT_NEAR(map.computeObservationLikelihood(*observation, pose), expected, 0.05);
  map.Prepare(*observation);
  EXPECT_NEAR(map.computeObservationLikelihood(*observation, pose), expected, 0.05);
}

TEST(DistanceMap, ItIsReadOnlyAndWeighsOnlyScans) {
  DistanceMap map(std::make_shared<SensorModel>(SmallHall()->laser_field(), SensorModelSettings()), 180);
  EXPECT_FALSE(map.insertObservation(*ToMrpt(maps::LaserScan())));
  EXPECT_TRUE(map.canComputeObservationLikelihood(*ToMrpt(maps::LaserScan())));
  EXPECT_FALSE(map.canComputeObservationLikelihood(mrpt::obs::CObservationOdometry()));
  map.clear();
  EXPECT_TRUE(map.isEmpty());
}

}  // namespace
}  // namespace docent::robot
