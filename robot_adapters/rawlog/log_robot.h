// A recorded drive as a live robot: the process joins the fleet, lives through the recording in its own time (or
// faster), and tells pose, region and certainty as facts, step by step, as the simulated robot does.
//
// It offers one operation, noteArrival(region): a recording cannot drive anywhere, but it can say when it was where.
#ifndef DOCENT_ROBOT_ADAPTERS_RAWLOG_LOG_ROBOT_H_
#define DOCENT_ROBOT_ADAPTERS_RAWLOG_LOG_ROBOT_H_

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "maps/hall_layout.h"
#include "maps/regions.h"
#include "robot_adapters/rawlog/log_replay.h"
#include "robot_adapters/sdk/robot_adapter.h"

namespace docent::robot {

struct LogRobotOptions {
  AdapterOptions adapter;
  std::string log_path;     // empty: localization_demo.rawlog of mrpt-common
  std::string map_path;     // empty: localization_demo.simplemap.gz of mrpt-common
  std::string layout_path;  // named regions in the frame of the map (RDF); required
  double speed = 1;         // > 0: how much faster than recorded
  uint64_t seed = 1;
  LocaliserSettings localiser;
};

class LogRobot {
 public:
  // Waits, and returns false when the robot has to stop.
  using Sleep = std::function<bool(std::chrono::microseconds)>;

  // Reads log, map and layout, makes the OctoMap, and serves the adapter. NOT_FOUND: a file, or the data set's
  // package; INVALID_ARGUMENT: what is wrong with which file; and the errors of RobotAdapter::Start.
  static absl::StatusOr<std::unique_ptr<LogRobot>> Start(LogRobotOptions options);

  // Lives through the recording once. CANCELLED if `sleep` said so; otherwise what the localiser says.
  absl::Status Replay(const Sleep& sleep);

  // Pose and region of each step so far, newest last. Any thread.
  std::vector<ReplayedStep> Steps() const;

  // Writes report.json (steps, path length, when which region was entered) and path.png (the path on the building's
  // map) into `folder`, which must be there. What the file system says.
  absl::Status WriteReport(const std::string& folder) const;

  RobotAdapter& adapter() { return *adapter_; }

 private:
  LogRobot(std::string robot, maps::HallLayout layout, std::shared_ptr<const maps::HallModel> building, double speed);
  Operation NoteArrival();
  void Tell(const ReplayedStep& step);
  // The first step in each region, in the order of entry.
  std::vector<std::pair<const maps::Region*, size_t>> Entries() const;

  const std::string robot_;  // IRI
  const maps::HallLayout layout_;
  const maps::RegionIndex regions_;
  const std::shared_ptr<const maps::HallModel> building_;
  const double speed_;
  std::unique_ptr<LogReplay> replay_;
  mutable absl::Mutex mutex_;
  std::vector<ReplayedStep> steps_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<RobotAdapter> adapter_;  // last: its threads use the members above
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_RAWLOG_LOG_ROBOT_H_
