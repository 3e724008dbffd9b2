#include "robot_adapters/localization/localiser_settings.h"

#include <initializer_list>

#include "absl/strings/str_format.h"

namespace docent::robot {
namespace {

struct Range {
  const char* name;
  double value;
  double low;
  double high;
};

absl::Status Check(std::initializer_list<Range> ranges) {
  for (const Range& range : ranges) {
    if (range.value >= range.low && range.value <= range.high) continue;
    return absl::InvalidArgumentError(absl::StrFormat("localiser: %s = %g is not in %g..%g", range.name,
                                                      range.value, range.low, range.high));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const LocaliserSettings& s) {
  return Check({{"sensor.sigma_hit_m", s.sensor.sigma_hit_m, 0.005, 1},
                {"sensor.z_random", s.sensor.z_random, 0.001, 0.999},
                {"sensor.temper", s.sensor.temper, 0.01, 1},
                {"sensor.max_beams", static_cast<double>(s.sensor.max_beams), 1, 10000},
                {"sensor.cell_m", s.sensor.cell_m, 0.005, 0.5},
                {"motion.xy_per_m", s.motion.xy_per_m, 0, 1},
                {"motion.xy_per_rad", s.motion.xy_per_rad, 0, 1},
                {"motion.heading_per_m", s.motion.heading_per_m, 0, 1},
                {"motion.heading_per_rad", s.motion.heading_per_rad, 0, 1},
                {"motion.min_xy_m", s.motion.min_xy_m, 1e-6, 1},
                {"motion.min_heading_rad", s.motion.min_heading_rad, 1e-6, 1},
                {"particles", static_cast<double>(s.particles), 50, 100000},
                {"search_particles", static_cast<double>(s.search_particles), 50, 100000},
                {"resample_below", s.resample_below, 0, 1},
                {"search_step_m", s.search_step_m, 0.05, 2},
                {"search_step_rad", s.search_step_rad, 0.01, 1},
                {"search_beams", static_cast<double>(s.search_beams), 1, 10000},
                {"search_clearance_m", s.search_clearance_m, 0, 5},
                {"lost_above", s.lost_above, 0.01, 1},
                {"lost_margin_m", s.lost_margin_m, 0.05, 5},
                {"lost_smoothing", s.lost_smoothing, 0.01, 1},
                {"localised_xy_m", s.localised_xy_m, 0.01, 5},
                {"localised_heading_rad", s.localised_heading_rad, 0.01, 3}});
}

}  // namespace docent::robot
