#include "maps/geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace docent::maps {

double WrapAngle(double angle_rad) {
  const double turn = 2 * std::numbers::pi;
  double wrapped = std::remainder(angle_rad, turn);
  if (wrapped <= -std::numbers::pi) wrapped += turn;
  return wrapped;
}

Pose2 Compose(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.heading_rad), s = std::sin(a.heading_rad);
  return {a.x_m + c * b.x_m - s * b.y_m, a.y_m + s * b.x_m + c * b.y_m,
          WrapAngle(a.heading_rad + b.heading_rad)};
}

Pose2 Between(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.heading_rad), s = std::sin(a.heading_rad);
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  return {c * dx + s * dy, -s * dx + c * dy, WrapAngle(b.heading_rad - a.heading_rad)};
}

double Distance(const Point2& a, const Point2& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

double DistanceToSegment(const Point2& p, const Point2& a, const Point2& b) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  const double length_squared = dx * dx + dy * dy;
  double t = 0;
  if (length_squared > 0) {
    t = std::clamp(((p.x_m - a.x_m) * dx + (p.y_m - a.y_m) * dy) / length_squared, 0.0, 1.0);
  }
  return std::hypot(p.x_m - a.x_m - t * dx, p.y_m - a.y_m - t * dy);
}

double DistanceToOutline(const Point2& p, const Polygon& polygon) {
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < polygon.size(); ++i) {
    nearest = std::min(nearest, DistanceToSegment(p, polygon[i], polygon[(i + 1) % polygon.size()]));
  }
  return nearest;
}

bool Contains(const Polygon& polygon, const Point2& p) {
  bool inside = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point2 &a = polygon[i], &b = polygon[j];
    if ((a.y_m > p.y_m) == (b.y_m > p.y_m)) continue;
    if (p.x_m < (b.x_m - a.x_m) * (p.y_m - a.y_m) / (b.y_m - a.y_m) + a.x_m) inside = !inside;
  }
  return inside;
}

namespace {

double SignedArea(const Polygon& polygon) {
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x_m * b.y_m - b.x_m * a.y_m;
  }
  return twice / 2;
}

}  // namespace

double Area(const Polygon& polygon) {
  return std::abs(SignedArea(polygon));
}

Bounds BoundsOf(const Polygon& polygon) {
  Bounds bounds = {polygon[0].x_m, polygon[0].y_m, polygon[0].x_m, polygon[0].y_m};
  for (const Point2& p : polygon) {
    bounds.min_x_m = std::min(bounds.min_x_m, p.x_m);
    bounds.min_y_m = std::min(bounds.min_y_m, p.y_m);
    bounds.max_x_m = std::max(bounds.max_x_m, p.x_m);
    bounds.max_y_m = std::max(bounds.max_y_m, p.y_m);
  }
  return bounds;
}

Point2 Centroid(const Polygon& polygon) {
  const double area = SignedArea(polygon);
  Point2 sum;
  if (area == 0) {
    for (const Point2& p : polygon) sum = {sum.x_m + p.x_m, sum.y_m + p.y_m};
    const double n = polygon.empty() ? 1 : static_cast<double>(polygon.size());
    return {sum.x_m / n, sum.y_m / n};
  }
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double cross = a.x_m * b.y_m - b.x_m * a.y_m;
    sum.x_m += (a.x_m + b.x_m) * cross;
    sum.y_m += (a.y_m + b.y_m) * cross;
  }
  return {sum.x_m / (6 * area), sum.y_m / (6 * area)};
}

}  // namespace docent::maps
