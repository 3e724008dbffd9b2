#include "robot_adapters/mrpt_files/mrpt_scan.h"

#include <gtest/gtest.h>

#include "robot_adapters/localization/sensor_model.h"
#include "tests/robot_adapters/localization/small_drive.h"

namespace docent::robot {
namespace {

TEST(MrptScan, AScanGoesToMrptAndBack) {
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

}  // namespace
}  // namespace docent::robot
