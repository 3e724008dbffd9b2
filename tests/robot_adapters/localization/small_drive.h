// A short simulated drive through the small hall of tests/maps/layout_quads.h: truth, noisy odometry, noisy scans.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_LOCALIZATION_SMALL_DRIVE_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_LOCALIZATION_SMALL_DRIVE_H_

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "maps/analytic_scan.h"
#include "maps/hall_model.h"
#include "tests/maps/layout_quads.h"

namespace docent::robot {

inline const maps::HallLayout& SmallLayout() {
  static const maps::HallLayout layout = *maps::HallLayout::FromQuads(maps::LayoutQuads::SmallHall().quads());
  return layout;
}

inline std::shared_ptr<const maps::HallModel> SmallHall() {
  static const std::shared_ptr<const maps::HallModel> hall = *maps::HallModel::FromLayout(SmallLayout());
  return hall;
}

struct DriveStep {
  maps::Pose2 truth;
  maps::Pose2 odometry;
  maps::LaserScan scan;
};

struct SmallDrive {
  maps::Pose2 start = {1.5, 1.5, 1.57};
  maps::LaserScan first_scan;
  std::vector<DriveStep> steps;

  explicit SmallDrive(uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0, 1);
    const maps::AnalyticScanner scanner(SmallLayout(), {});
    first_scan = scanner.Scan(start, {}, random);
    maps::Pose2 pose = start;
    for (const maps::Point2 target :
         {maps::Point2{2, 4.5}, {5, 5.5}, {8, 4.6}, {8, 2.5}, {10, 4.5}, {7.5, 5}}) {
      while (maps::Distance(pose.position(), target) > 0.2) {
        const double bearing = std::atan2(target.y_m - pose.y_m, target.x_m - pose.x_m);
        const double turn = std::clamp(maps::WrapAngle(bearing - pose.heading_rad), -0.2, 0.2);
        const double forward = std::abs(maps::WrapAngle(bearing - pose.heading_rad)) > 0.5 ? 0 : 0.12;
        const maps::Pose2 moved = {forward * std::cos(turn / 2), forward * std::sin(turn / 2), turn};
        pose = maps::Compose(pose, moved);
        const maps::Pose2 odometry = {1.02 * moved.x_m + 0.05 * forward * normal(random), 1.02 * moved.y_m,
                                      0.98 * moved.heading_rad + 0.05 * std::abs(turn) * normal(random)};
        steps.push_back({pose, odometry, scanner.Scan(pose, {}, random)});
      }
    }
  }
};

}  // namespace docent::robot

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_LOCALIZATION_SMALL_DRIVE_H_
