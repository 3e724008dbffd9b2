// Settings of the localiser. A value; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_LOCALIZATION_LOCALISER_SETTINGS_H_
#define DOCENT_ROBOT_ADAPTERS_LOCALIZATION_LOCALISER_SETTINGS_H_

#include "absl/status/status.h"

namespace docent::robot {

// The measurement model: Thrun, Burgard, Fox, Probabilistic Robotics (2005), section 6.4, likelihood fields,
// on the signed distance field of the hall model.
struct SensorModelSettings {
  double sigma_hit_m =
      0.06;                // 0.005..1: spread of a beam's end around the surface: laser noise and voxel edges
  double z_random = 0.05;  // 0.001..0.999: share of beams with random ends (people, clutter)
  double temper = 0.20;    // 0.01..1: power of each beam's likelihood; neighbouring beams are not independent
  int max_beams = 180;     // 1..10000: a longer scan is thinned evenly
  double cell_m = 0.025;   // 0.005..0.5: cells of the table of log-likelihoods, interpolated from the field
};

// Errors of one odometry increment, standard deviations. MRPT's Gaussian model (mrpt::obs::CActionRobotMovement2D) has the same;
// its names are in the comments.
struct MotionModelSettings {
  double xy_per_m = 0.15;    // 0..1, m per m driven (a1); real robots slip: measured on s02, bench/README.md
  double xy_per_rad = 0.02;  // 0..1, m per rad turned (a2)
  double heading_per_m = 0.03;      // 0..1, rad per m driven (a3)
  double heading_per_rad = 0.06;    // 0..1, rad per rad turned (a4)
  double min_xy_m = 0.010;          // 1e-6..1, at each update (minStdXY)
  double min_heading_rad = 0.0015;  // 1e-6..1, at each update (minStdPHI)
};

struct LocaliserSettings {
  SensorModelSettings sensor;
  MotionModelSettings motion;
  int particles = 1000;         // 50..100000, when tracking
  int search_particles = 5000;  // 50..100000, after a global search until the pose is sure
  double resample_below =
      0.5;  // 0..1: resample when the effective share of particles falls below this (MRPT: BETA)

  // Global search: scores every free place on a lattice times every heading with one scan.
  double search_step_m = 0.25;      // 0.05..2
  double search_step_rad = 0.0873;  // 0.01..1: 5 degrees
  int search_beams = 60;            // 1..10000
  double search_clearance_m = 0.2;  // 0..5: the robot stands at least this far from obstacles

  // Lost: smoothed share of beams that pass *through* mapped walls. People cannot cause it: they shorten
  // beams.
  double lost_above = 0.15;     // 0.01..1
  double lost_margin_m = 0.30;  // 0.05..5: how far behind a wall a beam must end to count
  double lost_smoothing = 0.3;  // 0.01..1: weight of the newest scan
  bool relocalise = true;       // when lost, search globally and use a better pose

  // The estimate counts as localised if the particles' spread is below these values and the robot is not
  // lost.
  double localised_xy_m = 0.25;         // 0.01..5, standard deviation
  double localised_heading_rad = 0.15;  // 0.01..3, standard deviation
};

// INVALID_ARGUMENT naming the first field out of its range.
absl::Status Validate(const LocaliserSettings& settings);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_LOCALIZATION_LOCALISER_SETTINGS_H_
