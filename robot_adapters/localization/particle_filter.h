// Particle filter of poses in the plane: Monte Carlo localisation (Thrun, Burgard, Fox, Probabilistic Robotics, 2005, table 8.2)
// on MRPT's particles (mrpt::poses::CPosePDFParticles) with its systematic resampling. What is added is the motion model, which
// MRPT has only beside its sensors, in libraries that bring OpenCV. One thread at a time per filter. The same seed and inputs give the
// same particles, whatever other filters of the process do.
#ifndef DOCENT_ROBOT_ADAPTERS_LOCALIZATION_PARTICLE_FILTER_H_
#define DOCENT_ROBOT_ADAPTERS_LOCALIZATION_PARTICLE_FILTER_H_

#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "maps/geometry.h"
#include "robot_adapters/localization/localiser_settings.h"

namespace mrpt::poses {
class CPosePDFParticles;
}

namespace docent::robot {

struct Particle {
  maps::Pose2 robot_in_hall;
  double log_weight = 0;  // the heaviest has 0 after each step
};

class ParticleFilter {
 public:
  // `resample_below`: share of the particles. `random` must outlive the filter.
  ParticleFilter(const MotionModelSettings& motion, double resample_below, std::mt19937_64* random);
  ~ParticleFilter();

  // `count` samples around `centres`, which are chosen in proportion to their weights (not empty, above 0). All weigh the same.
  void Spread(const std::vector<std::pair<maps::Pose2, double>>& centres, double sigma_xy_m,
              double sigma_heading_rad, int count);

  // Moves each particle by the increment (in the robot's frame) with an error of its own, weighs it by the likelihood (finite), and
  // resamples where few carry the weight. Returns the effective number of particles before resampling.
  double Step(const maps::Pose2& increment, const std::function<double(const maps::Pose2&)>& log_likelihood);

  std::vector<Particle> particles() const;

 private:
  void Move(const maps::Pose2& increment);
  void Resample();

  const MotionModelSettings motion_;
  const double resample_below_;
  std::mt19937_64& random_;
  const std::unique_ptr<mrpt::poses::CPosePDFParticles> pdf_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_LOCALIZATION_PARTICLE_FILTER_H_
