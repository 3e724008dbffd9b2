#include "bench/mrpt_stock.h"

#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CICP.h>
#include <mrpt/slam/CMonteCarloLocalization2D.h>

#include <cmath>
#include <exception>
#include <random>

#include "robot_adapters/mrpt_files/mrpt_error.h"
#include "robot_adapters/mrpt_files/mrpt_scan.h"

namespace docent::bench {

using mrpt::maps::COccupancyGridMap2D;

StockSettings PfLocalization() {
  return {};
}

StockSettings EveryBeam() {
  StockSettings settings;
  settings.decimation = 1;
  settings.std_hit_m = robot::SensorModelSettings().sigma_hit_m;
  settings.pow_factor = robot::SensorModelSettings().temper;
  settings.adaptive = false;
  settings.particles = robot::LocaliserSettings().particles;
  return settings;
}

struct StockFilter::Impl {
  Impl(const StockSettings& with, uint32_t seed)
      : settings(with), grid(COccupancyGridMap2D::Create()), pdf(1) {
    mrpt::random::getRandomGenerator().randomize(seed);
    grid->likelihoodOptions.likelihoodMethod = COccupancyGridMap2D::lmLikelihoodField_Thrun;
    grid->likelihoodOptions.LF_decimation = static_cast<uint32_t>(with.decimation);
    grid->likelihoodOptions.LF_stdHit = static_cast<float>(with.std_hit_m);
    grid->likelihoodOptions.LF_maxCorrsDistance = 0.30f;
    grid->likelihoodOptions.LF_zHit = 0.95f;
    grid->likelihoodOptions.LF_zRandom = 0.05f;
    grid->likelihoodOptions.LF_maxRange = 80;
    pdf.options.metricMap = grid;
    pdf.options.KLD_params.KLD_binSize_PHI = mrpt::DEG2RAD(10.0);
    pdf.options.KLD_params.KLD_binSize_XY = 0.10;
    pdf.options.KLD_params.KLD_delta = 0.01;
    pdf.options.KLD_params.KLD_epsilon = 0.01;
    pdf.options.KLD_params.KLD_minSampleSize = static_cast<unsigned>(with.min_particles);
    pdf.options.KLD_params.KLD_maxSampleSize = static_cast<unsigned>(with.max_particles);
    pdf.options.KLD_params.KLD_minSamplesPerBin = 0;
    filter.m_options.PF_algorithm = mrpt::bayes::CParticleFilter::pfStandardProposal;
    filter.m_options.resamplingMethod = mrpt::bayes::CParticleFilter::prMultinomial;
    filter.m_options.adaptiveSampleSize = with.adaptive;
    filter.m_options.BETA = 0.5;
    filter.m_options.powFactor = with.pow_factor;
    auto& gaussian = motion.gaussianModel;
    motion.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
    gaussian.a1 = static_cast<float>(with.motion.xy_per_m);
    gaussian.a2 = static_cast<float>(with.motion.xy_per_rad);
    gaussian.a3 = static_cast<float>(with.motion.heading_per_m);
    gaussian.a4 = static_cast<float>(with.motion.heading_per_rad);
    gaussian.minStdXY = static_cast<float>(with.motion.min_xy_m);
    gaussian.minStdPHI = static_cast<float>(with.motion.min_heading_rad);
  }

  StockSettings settings;
  COccupancyGridMap2D::Ptr grid;
  mrpt::slam::CMonteCarloLocalization2D pdf;
  mrpt::bayes::CParticleFilter filter;
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions motion;
};

StockFilter::StockFilter(const maps::DistanceGrid& field, const StockSettings& settings, uint32_t seed)
    : impl_(std::make_unique<Impl>(settings, seed)) {
  const double width_m = field.width * field.resolution_m, height_m = field.height * field.resolution_m;
  impl_->grid->setSize(static_cast<float>(field.origin_x_m), static_cast<float>(field.origin_x_m + width_m),
                       static_cast<float>(field.origin_y_m), static_cast<float>(field.origin_y_m + height_m),
                       static_cast<float>(field.resolution_m));
  for (int j = 0; j < field.height; ++j) {
    for (int i = 0; i < field.width; ++i) {
      const maps::CellState state = field.state[static_cast<size_t>(j) * field.width + i];
      const maps::Point2 center = field.CenterOf(i, j);
      const float free = state == maps::CellState::kFree       ? 0.99f
                         : state == maps::CellState::kOccupied ? 0.01f
                                                               : 0.5f;
      impl_->grid->setCell(impl_->grid->x2idx(static_cast<float>(center.x_m)),
                           impl_->grid->y2idx(static_cast<float>(center.y_m)), free);
    }
  }
}

StockFilter::StockFilter(const std::vector<maps::PosedScan>& scans, const StockSettings& settings,
                         uint32_t seed)
    : impl_(std::make_unique<Impl>(settings, seed)) {
  // [MetricMap_occupancyGrid_00_creationOpts] and _insertOpts of the same file
  COccupancyGridMap2D& grid = *impl_->grid;
  grid.setSize(-20, 20, -20, 20, 0.06f);
  grid.insertionOptions.useMapAltitude = false;
  grid.insertionOptions.maxDistanceInsertion = 15;
  grid.insertionOptions.maxOccupancyUpdateCertainty = 0.55f;
  grid.insertionOptions.considerInvalidRangesAsFreeSpace = true;
  for (const maps::PosedScan& posed : scans) {
    const mrpt::poses::CPose3D pose(posed.robot_in_hall.x_m, posed.robot_in_hall.y_m, 0,
                                    posed.robot_in_hall.heading_rad, 0, 0);
    grid.insertObservation(*robot::ToMrpt(posed.scan), pose);
  }
}

StockFilter::~StockFilter() = default;

void StockFilter::StartAt(const maps::Pose2& pose, double sigma_xy_m, double sigma_heading_rad,
                          int particles) {
  auto& random = mrpt::random::getRandomGenerator();
  impl_->pdf.m_particles.clear();
  for (int k = 0; k < particles; ++k) {
    impl_->pdf.m_particles.emplace_back(
        mrpt::math::TPose2D(random.drawGaussian1D(pose.x_m, sigma_xy_m),
                            random.drawGaussian1D(pose.y_m, sigma_xy_m),
                            random.drawGaussian1D(pose.heading_rad, sigma_heading_rad)),
        0.0);
  }
}

absl::Status StockFilter::StartAnywhere(const maps::Bounds& within) {
  try {
    impl_->pdf.resetUniformFreeSpace(impl_->grid.get(), 0.7, impl_->settings.particles, within.min_x_m,
                                     within.max_x_m, within.min_y_m, within.max_y_m);
    return absl::OkStatus();
  } catch (const std::exception& error) {
    return absl::InternalError(robot::MrptMessage(error));
  }
}

absl::StatusOr<maps::Pose2> StockFilter::Update(const maps::Pose2& odometry, const maps::LaserScan& scan) {
  try {
    mrpt::obs::CActionRobotMovement2D movement;
    movement.computeFromOdometry(mrpt::poses::CPose2D(odometry.x_m, odometry.y_m, odometry.heading_rad),
                                 impl_->motion);
    mrpt::obs::CActionCollection actions;
    actions.insert(movement);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(robot::ToMrpt(scan));
    impl_->filter.executeOn(impl_->pdf, &actions, &frame);
    const mrpt::poses::CPose2D mean = impl_->pdf.getMeanVal();
    return maps::Pose2{mean.x(), mean.y(), mean.phi()};
  } catch (const std::exception& error) {
    return absl::InternalError(robot::MrptMessage(error));
  }
}

int StockFilter::particles() const {
  return static_cast<int>(impl_->pdf.m_particles.size());
}

double StockFilter::spread_m() const {
  const auto [covariance, mean] = impl_->pdf.getCovarianceAndMean();
  return std::sqrt(covariance(0, 0) + covariance(1, 1));
}

struct IcpAligner::Impl {
  mrpt::maps::CSimplePointsMap points;
};

IcpAligner::IcpAligner(const std::vector<maps::PosedScan>& map) : impl_(std::make_unique<Impl>()) {
  impl_->points.insertionOptions.minDistBetweenLaserPoints = 0;
  impl_->points.insertionOptions.also_interpolate = false;
  for (const maps::PosedScan& posed : map) {
    const mrpt::poses::CPose3D pose(posed.robot_in_hall.x_m, posed.robot_in_hall.y_m, 0,
                                    posed.robot_in_hall.heading_rad, 0, 0);
    impl_->points.insertObservation(*robot::ToMrpt(posed.scan), pose);
  }
}

IcpAligner::~IcpAligner() = default;

absl::StatusOr<maps::Pose2> IcpAligner::Align(const maps::LaserScan& scan, const maps::Pose2& pose) const {
  try {
    mrpt::maps::CSimplePointsMap seen;
    seen.insertionOptions.minDistBetweenLaserPoints = 0;
    seen.insertObservation(*robot::ToMrpt(scan));
    mrpt::slam::CICP icp;
    icp.options.maxIterations = 200;
    icp.options.thresholdDist = 0.40;
    icp.options.thresholdAng = 0;
    icp.options.smallestThresholdDist = 0.05;
    icp.options.corresponding_points_decimation = 1;
    icp.options.skip_cov_calculation = true;
    icp.options.skip_quality_calculation = false;
    mrpt::slam::CICP::TReturnInfo info;
    const auto aligned =
        icp.Align(&impl_->points, &seen, mrpt::poses::CPose2D(pose.x_m, pose.y_m, pose.heading_rad), info);
    if (info.goodness < 0.5)
      return absl::InternalError("too few points of the scan have a partner in the map");
    const mrpt::poses::CPose2D mean = aligned->getMeanVal();
    return maps::Pose2{mean.x(), mean.y(), mean.phi()};
  } catch (const std::exception& error) {
    return absl::InternalError(robot::MrptMessage(error));
  }
}

}  // namespace docent::bench
