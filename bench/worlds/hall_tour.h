// Simulated drive through a hall for benchmarks: true poses, noisy odometry, and scans, all from a seed.
#ifndef DOCENT_BENCH_WORLDS_HALL_TOUR_H_
#define DOCENT_BENCH_WORLDS_HALL_TOUR_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/analytic_scan.h"
#include "maps/hall_layout.h"
#include "maps/hall_model.h"

namespace docent::bench {

struct TourSettings {
  double step_s = 0.2;  // one scan each: 5 Hz
  double speed_m_per_s = 0.6;
  double turn_rad_per_s = 1.0;
  double clearance_m = 0.40;  // of the driven way from obstacles
  int stops = 6;              // service points visited, drawn by seed
  double people = 0;          // unmapped walkers within 6 m, as cylinders of radius 0.22 m
  // Odometry: random errors of each step, and a scale error drawn once for each drive (wheel wear).
  double xy_per_m = 0.05;         // standard deviation, m for each m
  double heading_per_rad = 0.05;  // rad for each rad
  double heading_per_m = 0.02;    // rad for each m
  double scale_sigma = 0.01;      // of the drive's own scale error
};

struct TourStep {
  maps::Pose2 truth;     // after the step
  maps::Pose2 odometry;  // increment as the wheels report it, in the frame of the pose before
  maps::LaserScan scan;  // at `truth`
};

struct Tour {
  maps::Pose2 start;
  maps::LaserScan first_scan;  // at `start`
  std::vector<TourStep> steps;
  double length_m = 0;
  double odometry_drift_m = 0;  // error at the end with odometry alone
};

// FAILED_PRECONDITION: the layout has no two service points with a path between them.
absl::StatusOr<Tour> SimulateTour(const maps::HallLayout& layout, const maps::HallModel& hall,
                                  const TourSettings& settings, const maps::ScannerSettings& scanner,
                                  uint64_t seed);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_HALL_TOUR_H_
