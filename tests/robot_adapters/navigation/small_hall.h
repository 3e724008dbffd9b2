// A synthetic hall of 12 m × 8 m: a wall with a door in the middle, a pillar, and a closed cell without
// entrance.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_NAVIGATION_SMALL_HALL_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_NAVIGATION_SMALL_HALL_H_

#include <memory>

#include "gtest/gtest.h"
#include "maps/hall_model.h"

namespace docent::robot {

inline maps::Obstacle Box(double x0, double y0, double x1, double y1) {
  maps::Obstacle wall;
  wall.iri = "urn:wall";
  wall.kind = maps::ObstacleKind::kWall;
  wall.outline = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  wall.height_m = 2;
  return wall;
}

inline maps::HallLayout SmallHall() {
  maps::HallLayout hall;
  hall.iri = "urn:hall";
  hall.name = "Small hall";
  hall.outline = {{0, 0}, {12, 0}, {12, 8}, {0, 8}};
  hall.height_m = 3;
  hall.obstacles = {
      Box(5.9, 0, 6.1, 3.4),  // a wall from the south, its door between y 3.4 and 4.6
      Box(5.9, 4.6, 6.1, 8), Box(9, 6, 9.2, 8),
      Box(9.2, 6, 12, 6.2),  // the closed cell in the north-east corner
  };
  maps::Obstacle pillar;
  pillar.iri = "urn:pillar";
  pillar.kind = maps::ObstacleKind::kPillar;
  pillar.disc = maps::Disc{{3, 4}, 0.3};
  pillar.height_m = 3;
  hall.obstacles.push_back(pillar);
  return hall;
}

inline std::shared_ptr<const maps::HallModel> SmallHallModel() {
  static const std::shared_ptr<const maps::HallModel> model = [] {
    auto made = maps::HallModel::FromLayout(SmallHall());
    EXPECT_TRUE(made.ok()) << made.status();
    return *made;
  }();
  return model;
}

}  // namespace docent::robot

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_NAVIGATION_SMALL_HALL_H_
