#include "robot_adapters/localization/particle_filter.h"

#include <mrpt/poses/CPosePDFParticles.h>
#include <mrpt/random/RandomGenerators.h>

#include <cmath>

#include "absl/synchronization/mutex.h"

namespace docent::robot {

using maps::Pose2;
using mrpt::math::TPose2D;

namespace {

// MRPT draws from one random generator of the process or, since 2.5, of the thread.
absl::Mutex& MrptRandomMutex() {
  static absl::Mutex mutex;
  return mutex;
}

Pose2 ToPose(const TPose2D& pose) {
  return {pose.x, pose.y, pose.phi};
}

}  // namespace

ParticleFilter::ParticleFilter(const MotionModelSettings& motion, double resample_below,
                               std::mt19937_64* random)
    : motion_(motion),
      resample_below_(resample_below),
      random_(*random),
      pdf_(std::make_unique<mrpt::poses::CPosePDFParticles>(0)) {}

ParticleFilter::~ParticleFilter() = default;

void ParticleFilter::Spread(const std::vector<std::pair<Pose2, double>>& centres, double sigma_xy_m,
                            double sigma_heading_rad, int count) {
  std::vector<double> weights;
  for (const auto& [pose, weight] : centres) weights.push_back(weight);
  std::discrete_distribution<size_t> choose(weights.begin(), weights.end());
  std::normal_distribution<double> normal(0, 1);
  pdf_->clear();
  for (int k = 0; k < count; ++k) {
    const Pose2& centre = centres[choose(random_)].first;
    const double x = centre.x_m + sigma_xy_m * normal(random_);
    const double y = centre.y_m + sigma_xy_m * normal(random_);
    const double heading = maps::WrapAngle(centre.heading_rad + sigma_heading_rad * normal(random_));
    pdf_->m_particles.emplace_back(TPose2D(x, y, heading), 0.0);
  }
}

void ParticleFilter::Move(const Pose2& increment) {
  const double driven_m = std::hypot(increment.x_m, increment.y_m);
  const double turned_rad = std::abs(maps::WrapAngle(increment.heading_rad));
  const double sigma_xy_m = motion_.min_xy_m + motion_.xy_per_m * driven_m + motion_.xy_per_rad * turned_rad;
  const double sigma_heading_rad =
      motion_.min_heading_rad + motion_.heading_per_m * driven_m + motion_.heading_per_rad * turned_rad;
  std::normal_distribution<double> normal(0, 1);
  for (auto& particle : pdf_->m_particles) {
    const double turn_error_rad = sigma_heading_rad * normal(random_);
    // Half of the turn's error comes before the way, half after it: it bends the way, as an arc does.
    const double c = std::cos(turn_error_rad / 2), s = std::sin(turn_error_rad / 2);
    const double x = c * increment.x_m - s * increment.y_m + sigma_xy_m * normal(random_);
    const double y = s * increment.x_m + c * increment.y_m + sigma_xy_m * normal(random_);
    particle.d = particle.d + TPose2D(x, y, increment.heading_rad + turn_error_rad);
  }
}

double ParticleFilter::Step(const Pose2& increment,
                            const std::function<double(const Pose2&)>& log_likelihood) {
  if (pdf_->m_particles.empty()) return 0;
  Move(increment);
  for (auto& particle : pdf_->m_particles) particle.log_w += log_likelihood(ToPose(particle.d));
  pdf_->normalizeWeights();
  const double effective_share = pdf_->ESS();
  if (effective_share < resample_below_) Resample();
  return effective_share * static_cast<double>(pdf_->size());
}

void ParticleFilter::Resample() {
  mrpt::bayes::CParticleFilter::TParticleFilterOptions options;
  options.resamplingMethod = mrpt::bayes::CParticleFilter::prSystematic;
  absl::MutexLock lock(&MrptRandomMutex());
  mrpt::random::getRandomGenerator().randomize(static_cast<uint32_t>(random_()));
  // Without the number of particles MRPT leaves them their old weights.
  pdf_->performResampling(options, pdf_->size());
}

std::vector<Particle> ParticleFilter::particles() const {
  std::vector<Particle> particles;
  particles.reserve(pdf_->size());
  for (const auto& particle : pdf_->m_particles) particles.push_back({ToPose(particle.d), particle.log_w});
  return particles;
}

}  // namespace docent::robot
