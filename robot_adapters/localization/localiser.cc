#include "robot_adapters/localization/localiser.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include "robot_adapters/localization/global_search.h"
#include "robot_adapters/localization/particle_filter.h"
#include "robot_adapters/localization/sensor_model.h"

namespace docent::robot {
namespace {

using maps::Pose2;

constexpr int kCandidates = 32;     // candidates of a global search that get particles
constexpr double kSureXy_m = 0.10;  // standard deviation below which the search's particles are thinned
constexpr double kSureHeading_rad = 0.05;

bool Finite(const Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.heading_rad);
}

bool Finite(const maps::LaserScan& scan) {
  return std::isfinite(scan.first_bearing_rad) && std::isfinite(scan.bearing_step_rad) &&
         std::isfinite(scan.max_range_m) && Finite(scan.sensor_in_robot) &&
         std::all_of(scan.range_m.begin(), scan.range_m.end(), [](float r) { return std::isfinite(r); });
}

}  // namespace

struct Localiser::Impl {
  Impl(std::shared_ptr<const maps::HallModel> hall_model, const LocaliserSettings& with, uint64_t seed)
      : hall(std::move(hall_model)),
        settings(with),
        random(seed),
        model(std::make_shared<SensorModel>(hall->laser_field(), with.sensor)),
        filter(with.motion, with.resample_below, &random) {}

  // Replaces all particles by samples around `centres`, which are chosen in proportion to their weights.
  void Spread(const std::vector<std::pair<Pose2, double>>& centres, double sigma_xy_m,
              double sigma_heading_rad, int count) {
    filter.Spread(centres, sigma_xy_m, sigma_heading_rad, count);
    initialised = true;
    lost_share = 0;
  }

  // Keeps `settings.particles` of the search's particles, drawn by weight.
  void Thin() {
    std::vector<std::pair<Pose2, double>> centres;
    for (const Particle& particle : filter.particles())
      centres.push_back({particle.robot_in_hall, std::exp(particle.log_weight)});
    const double before = lost_share;
    Spread(centres, settings.motion.min_xy_m, settings.motion.min_heading_rad, settings.particles);
    lost_share = before;
  }

  void Step(const Pose2& increment, const maps::LaserScan& scan) {
    const BeamEnds ends = EndsOf(scan, settings.sensor.max_beams);
    neff = filter.Step(increment, [&](const Pose2& pose) { return model->LogLikelihood(ends, pose); });
  }

  // Mean and covariance of the weighted particles; the heading's mean is that of the unit vectors.
  Estimate Summary() const {
    Estimate e;
    const std::vector<Particle> particles = filter.particles();
    double total = 0, sum_x = 0, sum_y = 0, sum_sin = 0, sum_cos = 0;
    for (const auto& [pose, log_weight] : particles) {
      const double w = std::exp(log_weight);
      total += w;
      sum_x += w * pose.x_m;
      sum_y += w * pose.y_m;
      sum_sin += w * std::sin(pose.heading_rad);
      sum_cos += w * std::cos(pose.heading_rad);
    }
    e.x_m = sum_x / total;
    e.y_m = sum_y / total;
    e.heading_rad = std::atan2(sum_sin, sum_cos);
    for (const auto& [pose, log_weight] : particles) {
      const double w = std::exp(log_weight) / total;
      const double d[3] = {pose.x_m - e.x_m, pose.y_m - e.y_m,
                           maps::WrapAngle(pose.heading_rad - e.heading_rad)};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) e.covariance[3 * row + column] += w * d[row] * d[column];
      }
    }
    e.neff = neff;
    e.particles = static_cast<int>(particles.size());
    e.lost_share = lost_share;
    e.relocalisations = relocalisations;
    return e;
  }

  std::vector<std::pair<Pose2, double>> Weighted(const std::vector<Candidate>& candidates) const {
    std::vector<std::pair<Pose2, double>> centres;
    for (const Candidate& candidate : candidates) {
      centres.push_back(
          {candidate.robot_in_hall, std::exp(candidate.log_likelihood - candidates[0].log_likelihood)});
    }
    return centres;
  }

  void SpreadAround(const std::vector<Candidate>& candidates) {
    Spread(Weighted(candidates), settings.search_step_m / 4, settings.search_step_rad / 4,
           settings.search_particles);
  }

  // Runs a global search; its pose is used only if it explains the scan better and passes through fewer
  // walls.
  void Relocalise(const maps::LaserScan& scan, const Pose2& current) {
    const std::vector<Candidate> candidates = SearchGlobally(*hall, *model, scan, settings, kCandidates);
    if (candidates.empty()) return;
    const BeamEnds ends = EndsOf(scan, settings.sensor.max_beams);
    const Pose2& best = candidates[0].robot_in_hall;
    if (candidates[0].log_likelihood <= model->LogLikelihood(ends, current)) return;
    const double through = ShareThroughWalls(hall->laser_field(), ends, best, settings.lost_margin_m);
    if (through >= ShareThroughWalls(hall->laser_field(), ends, current, settings.lost_margin_m)) return;
    SpreadAround(candidates);
    ++relocalisations;
  }

  std::shared_ptr<const maps::HallModel> hall;
  LocaliserSettings settings;
  std::mt19937_64 random;
  std::shared_ptr<const SensorModel> model;
  ParticleFilter filter;
  bool initialised = false;
  double neff = 0;
  double lost_share = 0;
  int relocalisations = 0;
  int updates_since_search = 0;
};

Localiser::Localiser(std::shared_ptr<const maps::HallModel> hall, const LocaliserSettings& settings,
                     uint64_t seed)
    : impl_(std::make_unique<Impl>(std::move(hall), settings, seed)) {}

Localiser::~Localiser() = default;

absl::Status Localiser::InitialiseAt(const Pose2& robot_in_hall, double sigma_xy_m,
                                     double sigma_heading_rad) {
  if (!Finite(robot_in_hall) || !(sigma_xy_m > 0) || !(sigma_heading_rad > 0) || !std::isfinite(sigma_xy_m) ||
      !std::isfinite(sigma_heading_rad)) {
    return absl::InvalidArgumentError("localiser: the start pose is not finite or a sigma not above 0");
  }
  impl_->Spread({{robot_in_hall, 1.0}}, sigma_xy_m, sigma_heading_rad, impl_->settings.particles);
  estimate_ = impl_->Summary();
  return absl::OkStatus();
}

absl::Status Localiser::InitialiseGlobally(const maps::LaserScan& scan) {
  if (!Finite(scan)) return absl::InvalidArgumentError("localiser: a number of the scan is not finite");
  const std::vector<Candidate> candidates =
      SearchGlobally(*impl_->hall, *impl_->model, scan, impl_->settings, kCandidates);
  if (candidates.empty()) {
    return absl::NotFoundError("localiser: the scan has no return or the map no free place to stand on");
  }
  impl_->SpreadAround(candidates);
  estimate_ = impl_->Summary();
  return absl::OkStatus();
}

absl::StatusOr<Estimate> Localiser::Update(const Pose2& odometry_increment, const maps::LaserScan& scan) {
  Impl& impl = *impl_;
  if (!impl.initialised) return absl::FailedPreconditionError("localiser: not initialised");
  if (!Finite(odometry_increment) || !Finite(scan)) {
    return absl::InvalidArgumentError("localiser: a number of the odometry or the scan is not finite");
  }
  impl.Step(odometry_increment, scan);
  Estimate e = impl.Summary();
  const BeamEnds few = EndsOf(scan, impl.settings.search_beams);
  const double through =
      ShareThroughWalls(impl.hall->laser_field(), few, e.pose(), impl.settings.lost_margin_m);
  impl.lost_share += impl.settings.lost_smoothing * (through - impl.lost_share);
  ++impl.updates_since_search;
  if (impl.settings.relocalise && impl.lost_share > impl.settings.lost_above &&
      impl.updates_since_search >= 5) {
    impl.updates_since_search = 0;
    impl.Relocalise(scan, e.pose());
    e = impl.Summary();
  }
  const double sigma_xy = std::sqrt(e.covariance[0] + e.covariance[4]),
               sigma_heading = std::sqrt(e.covariance[8]);
  if (e.particles > impl.settings.particles && sigma_xy < kSureXy_m && sigma_heading < kSureHeading_rad)
    impl.Thin();
  e.lost_share = impl.lost_share;
  e.localised = sigma_xy < impl.settings.localised_xy_m &&
                sigma_heading < impl.settings.localised_heading_rad &&
                impl.lost_share <= impl.settings.lost_above;
  estimate_ = e;
  return e;
}

std::vector<Pose2> Localiser::Particles() const {
  std::vector<Pose2> poses;
  for (const Particle& particle : impl_->filter.particles()) poses.push_back(particle.robot_in_hall);
  return poses;
}

}  // namespace docent::robot
