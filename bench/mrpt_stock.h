// MRPT's own localisation, as a baseline and as a reference that shares neither our map nor our sensor model:
// its particle filter with its likelihood field on its occupancy grid.
#ifndef DOCENT_BENCH_MRPT_STOCK_H_
#define DOCENT_BENCH_MRPT_STOCK_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/distance_grid.h"
#include "maps/hall_model.h"
#include "maps/laser_scan.h"
#include "robot_adapters/localization/localiser_settings.h"

namespace docent::bench {

struct StockSettings {
  // [MetricMap_occupancyGrid_00_likelihoodOpts], [PF_options] and [KLD_options] of
  // /usr/share/mrpt/config_files/pf-localization/localization_demo.ini
  int decimation = 20;
  double std_hit_m = 0.20;
  double pow_factor = 1;
  bool adaptive = true;  // KLD sampling; false: `particles` throughout
  int min_particles = 150;
  int max_particles = 40000;
  int particles = 40000;  // at the start; of a tracked start at a known pose: 1000
  robot::MotionModelSettings motion;
};

// pf-localization with the configuration of its package.
StockSettings PfLocalization();
// Weighs every beam, tempered as ours, with the same number of particles as ours.
StockSettings EveryBeam();

// One thread; MRPT's process-wide random generator is seeded by the constructor.
class StockFilter {
 public:
  // The grid for MRPT's weights: the plane of the laser of our model, or (for a reference) drawn by MRPT from
  // scans.
  StockFilter(const maps::DistanceGrid& laser_field, const StockSettings& settings, uint32_t seed);
  StockFilter(const std::vector<maps::PosedScan>& scans, const StockSettings& settings, uint32_t seed);
  ~StockFilter();

  void StartAt(const maps::Pose2& pose, double sigma_xy_m, double sigma_heading_rad, int particles);
  // Starts at any free place within the bounds. INTERNAL: MRPT found no free cell.
  absl::Status StartAnywhere(const maps::Bounds& within);

  // Mean pose after one step. INTERNAL: an MRPT exception.
  absl::StatusOr<maps::Pose2> Update(const maps::Pose2& odometry, const maps::LaserScan& scan);

  int particles() const;
  double spread_m() const;  // standard deviation of the particles' places

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// MRPT's iterative closest points (CICP) of a scan against all points of a recorded map. It makes the
// reference more accurate than the cells of a grid. One thread.
class IcpAligner {
 public:
  explicit IcpAligner(const std::vector<maps::PosedScan>& map);
  ~IcpAligner();
  // `pose` corrected. INTERNAL: an MRPT exception, or fewer than half of the points found a partner.
  absl::StatusOr<maps::Pose2> Align(const maps::LaserScan& scan, const maps::Pose2& pose) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_MRPT_STOCK_H_
