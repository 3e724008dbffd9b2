#include "robot_adapters/navigation/path_planner.h"

#include <cmath>

#include "gtest/gtest.h"
#include "tests/robot_adapters/navigation/small_hall.h"

namespace docent::robot {
namespace {

using maps::Point2;

PathPlanner Planner(const PlannerSettings& settings = {}) {
  return PathPlanner(SmallHallModel(), settings);
}

// The minimum clearance of a robot's centre on the path.
double LeastClearance(const std::vector<Point2>& path) {
  double least_m = 100;
  for (size_t i = 1; i < path.size(); ++i) {
    for (int k = 0; k <= 50; ++k) {
      const double t = k / 50.0;
      least_m = std::min(least_m,
                         SmallHallModel()->DistanceAt(path[i - 1].x_m + t * (path[i].x_m - path[i - 1].x_m),
                                                      path[i - 1].y_m + t * (path[i].y_m - path[i - 1].y_m)));
    }
  }
  return least_m;
}

TEST(PathPlannerTest, GoesThroughTheDoorWithClearance) {
  auto path = Planner().Plan({1, 1}, {11, 1});
  ASSERT_TRUE(path.ok()) << path.status();
  EXPECT_EQ(path->front(), (Point2{1, 1}));
  EXPECT_EQ(path->back(), (Point2{11, 1}));
  EXPECT_GT(LeastClearance(*path), 0.33);
  EXPECT_GT(LengthOf(*path), 11.0);
  EXPECT_LT(LengthOf(*path), 13.5);
  bool through_door = false;
  for (const Point2& p : *path) through_door |= std::abs(p.x_m - 6) < 0.7 && p.y_m > 3.4 && p.y_m < 4.6;
  EXPECT_TRUE(through_door);
}

TEST(PathPlannerTest, IsAlmostStraightInTheOpen) {
  auto path = Planner().Plan({1, 6}, {4.5, 6.5});
  ASSERT_TRUE(path.ok());
  EXPECT_LT(LengthOf(*path), 1.05 * std::hypot(3.5, 0.5));
}

TEST(PathPlannerTest, SameQuestionSameAnswer) {
  EXPECT_EQ(*Planner().Plan({1, 1}, {11, 5}), *Planner().Plan({1, 1}, {11, 5}));
}

TEST(PathPlannerTest, GoesRoundWhatIsSeenNow) {
  auto free = Planner().Plan({7, 2}, {11, 2});
  std::vector<Point2> people;
  for (double y = 1.4; y <= 2.6; y += 0.1) people.push_back({9, y});
  auto round = Planner().Plan({7, 2}, {11, 2}, people);
  ASSERT_TRUE(free.ok() && round.ok());
  EXPECT_GT(LengthOf(*round), LengthOf(*free) + 0.15);
  for (size_t i = 1; i < round->size(); ++i) {
    for (const Point2& person : people) {
      EXPECT_GT(maps::DistanceToSegment(person, (*round)[i - 1], (*round)[i]), 0.25);
    }
  }
}

TEST(PathPlannerTest, SaysWhyThereIsNoWay) {
  const PathPlanner planner = Planner();
  auto closed = planner.Plan({1, 1}, {10.5, 7});
  EXPECT_TRUE(absl::IsNotFound(closed.status())) << closed.status();
  auto in_wall = planner.Plan({1, 1}, {6, 1});
  EXPECT_TRUE(absl::IsFailedPrecondition(in_wall.status()));
  EXPECT_NE(in_wall.status().message().find("does not fit at (6.00, 1.00)"), absl::string_view::npos);
  EXPECT_TRUE(absl::IsFailedPrecondition(planner.Plan({1, 1}, {100, 1}).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(planner.Plan({-30, 1}, {1, 1}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(planner.Plan({std::nan(""), 1}, {1, 1}).status()));
  std::vector<Point2> in_the_door;
  for (double y = 3.4; y <= 4.6; y += 0.1) in_the_door.push_back({6, y});
  EXPECT_TRUE(absl::IsNotFound(planner.Plan({1, 1}, {11, 1}, in_the_door).status()));
}

TEST(PathPlannerTest, WideRobotDoesNotFitThroughTheDoor) {
  PlannerSettings wide;
  wide.robot_radius_m = 0.7;
  EXPECT_TRUE(absl::IsNotFound(Planner(wide).Plan({1.2, 1.2}, {11, 1.2}).status()));
}

TEST(PathPlannerTest, LeavesAPlaceBesideAWall) {
  auto path = Planner().Plan({0.3, 0.3}, {4, 6});
  ASSERT_TRUE(path.ok()) << path.status();
}

TEST(PathPlannerTest, NearestFreeIsFreeAndNear) {
  const PathPlanner planner = Planner();
  auto place = planner.NearestFree({6, 1}, 2);
  ASSERT_TRUE(place.ok());
  EXPECT_GE(SmallHallModel()->DistanceAt(place->x_m, place->y_m), planner.required_clearance_m() - 0.05);
  EXPECT_LT(maps::Distance(*place, {6, 1}), 0.7);
  EXPECT_TRUE(absl::IsNotFound(planner.NearestFree({-20, 1}, 2).status()));
}

TEST(PlannerSettingsTest, EachFieldHasItsRange) {
  EXPECT_TRUE(Validate(PlannerSettings{}).ok());
  PlannerSettings bad;
  bad.cell_m = 0.6;
  EXPECT_NE(Validate(bad).message().find("cell_m"), absl::string_view::npos);
  bad = {};
  bad.robot_radius_m = std::nan("");
  EXPECT_FALSE(Validate(bad).ok());
}

}  // namespace
}  // namespace docent::robot
