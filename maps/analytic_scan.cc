#include "maps/analytic_scan.h"

#include <algorithm>
#include <cmath>

namespace docent::maps {
namespace {

// Distance along the unit direction (dx, dy) from `o` to the circle; `limit` if it is not hit before.
double RayToDisc(const Point2& o, double dx, double dy, const Disc& disc, double limit) {
  const double ox = o.x_m - disc.center.x_m, oy = o.y_m - disc.center.y_m;
  const double b = ox * dx + oy * dy;
  const double c = ox * ox + oy * oy - disc.radius_m * disc.radius_m;
  const double discriminant = b * b - c;
  if (discriminant < 0) return limit;
  const double root = std::sqrt(discriminant);
  const double near = -b - root;
  if (near >= 0) return std::min(near, limit);
  const double far = -b + root;  // from inside the disc: its far side
  return far >= 0 ? std::min(far, limit) : limit;
}

}  // namespace

AnalyticScanner::AnalyticScanner(const HallLayout& layout, const ScannerSettings& settings)
    : settings_(settings), hall_outline_(layout.outline), obstacles_(layout.obstacles) {
  const auto add_outline = [this](const Polygon& polygon) {
    for (size_t i = 0; i < polygon.size(); ++i)
      segments_.push_back({polygon[i], polygon[(i + 1) % polygon.size()]});
  };
  add_outline(hall_outline_);
  for (const Obstacle& obstacle : layout.obstacles) {
    const Point2 c = obstacle.disc ? obstacle.disc->center : Point2();
    const double r = obstacle.disc ? obstacle.disc->radius_m : 0;
    bounds_.push_back(obstacle.disc ? Bounds{c.x_m - r, c.y_m - r, c.x_m + r, c.y_m + r}
                                    : BoundsOf(obstacle.outline));
    if (obstacle.height_m < settings_.height_m) continue;
    if (obstacle.disc) {
      discs_.push_back(*obstacle.disc);
    } else {
      add_outline(obstacle.outline);
    }
  }
}

double AnalyticScanner::CastRay(const Point2& from, double bearing_rad,
                                const std::vector<Disc>& people) const {
  return CastRay(from, bearing_rad, segments_, people);
}

double AnalyticScanner::CastRay(const Point2& from, double bearing_rad, const std::vector<Segment>& segments,
                                const std::vector<Disc>& people) const {
  const double dx = std::cos(bearing_rad), dy = std::sin(bearing_rad);
  double nearest = settings_.max_range_m;
  for (const Segment& s : segments) {
    // from + t*(dx,dy) = a + u*(b-a), solved by Cramer's rule
    const double ex = s.b.x_m - s.a.x_m, ey = s.b.y_m - s.a.y_m;
    const double determinant = dx * ey - dy * ex;
    if (determinant == 0) continue;
    const double ax = s.a.x_m - from.x_m, ay = s.a.y_m - from.y_m;
    const double t = (ax * ey - ay * ex) / determinant;
    if (t < 0 || t >= nearest) continue;
    const double u = (ax * dy - ay * dx) / determinant;
    if (u >= 0 && u <= 1) nearest = t;
  }
  for (const Disc& disc : discs_) nearest = RayToDisc(from, dx, dy, disc, nearest);
  for (const Disc& disc : people) nearest = RayToDisc(from, dx, dy, disc, nearest);
  return nearest;
}

LaserScan AnalyticScanner::ExactScan(const Pose2& robot_in_hall, const std::vector<Disc>& people) const {
  LaserScan scan;
  const int n = settings_.beams;
  const bool full_turn = settings_.field_of_view_rad > 6.283;
  scan.bearing_step_rad = n > 1 ? settings_.field_of_view_rad / (full_turn ? n : n - 1) : 0;
  scan.first_bearing_rad = n > 1 ? -settings_.field_of_view_rad / 2 : 0;
  scan.max_range_m = settings_.max_range_m;
  scan.sensor_in_robot = settings_.sensor_in_robot;
  scan.range_m.resize(n);
  const Pose2 sensor = Compose(robot_in_hall, settings_.sensor_in_robot);
  // A large building has many more segments than a scan can reach.
  std::vector<Segment> near;
  for (const Segment& s : segments_) {
    if (DistanceToSegment(sensor.position(), s.a, s.b) <= settings_.max_range_m) near.push_back(s);
  }
  for (int i = 0; i < n; ++i) {
    const double bearing = sensor.heading_rad + scan.first_bearing_rad + i * scan.bearing_step_rad;
    const double range = CastRay(sensor.position(), bearing, near, people);
    scan.range_m[i] = range < settings_.max_range_m ? static_cast<float>(range) : 0.0f;
  }
  return scan;
}

LaserScan AnalyticScanner::Scan(const Pose2& robot_in_hall, const std::vector<Disc>& people,
                                std::mt19937_64& random) const {
  LaserScan scan = ExactScan(robot_in_hall, people);
  std::normal_distribution<double> noise(0, settings_.range_sigma_m);
  std::uniform_real_distribution<double> share(0, 1);
  for (float& range : scan.range_m) {
    // Both are drawn for every beam, so that the result of one beam does not shift the noise of the others.
    const double error = noise(random);
    const bool lost = share(random) < settings_.dropout;
    if (range == 0) continue;
    range = lost ? 0.0f : static_cast<float>(std::clamp(range + error, 0.001, settings_.max_range_m));
  }
  return scan;
}

bool AnalyticScanner::Collides(const Point2& p, double radius_m) const {
  if (!Contains(hall_outline_, p) || DistanceToOutline(p, hall_outline_) < radius_m) return true;
  for (size_t i = 0; i < obstacles_.size(); ++i) {
    const Obstacle& obstacle = obstacles_[i];
    const Bounds& b = bounds_[i];
    if (p.x_m < b.min_x_m - radius_m || p.x_m > b.max_x_m + radius_m || p.y_m < b.min_y_m - radius_m ||
        p.y_m > b.max_y_m + radius_m) {
      continue;
    }
    if (obstacle.disc) {
      if (Distance(p, obstacle.disc->center) < obstacle.disc->radius_m + radius_m) return true;
    } else if (Contains(obstacle.outline, p) || DistanceToOutline(p, obstacle.outline) < radius_m) {
      return true;
    }
  }
  return false;
}

}  // namespace docent::maps
