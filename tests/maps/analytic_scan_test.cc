#include "maps/analytic_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/maps/layout_quads.h"

namespace docent::maps {
namespace {

class AnalyticScanTest : public ::testing::Test {
 protected:
  const HallLayout layout_ = *HallLayout::FromQuads(LayoutQuads::SmallHall().quads());
  const ScannerSettings settings_;
  const AnalyticScanner scanner_{layout_, settings_};
};

TEST_F(AnalyticScanTest, RaysMeetWallsPillarsAndTheOutline) {
  const double pi = std::numbers::pi;
  EXPECT_NEAR(scanner_.CastRay({2, 1}, 0, {}), 2.0, 1e-12);         // the partition at x = 4
  EXPECT_NEAR(scanner_.CastRay({2, 1}, pi, {}), 2.0, 1e-12);        // the outline at x = 0
  EXPECT_NEAR(scanner_.CastRay({2, 4}, 0, {}), 3.7, 1e-12);         // the pillar
  EXPECT_NEAR(scanner_.CastRay({8, 4}, pi / 2, {}), 2.0, 1e-12);    // the desk reaches 1 m, the laser sees it
  EXPECT_NEAR(scanner_.CastRay({1.5, 4}, pi / 2, {}), 4.0, 1e-12);  // the step of 0.15 m is below the laser
  EXPECT_NEAR(scanner_.CastRay({2, 4}, pi / 4, {}), 4 * std::sqrt(2), 1e-12);
}

TEST_F(AnalyticScanTest, PeopleStandInTheWayButAreNotInTheMap) {
  EXPECT_NEAR(scanner_.CastRay({2, 1}, 0, {{{3, 1}, 0.25}}), 0.75, 1e-12);
  EXPECT_NEAR(scanner_.CastRay({2, 1}, 0, {{{3, 2}, 0.25}}), 2.0, 1e-12);
}

TEST_F(AnalyticScanTest, ScanCountsBeamsFromTheFirstBearingInTheRobotsFrame) {
  ScannerSettings settings;
  settings.beams = 3;
  settings.field_of_view_rad = std::numbers::pi;
  settings.sensor_in_robot = {0.2, 0, 0};
  const LaserScan scan = AnalyticScanner(layout_, settings).ExactScan({2, 1, std::numbers::pi / 2});
  ASSERT_EQ(scan.range_m.size(), 3u);
  EXPECT_NEAR(scan.first_bearing_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(scan.range_m[0], 2.0, 1e-6);  // to the right: +x
  EXPECT_NEAR(scan.range_m[1], 6.8, 1e-6);  // ahead: the north wall, from 0.2 m ahead of the robot
  EXPECT_NEAR(scan.range_m[2], 2.0, 1e-6);  // to the left: -x
}

TEST_F(AnalyticScanTest, BeamsBeyondTheRangeReturnNothing) {
  ScannerSettings settings;
  settings.max_range_m = 1;
  for (const float range : AnalyticScanner(layout_, settings).ExactScan({2, 4, 0}).range_m)
    EXPECT_EQ(range, 0.0f);
}

TEST_F(AnalyticScanTest, NoiseIsSeededAndAsLargeAsStated) {
  std::mt19937_64 first(7), second(7);
  const Pose2 pose = {2, 4.5, 0.3};
  const LaserScan a = scanner_.Scan(pose, {}, first), b = scanner_.Scan(pose, {}, second);
  EXPECT_EQ(a.range_m, b.range_m);
  const LaserScan exact = scanner_.ExactScan(pose);
  double squares = 0;
  int returns = 0, lost = 0;
  for (int k = 0; k < 200; ++k) {
    const LaserScan scan = scanner_.Scan(pose, {}, first);
    for (size_t i = 0; i < scan.range_m.size(); ++i) {
      if (scan.range_m[i] == 0) {
        ++lost;
        continue;
      }
      squares += std::pow(scan.range_m[i] - exact.range_m[i], 2);
      ++returns;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / returns), settings_.range_sigma_m, 0.001);
  EXPECT_NEAR(lost / 36000.0, settings_.dropout, 0.003);
}

TEST_F(AnalyticScanTest, CollisionsCountEveryHeight) {
  EXPECT_FALSE(scanner_.Collides({2, 4}, 0.3));
  EXPECT_TRUE(scanner_.Collides({1.5, 5.8}, 0.3)) << "the low step";
  EXPECT_TRUE(scanner_.Collides({6, 4.5}, 0.3)) << "the pillar";
  EXPECT_TRUE(scanner_.Collides({0.2, 4}, 0.3)) << "the outline";
  EXPECT_TRUE(scanner_.Collides({-1, 4}, 0.3)) << "outside";
}

}  // namespace
}  // namespace docent::maps
