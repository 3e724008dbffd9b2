// From cells to the outline of a floor and what stands in it.
#include "maps/import/floor_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "maps/wkt.h"

namespace docent::maps {
namespace {

// '.' free, '#' occupied, '?' unknown; the first row is the uppermost. A cell is a metre.
OccupancyGrid Grid(const std::vector<std::string>& rows, const Pose2& origin = {}) {
  OccupancyGrid grid = {static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 1, origin, {}};
  for (size_t j = rows.size(); j-- > 0;) {
    for (const char c : rows[j])
      grid.cells.push_back(c == '.' ? MapCell::kFree : c == '#' ? MapCell::kOccupied : MapCell::kUnknown);
  }
  return grid;
}

TEST(FloorShapeTest, ARoomWithATableAndADarkCorner) {
  const auto floor = ShapeOf(Grid({"#######", "#.....#", "#.##..#", "#...?.#", "#.....#", "#######"}));
  ASSERT_TRUE(floor.ok()) << floor.status();
  EXPECT_EQ(Area(floor->outline), 20);
  EXPECT_EQ(BoundsOf(floor->outline).min_x_m, 1);
  EXPECT_EQ(BoundsOf(floor->outline).max_y_m, 5);
  // They touch by a corner, which is closed: the two are one obstacle.
  ASSERT_EQ(floor->obstacles.size(), 1u);
  EXPECT_TRUE(floor->obstacles[0].is_wall);
}

TEST(FloorShapeTest, WallsAndUnknownPlacesAreToldApart) {
  const auto floor = ShapeOf(Grid({"..........", ".##.......", "......??..", ".........."}));
  ASSERT_TRUE(floor.ok()) << floor.status();
  ASSERT_EQ(floor->obstacles.size(), 2u);
  EXPECT_FALSE(floor->obstacles[0].is_wall);
  EXPECT_TRUE(floor->obstacles[1].is_wall);
  EXPECT_EQ(Area(floor->obstacles[1].outline), 2);
  EXPECT_EQ(Area(floor->outline), 40);
}

TEST(FloorShapeTest, TheLargestAreaIsTheFloor) {
  const auto floor = ShapeOf(Grid({"..#....", "..#....", "..#...."}));
  ASSERT_TRUE(floor.ok()) << floor.status();
  EXPECT_EQ(Area(floor->outline), 12);
  EXPECT_EQ(BoundsOf(floor->outline).min_x_m, 3);
  EXPECT_TRUE(floor->obstacles.empty());
  EXPECT_FALSE(ShapeOf(Grid({"##", "??"})).ok());
}

TEST(FloorShapeTest, TheOriginTurnsAndMovesTheMap) {
  const auto floor = ShapeOf(Grid({"....", "...."}, {10, 20, 1.5707963267948966}));
  ASSERT_TRUE(floor.ok()) << floor.status();
  const Bounds b = BoundsOf(floor->outline);
  EXPECT_NEAR(b.min_x_m, 8, 1e-9);
  EXPECT_NEAR(b.max_x_m, 10, 1e-9);
  EXPECT_NEAR(b.min_y_m, 20, 1e-9);
  EXPECT_NEAR(b.max_y_m, 24, 1e-9);
}

TEST(FloorShapeTest, ASmallErrorOfALongBorderIsSmoothed) {
  std::vector<std::string> rows(20, std::string(60, '.'));
  for (size_t x = 0; x < 60; x += 7) rows[0][x] = '#';
  const auto floor = ShapeOf(Grid(rows));
  ASSERT_TRUE(floor.ok()) << floor.status();
  EXPECT_LE(floor->outline.size(), 6u);
  EXPECT_NEAR(Area(floor->outline), 1200, 70);
}

// Whatever the cells are: simple polygons, none of them empty, and every free cell of the floor inside the outline.
TEST(FloorShapeTest, AnyCellsGiveSimplePolygons) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    const int width = 1 + static_cast<int>(random() % 24), height = 1 + static_cast<int>(random() % 24);
    const uint64_t solid = random() % 60;
    OccupancyGrid grid = {width, height, 0.05, {1, 2, 0.3}, {}};
    for (int i = 0; i < width * height; ++i) {
      const bool free = random() % 100 >= solid;
      grid.cells.push_back(free                ? MapCell::kFree
                           : random() % 2 == 0 ? MapCell::kOccupied
                                               : MapCell::kUnknown);
    }
    const auto floor = ShapeOf(grid);
    if (!floor.ok()) continue;
    ASSERT_FALSE(CrossesItself(floor->outline)) << round;
    ASSERT_GT(Area(floor->outline), 0) << round;
    for (const ImportedObstacle& obstacle : floor->obstacles) {
      ASSERT_FALSE(CrossesItself(obstacle.outline)) << round;
      ASSERT_GT(Area(obstacle.outline), 0) << round;
      ASSERT_TRUE(Contains(floor->outline, Centroid(obstacle.outline)) ||
                  DistanceToOutline(Centroid(obstacle.outline), floor->outline) < 0.11)
          << round;
    }
  }
}

}  // namespace
}  // namespace docent::maps
