#include "bench/worlds/hall_tour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <random>
#include <utility>

namespace docent::bench {
namespace {

using maps::DistanceGrid;
using maps::Point2;
using maps::Pose2;

// Shortest path over cells with enough clearance, by Dijkstra from `from`; empty if there is none.
std::vector<Point2> ShortestWay(const DistanceGrid& grid, const Point2& from, const Point2& to,
                                double clearance_m) {
  const int start = grid.RowOf(from.y_m) * grid.width + grid.ColumnOf(from.x_m);
  const int goal = grid.RowOf(to.y_m) * grid.width + grid.ColumnOf(to.x_m);
  std::vector<float> cost(grid.state.size(), std::numeric_limits<float>::infinity());
  std::vector<int> before(grid.state.size(), -1);
  std::priority_queue<std::pair<float, int>, std::vector<std::pair<float, int>>, std::greater<>> open;
  cost[start] = 0;
  open.push({0, start});
  while (!open.empty() && open.top().second != goal) {
    const auto [so_far, cell] = open.top();
    open.pop();
    if (so_far > cost[cell]) continue;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int i = cell % grid.width + dx, j = cell / grid.width + dy;
        if (!grid.Inside(i, j)) continue;
        const int next = j * grid.width + i;
        if (grid.distance_m[next] < clearance_m && next != goal) continue;
        const float step = std::sqrt(static_cast<float>(dx * dx + dy * dy)) *
                           (1 + 0.5f / std::max(0.1f, grid.distance_m[next]));
        if (so_far + step >= cost[next]) continue;
        cost[next] = so_far + step;
        before[next] = cell;
        open.push({cost[next], next});
      }
    }
  }
  std::vector<Point2> way;
  if (before[goal] < 0) return way;
  for (int cell = goal; cell >= 0; cell = before[cell])
    way.push_back(grid.CenterOf(cell % grid.width, cell / grid.width));
  std::reverse(way.begin(), way.end());
  return way;
}

// True poses at each step: turn towards a point ahead on the path, drive when roughly facing it.
std::vector<Pose2> FollowWay(const std::vector<Point2>& way, Pose2 pose, const TourSettings& settings) {
  std::vector<Pose2> poses;
  size_t target = 0;
  while (target < way.size() && poses.size() < 100000) {
    while (target < way.size() && maps::Distance(pose.position(), way[target]) < 0.35) ++target;
    if (target == way.size()) break;
    const double bearing = std::atan2(way[target].y_m - pose.y_m, way[target].x_m - pose.x_m);
    const double most = settings.turn_rad_per_s * settings.step_s;
    const double wanted = maps::WrapAngle(bearing - pose.heading_rad);
    const double turn = std::clamp(wanted, -most, most);
    const double forward =
        std::abs(wanted) > 0.6 ? 0 : settings.speed_m_per_s * settings.step_s * std::cos(wanted - turn);
    pose = maps::Compose(pose, {forward * std::cos(turn / 2), forward * std::sin(turn / 2), turn});
    poses.push_back(pose);
  }
  return poses;
}

struct Walker {
  Point2 at;
  double heading_rad;
};

std::vector<maps::Disc> Walk(std::vector<Walker>& walkers, const Pose2& robot, double step_s,
                             std::mt19937_64& random) {
  std::normal_distribution<double> turn(0, 0.3);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi), radius(0.8, 5.5);
  std::vector<maps::Disc> discs;
  for (Walker& walker : walkers) {
    walker.heading_rad += turn(random);
    walker.at.x_m += 0.8 * step_s * std::cos(walker.heading_rad);
    walker.at.y_m += 0.8 * step_s * std::sin(walker.heading_rad);
    const double away = maps::Distance(walker.at, robot.position());
    if (away > 6 || away < 0.6) {
      const double bearing = angle(random), r = radius(random);
      walker = {{robot.x_m + r * std::cos(bearing), robot.y_m + r * std::sin(bearing)}, angle(random)};
    }
    discs.push_back({walker.at, 0.22});
  }
  return discs;
}

absl::StatusOr<std::vector<Pose2>> DrivenWay(const maps::HallLayout& layout, const maps::HallModel& hall,
                                             const TourSettings& settings, std::mt19937_64& random) {
  std::vector<Pose2> stops;
  for (const maps::Region& region : layout.regions) {
    if (region.service_point && hall.DistanceAt(region.service_point->x_m, region.service_point->y_m) > 0.2) {
      stops.push_back(*region.service_point);
    }
  }
  std::shuffle(stops.begin(), stops.end(), random);
  std::vector<Pose2> poses;
  for (size_t next = 1; next < stops.size() && next <= static_cast<size_t>(settings.stops); ++next) {
    const Pose2 from = poses.empty() ? stops[0] : poses.back();
    const std::vector<Point2> way =
        ShortestWay(hall.clearance(), from.position(), stops[next].position(), settings.clearance_m);
    if (poses.empty() && !way.empty()) poses.push_back(from);
    const std::vector<Pose2> leg = FollowWay(way, from, settings);
    poses.insert(poses.end(), leg.begin(), leg.end());
  }
  if (poses.size() < 2) {
    return absl::FailedPreconditionError("no two service points of " + layout.iri +
                                         " can be reached from each other");
  }
  return poses;
}

}  // namespace

absl::StatusOr<Tour> SimulateTour(const maps::HallLayout& layout, const maps::HallModel& hall,
                                  const TourSettings& settings, const maps::ScannerSettings& scanner_settings,
                                  uint64_t seed) {
  std::mt19937_64 random(seed);
  absl::StatusOr<std::vector<Pose2>> truth = DrivenWay(layout, hall, settings, random);
  if (!truth.ok()) return truth.status();
  const maps::AnalyticScanner scanner(layout, scanner_settings);
  std::normal_distribution<double> normal(0, 1);
  const double scale_xy = 1 + settings.scale_sigma * normal(random);
  const double scale_heading = 1 + settings.scale_sigma * normal(random);
  std::vector<Walker> walkers(static_cast<size_t>(settings.people), Walker{{1e9, 1e9}, 0});

  Tour tour;
  tour.start = truth->front();
  tour.first_scan = scanner.Scan(tour.start, Walk(walkers, tour.start, settings.step_s, random), random);
  Pose2 reckoned = tour.start;
  for (size_t k = 1; k < truth->size(); ++k) {
    TourStep step;
    step.truth = (*truth)[k];
    const Pose2 moved = maps::Between((*truth)[k - 1], step.truth);
    const double way_m = std::hypot(moved.x_m, moved.y_m), turn = std::abs(moved.heading_rad);
    step.odometry.x_m = scale_xy * moved.x_m + settings.xy_per_m * way_m * normal(random);
    step.odometry.y_m = scale_xy * moved.y_m + settings.xy_per_m * way_m * normal(random) / 2;
    step.odometry.heading_rad =
        scale_heading * moved.heading_rad +
        (settings.heading_per_rad * turn + settings.heading_per_m * way_m) * normal(random);
    step.scan = scanner.Scan(step.truth, Walk(walkers, step.truth, settings.step_s, random), random);
    tour.length_m += way_m;
    reckoned = maps::Compose(reckoned, step.odometry);
    tour.steps.push_back(std::move(step));
  }
  tour.odometry_drift_m = maps::Distance(reckoned.position(), tour.steps.back().truth.position());
  return tour;
}

}  // namespace docent::bench
