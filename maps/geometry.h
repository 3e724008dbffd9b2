// Plane geometry in the hall frame: metres, radians, x to the right, y up, angles counter-clockwise from +x.
//
// Small values and pure functions, shared by the layout, the maps and the robots. Any thread.
#ifndef DOCENT_MAPS_GEOMETRY_H_
#define DOCENT_MAPS_GEOMETRY_H_

#include <vector>

namespace docent::maps {

struct Point2 {
  double x_m = 0;
  double y_m = 0;
  friend bool operator==(const Point2&, const Point2&) = default;
};

// A pose in a named frame; `heading_rad` is kept within (-pi, pi] by WrapAngle.
struct Pose2 {
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;
  Point2 position() const { return {x_m, y_m}; }
  friend bool operator==(const Pose2&, const Pose2&) = default;
};

// A simple polygon: corners in order, either orientation, the first one not repeated at the end.
using Polygon = std::vector<Point2>;

struct Disc {
  Point2 center;
  double radius_m = 0;
};

// An axis-parallel rectangle.
struct Bounds {
  double min_x_m = 0;
  double min_y_m = 0;
  double max_x_m = 0;
  double max_y_m = 0;
};

// `angle_rad` within (-pi, pi].
double WrapAngle(double angle_rad);

// Transforms the pose `b`, given in the frame of `a`, into the parent frame of `a` (SE(2) composition).
Pose2 Compose(const Pose2& a, const Pose2& b);
// The pose `b` relative to `a`, both given in one frame: Compose(a, Between(a, b)) == b.
Pose2 Between(const Pose2& a, const Pose2& b);

double Distance(const Point2& a, const Point2& b);
// Distance from `p` to the nearest point of the segment a–b.
double DistanceToSegment(const Point2& p, const Point2& a, const Point2& b);
// Distance from `p` to the nearest point of the polygon's outline (0 only on the outline itself).
double DistanceToOutline(const Point2& p, const Polygon& polygon);

// Even-odd rule. A point on the outline may count as either.
bool Contains(const Polygon& polygon, const Point2& p);
// Unsigned area, m².
double Area(const Polygon& polygon);
// Requires a non-empty polygon.
Bounds BoundsOf(const Polygon& polygon);
// The area-weighted centroid; the mean of the corners if the area is 0.
Point2 Centroid(const Polygon& polygon);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_GEOMETRY_H_
