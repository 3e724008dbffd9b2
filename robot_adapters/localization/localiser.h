// Localiser: MRPT's particles with our sensor model on the hall's distance field.
//
// One thread at a time per Localiser; a process may have any number of them. The same seed and inputs give the same estimates.
#ifndef DOCENT_ROBOT_ADAPTERS_LOCALIZATION_LOCALISER_H_
#define DOCENT_ROBOT_ADAPTERS_LOCALIZATION_LOCALISER_H_

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/hall_model.h"
#include "maps/laser_scan.h"
#include "robot_adapters/localization/localiser_settings.h"

namespace docent::robot {

struct Estimate {
  double x_m = 0;  // mean of the particles, hall frame
  double y_m = 0;
  double heading_rad = 0;
  std::array<double, 9> covariance = {};  // x, y, heading; row by row
  bool localised = false;                 // accurate enough to drive (LocaliserSettings)
  double neff = 0;                        // effective number of particles before resampling
  int particles = 0;
  double lost_share = 0;    // smoothed share of beams that pass through walls
  int relocalisations = 0;  // global searches whose pose was used, so far

  maps::Pose2 pose() const { return {x_m, y_m, heading_rad}; }
};

class Localiser {
 public:
  // `settings` must be valid (Validate). Not localised until one of the two Initialise… functions is called.
  Localiser(std::shared_ptr<const maps::HallModel> hall, const LocaliserSettings& settings, uint64_t seed);
  ~Localiser();
  Localiser(const Localiser&) = delete;
  Localiser& operator=(const Localiser&) = delete;

  // The robot is near this pose (standard deviations, > 0). INVALID_ARGUMENT: not finite or not > 0.
  absl::Status InitialiseAt(const maps::Pose2& robot_in_hall, double sigma_xy_m, double sigma_heading_rad);

  // The robot may be anywhere in the hall and sees `scan`. NOT_FOUND: the map has no free place, or the scan
  // has no return; the state is then unchanged.
  absl::Status InitialiseGlobally(const maps::LaserScan& scan);

  // One step: the robot has moved by `odometry_increment` (in its own frame) and then sees `scan`.
  // FAILED_PRECONDITION: not initialised. INVALID_ARGUMENT: a number that is not finite; the state is
  // unchanged.
  absl::StatusOr<Estimate> Update(const maps::Pose2& odometry_increment, const maps::LaserScan& scan);

  const Estimate& estimate() const { return estimate_; }
  // The particles' poses, for pictures.
  std::vector<maps::Pose2> Particles() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  Estimate estimate_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_LOCALIZATION_LOCALISER_H_
