// Recording of a real robot: its odometry and laser scans (an MRPT rawlog), and the map of its building (an
// MRPT simple map: scans at known poses). A module with MRPT reads the files (mrpt_files_module.h). Free functions;
// any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_RAWLOG_RECORDED_DRIVE_H_
#define DOCENT_ROBOT_ADAPTERS_RAWLOG_RECORDED_DRIVE_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "maps/hall_model.h"
#include "maps/laser_scan.h"

namespace docent::robot {

struct RecordedStep {
  TimeMicros time_us = 0;  // of the scan
  maps::Pose2 odometry;    // increment since the step before, in the robot's frame
  maps::LaserScan scan;
};

struct RecordedDrive {
  std::string file;
  std::vector<RecordedStep> steps;  // in the order of recording
};

// The path of the data set `name`, e.g. "localization_demo.rawlog", installed by Debian's mrpt-common (or an
// own build of MRPT): <prefix>/share/mrpt/datasets for /usr, /usr/local and /opt/mrpt. NOT_FOUND names the
// package to install.
absl::StatusOr<std::string> FindMrptDataset(const std::string& name);

// Reads a rawlog of action and observation pairs with a 2D laser. The first scan of an observation is used;
// movements without a scan are added to the next. NOT_FOUND: the file, or the module; INVALID_ARGUMENT: not a rawlog, or no
// scan in it.
absl::StatusOr<RecordedDrive> ReadRawlog(const std::string& path);

// The scans of a simple map (.simplemap, .simplemap.gz) with their mean poses. Errors as ReadRawlog.
absl::StatusOr<std::vector<maps::PosedScan>> ReadSimplemap(const std::string& path);

// The map of a simple map's building, for localisation: OctoMap from its scans, voxels of 5 cm.
absl::StatusOr<std::shared_ptr<const maps::HallModel>> BuildingFromSimplemap(const std::string& path);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_RAWLOG_RECORDED_DRIVE_H_
