#include "robot_adapters/localization/particle_filter.h"

#include <algorithm>
#include <cmath>

namespace docent::robot {

using maps::Pose2;

void ParticleFilter::Spread(const std::vector<std::pair<Pose2, double>>& centres, double sigma_xy_m,
                            double sigma_heading_rad, int count) {
  std::vector<double> weights;
  for (const auto& [pose, weight] : centres) weights.push_back(weight);
  std::discrete_distribution<size_t> choose(weights.begin(), weights.end());
  std::normal_distribution<double> normal(0, 1);
  particles_.clear();
  for (int k = 0; k < count; ++k) {
    const Pose2& centre = centres[choose(random_)].first;
    const double x = centre.x_m + sigma_xy_m * normal(random_);
    const double y = centre.y_m + sigma_xy_m * normal(random_);
    const double heading = maps::WrapAngle(centre.heading_rad + sigma_heading_rad * normal(random_));
    particles_.push_back({{x, y, heading}, 0});
  }
}

void ParticleFilter::Move(const Pose2& increment) {
  const double driven_m = std::hypot(increment.x_m, increment.y_m);
  const double turned_rad = std::abs(maps::WrapAngle(increment.heading_rad));
  const double sigma_xy_m = motion_.min_xy_m + motion_.xy_per_m * driven_m + motion_.xy_per_rad * turned_rad;
  const double sigma_heading_rad =
      motion_.min_heading_rad + motion_.heading_per_m * driven_m + motion_.heading_per_rad * turned_rad;
  std::normal_distribution<double> normal(0, 1);
  for (Particle& particle : particles_) {
    const double turn_error_rad = sigma_heading_rad * normal(random_);
    // Half of the turn's error comes before the way, half after it: it bends the way, as an arc does.
    const double c = std::cos(turn_error_rad / 2), s = std::sin(turn_error_rad / 2);
    const Pose2 drawn = {c * increment.x_m - s * increment.y_m + sigma_xy_m * normal(random_),
                         s * increment.x_m + c * increment.y_m + sigma_xy_m * normal(random_),
                         increment.heading_rad + turn_error_rad};
    particle.robot_in_hall = maps::Compose(particle.robot_in_hall, drawn);
  }
}

double ParticleFilter::Step(const Pose2& increment,
                            const std::function<double(const Pose2&)>& log_likelihood) {
  if (particles_.empty()) return 0;
  Move(increment);
  double heaviest = -INFINITY;
  for (Particle& particle : particles_) {
    particle.log_weight += log_likelihood(particle.robot_in_hall);
    heaviest = std::max(heaviest, particle.log_weight);
  }
  double sum = 0, squares = 0;
  for (Particle& particle : particles_) {
    particle.log_weight -= heaviest;
    const double weight = std::exp(particle.log_weight);
    sum += weight;
    squares += weight * weight;
  }
  const double effective = sum * sum / squares;
  if (effective < resample_below_ * static_cast<double>(particles_.size())) Resample();
  return effective;
}

// One random number, and then even steps through the weights.
void ParticleFilter::Resample() {
  double total = 0;
  for (const Particle& particle : particles_) total += std::exp(particle.log_weight);
  const size_t count = particles_.size();
  const double step = total / static_cast<double>(count);
  double at = std::uniform_real_distribution<double>(0, step)(random_);
  std::vector<Particle> drawn;
  drawn.reserve(count);
  double reached = std::exp(particles_[0].log_weight);
  for (size_t i = 0; drawn.size() < count; at += step) {
    while (at > reached && i + 1 < count) reached += std::exp(particles_[++i].log_weight);
    drawn.push_back({particles_[i].robot_in_hall, 0});
  }
  particles_ = std::move(drawn);
}

}  // namespace docent::robot
