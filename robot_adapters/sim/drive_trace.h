// Trace of a simulated drive: true and estimated poses, and the localiser's error statistics. A value.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_DRIVE_TRACE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_DRIVE_TRACE_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "maps/geometry.h"
#include "maps/hall_layout.h"

namespace docent::robot {

struct TracePoint {
  double time_s = 0;  // simulated, since the start
  maps::Pose2 truth;
  maps::Pose2 estimate;
};

// Errors of the estimate against the simulator's truth over all points of a trace.
struct PathError {
  size_t points = 0;
  double rmse_mm = 0;
  double rmse_deg = 0;
  double max_error_mm = 0;
  double max_error_deg = 0;
};

PathError ErrorOf(const std::vector<TracePoint>& trace);

struct DriveReport {
  std::string robot;  // IRI
  uint64_t seed = 0;
  double path_m = 0;  // true length of the driven path
  double simulated_s = 0;
  int bumps = 0;  // number of collisions
  int relocalisations = 0;
  std::vector<TracePoint> trace;  // one point for each scan while the robot moved and was localised
};

// Writes path.csv, report.json and path.png into `folder`, which must exist. Stops at the first error.
absl::Status WriteReport(const DriveReport& report, const maps::HallLayout& layout,
                         const std::string& folder);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_DRIVE_TRACE_H_
