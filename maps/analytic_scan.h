// Simulated laser scanner: casts rays against the layout's own shapes (segments and circles), never against
// the map in which the robot localises, so that the map's voxels cannot make the localiser look better than
// it is.
#ifndef DOCENT_MAPS_ANALYTIC_SCAN_H_
#define DOCENT_MAPS_ANALYTIC_SCAN_H_

#include <random>
#include <vector>

#include "maps/hall_layout.h"
#include "maps/laser_scan.h"

namespace docent::maps {

struct ScannerSettings {
  int beams = 180;  // 1..10000
  double field_of_view_rad =
      4.712;                // 0..2 pi; 270 degrees: a common safety scanner (SICK S300, Hokuyo UTM-30LX)
  double max_range_m = 20;  // > 0
  double height_m = 0.30;   // of the scan plane above the floor; lower things are not seen
  Pose2 sensor_in_robot = {0, 0, 0};
  double range_sigma_m = 0.02;  // standard deviation of one range; data sheets say 1 to 3 cm
  double dropout = 0.01;        // 0..1, share of beams that return nothing
};

// Immutable after construction; any thread.
class AnalyticScanner {
 public:
  // Keeps the shapes that reach up to `settings.height_m`. The hall's outline counts as a wall.
  AnalyticScanner(const HallLayout& layout, const ScannerSettings& settings);

  // Distance from `from` along `bearing_rad` (hall frame) to the first shape or the first of `people`, at
  // most max_range_m. Exact; no noise.
  double CastRay(const Point2& from, double bearing_rad, const std::vector<Disc>& people = {}) const;

  // The noise-free scan of a robot at `robot_in_hall`. Beams without a return are 0.
  LaserScan ExactScan(const Pose2& robot_in_hall, const std::vector<Disc>& people = {}) const;

  // The same with range noise and dropouts drawn from `random` (the caller's, seeded).
  LaserScan Scan(const Pose2& robot_in_hall, const std::vector<Disc>& people, std::mt19937_64& random) const;

  // True if a disc of this radius at `p` touches a shape of any height: the simulator's collision test.
  bool Collides(const Point2& p, double radius_m) const;

  const ScannerSettings& settings() const { return settings_; }

 private:
  struct Segment {
    Point2 a;
    Point2 b;
  };
  double CastRay(const Point2& from, double bearing_rad, const std::vector<Segment>& segments,
                 const std::vector<Disc>& people) const;
  ScannerSettings settings_;
  Polygon hall_outline_;
  std::vector<Segment> segments_;    // in the scan plane
  std::vector<Disc> discs_;          // in the scan plane
  std::vector<Obstacle> obstacles_;  // of all heights, for Collides
  std::vector<Bounds> bounds_;       // of them
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_ANALYTIC_SCAN_H_
