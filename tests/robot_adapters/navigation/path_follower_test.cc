#include "robot_adapters/navigation/path_follower.h"

#include <cmath>

#include "gtest/gtest.h"
#include "maps/analytic_scan.h"
#include "robot_adapters/navigation/path_planner.h"
#include "tests/robot_adapters/navigation/small_hall.h"

namespace docent::robot {
namespace {

using maps::Point2;
using maps::Pose2;

// A robot with perfect wheels and a perfect pose.
class Follow {
 public:
  explicit Follow(Pose2 start) : pose_(start), scanner_(SmallHall(), {}) {}

  void Step(PathFollower& follower, const std::vector<maps::Disc>& people = {}) {
    constexpr double kStepS = 0.05;
    const maps::LaserScan scan = scanner_.ExactScan(pose_, people);
    last_ = follower.Step(pose_, scan, pose_, kStepS);
    const double way = last_.speed_m_per_s * kStepS, turn = last_.turn_rad_per_s * kStepS;
    pose_ = maps::Compose(pose_, {way * std::cos(turn / 2), way * std::sin(turn / 2), turn});
    fastest_ = std::max(fastest_, last_.speed_m_per_s);
    bumped_ |= scanner_.Collides(pose_.position(), 0.25);
  }
  bool Run(PathFollower& follower, int steps) {
    for (int i = 0; i < steps && follower.state() != PathFollower::State::kArrived; ++i) Step(follower);
    return follower.state() == PathFollower::State::kArrived;
  }

  Pose2 pose_;
  maps::AnalyticScanner scanner_;
  DriveCommand last_;
  double fastest_ = 0;
  bool bumped_ = false;
};

TEST(PathFollowerTest, ArrivesAtTheGoalLookingTheRightWay) {
  PathFollower follower{FollowerSettings{}};
  auto path = PathPlanner(SmallHallModel(), {}).Plan({1, 1}, {11, 1});
  ASSERT_TRUE(path.ok());
  follower.Start(*path, 1.57);
  EXPECT_NEAR(follower.length_m(), LengthOf(*path), 1e-9);
  Follow robot({1, 1, -2});
  ASSERT_TRUE(robot.Run(follower, 2000));
  EXPECT_LT(maps::Distance(robot.pose_.position(), {11, 1}), 0.12);
  EXPECT_LT(std::abs(maps::WrapAngle(robot.pose_.heading_rad - 1.57)), 0.05);
  EXPECT_FALSE(robot.bumped_);
  EXPECT_LE(robot.fastest_, 0.7 + 1e-9);
  EXPECT_GT(robot.fastest_, 0.5);
  EXPECT_EQ(follower.remaining_m(), 0);
}

TEST(PathFollowerTest, TurnsOnTheSpotWhenTheGoalIsHere) {
  PathFollower follower{FollowerSettings{}};
  follower.Start({{2, 2}}, 3.0);
  Follow robot({2, 2, 0});
  ASSERT_TRUE(robot.Run(follower, 400));
  EXPECT_LT(maps::Distance(robot.pose_.position(), {2, 2}), 0.01);
}

TEST(PathFollowerTest, StopsBeforeAPersonAndGoesOnWhenTheyLeave) {
  PathFollower follower{FollowerSettings{}};
  follower.Start({{1, 6}, {5, 6}}, 0);
  Follow robot({1, 6, 0});
  const std::vector<maps::Disc> person = {{{3, 6}, 0.22}};
  for (int i = 0; i < 400; ++i) robot.Step(follower, person);
  EXPECT_EQ(follower.state(), PathFollower::State::kBlocked);
  EXPECT_GT(follower.blocked_s(), 1.0);
  EXPECT_EQ(robot.last_.speed_m_per_s, 0);
  EXPECT_GT(maps::Distance(robot.pose_.position(), {3, 6}), 0.22 + 0.25);
  EXPECT_TRUE(robot.Run(follower, 1000));
}

TEST(PathFollowerTest, NeverCommandsWhatTheScanForbids) {
  PathFollower follower{FollowerSettings{}};
  follower.Start({{1, 6}, {5, 6}}, 0);
  maps::LaserScan scan;
  scan.first_bearing_rad = 0;
  scan.bearing_step_rad = 0.1;
  scan.max_range_m = 20;
  scan.range_m = {0.29f};  // right ahead, too near
  const DriveCommand command = follower.Step({1, 6, 0}, scan, {1, 6, 0}, 0.05);
  EXPECT_EQ(command.speed_m_per_s, 0);
  EXPECT_EQ(follower.state(), PathFollower::State::kBlocked);
}

TEST(PathFollowerTest, StopAndIdleStandStill) {
  PathFollower follower{FollowerSettings{}};
  Follow robot({1, 1, 0});
  robot.Step(follower);
  EXPECT_EQ(follower.state(), PathFollower::State::kIdle);
  follower.Start({{1, 1}, {4, 1}}, 0);
  for (int i = 0; i < 20; ++i) robot.Step(follower);
  follower.Stop();
  robot.Step(follower);
  EXPECT_EQ(robot.last_.speed_m_per_s, 0);
  EXPECT_EQ(follower.state(), PathFollower::State::kIdle);
}

TEST(PathFollowerTest, PointsOfAScanAreInTheRobotsFrameOfNow) {
  maps::LaserScan scan;
  scan.first_bearing_rad = 0;
  scan.bearing_step_rad = 1;
  scan.range_m = {2.f, 0.f};
  const auto points = PathFollower::PointsOf(scan, {0, 0, 0}, {1, 0, 0});  // it has moved a metre since
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].x_m, 1, 1e-6);
  EXPECT_NEAR(points[0].y_m, 0, 1e-6);
}

TEST(FollowerSettingsTest, EachFieldHasItsRange) {
  EXPECT_TRUE(Validate(FollowerSettings{}).ok());
  FollowerSettings bad;
  bad.max_speed_m_per_s = 5;
  EXPECT_NE(Validate(bad).message().find("max_speed_m_per_s"), absl::string_view::npos);
}

}  // namespace
}  // namespace docent::robot
