#include "robot_adapters/localization/global_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/robot_adapters/localization/small_drive.h"

namespace docent::robot {
namespace {

class GlobalSearchTest : public ::testing::Test {
 protected:
  const LocaliserSettings settings_;
  const SensorModel model_{SmallHall()->laser_field(), settings_.sensor};
  const maps::AnalyticScanner scanner_{SmallLayout(), {}};
};

TEST_F(GlobalSearchTest, FindsTheRobotWhereverItStands) {
  std::mt19937_64 random(11);
  for (const maps::Pose2 truth :
       {maps::Pose2{1.5, 1.5, 1.57}, {2, 5, -2.5}, {8, 4.6, 0.1}, {10, 2.2, -1.57}, {5, 7, 3.1}}) {
    const auto found = SearchGlobally(*SmallHall(), model_, scanner_.Scan(truth, {}, random), settings_, 3);
    ASSERT_FALSE(found.empty());
    EXPECT_LT(maps::Distance(found[0].robot_in_hall.position(), truth.position()), 0.05)
        << truth.x_m << " " << truth.y_m;
    EXPECT_LT(std::abs(maps::WrapAngle(found[0].robot_in_hall.heading_rad - truth.heading_rad)), 0.02);
  }
}

TEST_F(GlobalSearchTest, CandidatesAreBestFirstAndApart) {
  const auto found = SearchGlobally(*SmallHall(), model_, scanner_.ExactScan({8, 4.6, 0.1}), settings_, 8);
  ASSERT_GE(found.size(), 2u);
  ASSERT_LE(found.size(), 8u);
  for (size_t i = 1; i < found.size(); ++i) {
    EXPECT_GE(found[i - 1].log_likelihood, found[i].log_likelihood);
    const double apart_m =
        maps::Distance(found[0].robot_in_hall.position(), found[i].robot_in_hall.position());
    const double turned =
        std::abs(maps::WrapAngle(found[0].robot_in_hall.heading_rad - found[i].robot_in_hall.heading_rad));
    EXPECT_TRUE(apart_m >= settings_.search_step_m || turned >= 2 * settings_.search_step_rad);
  }
}

TEST_F(GlobalSearchTest, WithoutReturnsOrFreePlacesThereIsNoAnswer) {
  maps::LaserScan blind = scanner_.ExactScan({8, 4.6, 0.1});
  std::fill(blind.range_m.begin(), blind.range_m.end(), 0.0f);
  EXPECT_TRUE(SearchGlobally(*SmallHall(), model_, blind, settings_, 3).empty());
  maps::HallLayout full = SmallLayout();
  full.obstacles = {{"urn:block", maps::ObstacleKind::kOther, full.outline, std::nullopt, 3}};
  const auto hall = maps::HallModel::FromLayout(full);
  ASSERT_TRUE(hall.ok());
  EXPECT_TRUE(SearchGlobally(**hall, model_, scanner_.ExactScan({8, 4.6, 0.1}), settings_, 3).empty());
}

}  // namespace
}  // namespace docent::robot
