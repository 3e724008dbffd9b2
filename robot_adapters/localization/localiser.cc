#include "robot_adapters/localization/localiser.h"

#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CMonteCarloLocalization2D.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include "absl/synchronization/mutex.h"
#include "robot_adapters/localization/distance_map.h"
#include "robot_adapters/localization/global_search.h"
#include "robot_adapters/localization/mrpt_error.h"

namespace docent::robot {
namespace {

using maps::Pose2;

// Guards MRPT's process-wide random generator; held while a filter draws numbers.
absl::Mutex& MrptRandomMutex() {
  static absl::Mutex mutex;
  return mutex;
}

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
        map(std::make_shared<DistanceMap>(model, with.sensor.max_beams)),
        pdf(static_cast<size_t>(with.particles)) {
    pdf.options.metricMap = map;
    filter.m_options.PF_algorithm = mrpt::bayes::CParticleFilter::pfStandardProposal;
    filter.m_options.resamplingMethod = mrpt::bayes::CParticleFilter::prSystematic;
    filter.m_options.adaptiveSampleSize = false;
    filter.m_options.BETA = with.resample_below;
    motion.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
    motion.gaussianModel.a1 = static_cast<float>(with.motion.xy_per_m);
    motion.gaussianModel.a2 = static_cast<float>(with.motion.xy_per_rad);
    motion.gaussianModel.a3 = static_cast<float>(with.motion.heading_per_m);
    motion.gaussianModel.a4 = static_cast<float>(with.motion.heading_per_rad);
    motion.gaussianModel.minStdXY = static_cast<float>(with.motion.min_xy_m);
    motion.gaussianModel.minStdPHI = static_cast<float>(with.motion.min_heading_rad);
  }

  // Replaces all particles by samples around `centres`, which are chosen in proportion to their weights.
  void Spread(const std::vector<std::pair<Pose2, double>>& centres, double sigma_xy_m,
              double sigma_heading_rad, int count) {
    std::vector<double> weights;
    for (const auto& [pose, weight] : centres) weights.push_back(weight);
    std::discrete_distribution<size_t> choose(weights.begin(), weights.end());
    std::normal_distribution<double> normal(0, 1);
    pdf.m_particles.clear();
    for (int k = 0; k < count; ++k) {
      const Pose2& centre = centres[choose(random)].first;
      const double x = centre.x_m + sigma_xy_m * normal(random), y = centre.y_m + sigma_xy_m * normal(random);
      const double heading = maps::WrapAngle(centre.heading_rad + sigma_heading_rad * normal(random));
      pdf.m_particles.emplace_back(mrpt::math::TPose2D(x, y, heading), 0.0);
    }
    initialised = true;
    lost_share = 0;
  }

  // Keeps `settings.particles` of the search's particles, drawn by weight.
  void Thin() {
    std::vector<std::pair<Pose2, double>> centres;
    for (const auto& particle : pdf.m_particles) {
      centres.push_back({{particle.d.x, particle.d.y, particle.d.phi}, std::exp(particle.log_w)});
    }
    const double before = lost_share;
    Spread(centres, settings.motion.min_xy_m, settings.motion.min_heading_rad, settings.particles);
    lost_share = before;
  }

  // One MRPT filter step: moves every particle, weighs it, resamples if few carry the weight.
  absl::Status Step(const Pose2& increment, const maps::LaserScan& scan) {
    try {
      mrpt::obs::CActionRobotMovement2D movement;
      movement.computeFromOdometry(mrpt::poses::CPose2D(increment.x_m, increment.y_m, increment.heading_rad),
                                   motion);
      mrpt::obs::CActionCollection actions;
      actions.insert(movement);
      const mrpt::obs::CObservation2DRangeScan::Ptr observation = ToMrpt(scan);
      mrpt::obs::CSensoryFrame frame;
      frame.insert(observation);
      map->Prepare(*observation);
      mrpt::bayes::CParticleFilter::TParticleFilterStats stats;
      absl::MutexLock lock(&MrptRandomMutex());
      mrpt::random::getRandomGenerator().randomize(static_cast<uint32_t>(random()));
      filter.executeOn(pdf, &actions, &frame, &stats);
      neff = stats.ESS_beforeResample * static_cast<double>(pdf.m_particles.size());
      return absl::OkStatus();
    } catch (const std::exception& error) {
      return absl::InternalError("MRPT's particle filter: " + MrptMessage(error));
    }
  }

  void MoveBy(const Pose2& increment) {
    for (auto& particle : pdf.m_particles) {
      const Pose2 moved = maps::Compose({particle.d.x, particle.d.y, particle.d.phi}, increment);
      particle.d = mrpt::math::TPose2D(moved.x_m, moved.y_m, moved.heading_rad);
    }
  }

  // Mean and covariance of the weighted particles; the heading's mean is that of the unit vectors.
  Estimate Summary() const {
    Estimate e;
    double heaviest = -1e300, total = 0, sum_x = 0, sum_y = 0, sum_sin = 0, sum_cos = 0;
    for (const auto& particle : pdf.m_particles) heaviest = std::max(heaviest, particle.log_w);
    for (const auto& particle : pdf.m_particles) {
      const double w = std::exp(particle.log_w - heaviest);
      total += w;
      sum_x += w * particle.d.x;
      sum_y += w * particle.d.y;
      sum_sin += w * std::sin(particle.d.phi);
      sum_cos += w * std::cos(particle.d.phi);
    }
    e.x_m = sum_x / total;
    e.y_m = sum_y / total;
    e.heading_rad = std::atan2(sum_sin, sum_cos);
    for (const auto& particle : pdf.m_particles) {
      const double w = std::exp(particle.log_w - heaviest) / total;
      const double d[3] = {particle.d.x - e.x_m, particle.d.y - e.y_m,
                           maps::WrapAngle(particle.d.phi - e.heading_rad)};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) e.covariance[3 * row + column] += w * d[row] * d[column];
      }
    }
    e.neff = neff;
    e.particles = static_cast<int>(pdf.m_particles.size());
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
  std::shared_ptr<DistanceMap> map;
  mrpt::slam::CMonteCarloLocalization2D pdf;
  mrpt::bayes::CParticleFilter filter;
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions motion;
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
  const auto before = impl.pdf.m_particles;
  if (absl::Status status = impl.Step(odometry_increment, scan); !status.ok()) {
    impl.pdf.m_particles = before;
    impl.MoveBy(odometry_increment);
    estimate_ = impl.Summary();
    return status;
  }
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
  for (const auto& particle : impl_->pdf.m_particles)
    poses.push_back({particle.d.x, particle.d.y, particle.d.phi});
  return poses;
}

}  // namespace docent::robot
