#include "robot_adapters/rawlog/recorded_drive.h"

#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDF.h>

#include <cmath>
#include <exception>
#include <filesystem>

#include "robot_adapters/localization/distance_map.h"
#include "robot_adapters/localization/mrpt_error.h"

namespace docent::robot {
namespace {

// Longer beams are too sparse to draw walls (half a degree apart: 35 cm at 40 m).
constexpr double kMapRange_m = 40;

absl::Status Missing(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return absl::OkStatus();
  return absl::NotFoundError("no such file: " + path);
}

mrpt::obs::CObservation2DRangeScan::Ptr FirstScan(const mrpt::obs::CSensoryFrame& frame) {
  return frame.getObservationByClass<mrpt::obs::CObservation2DRangeScan>();
}

}  // namespace

absl::StatusOr<std::string> FindMrptDataset(const std::string& name) {
  for (const char* prefix : {"/usr", "/usr/local", "/opt/mrpt"}) {
    const std::string path = std::string(prefix) + "/share/mrpt/datasets/" + name;
    if (Missing(path).ok()) return path;
  }
  return absl::NotFoundError("no data set " + name +
                             " under /usr/share/mrpt/datasets: install the package mrpt-common");
}

absl::StatusOr<RecordedDrive> ReadRawlog(const std::string& path) {
  if (absl::Status missing = Missing(path); !missing.ok()) return missing;
  RecordedDrive drive;
  drive.file = path;
  try {
    mrpt::obs::CRawlog log;
    if (!log.loadFromRawLogFile(path)) return absl::InvalidArgumentError(path + ": not an MRPT rawlog");
    maps::Pose2 moved;
    for (size_t i = 0; i < log.size(); ++i) {
      if (log.getType(i) == mrpt::obs::CRawlog::etActionCollection) {
        const auto movement = log.getAsAction(i)->getBestMovementEstimation();
        if (!movement) continue;
        const mrpt::poses::CPose2D& increment = movement->rawOdometryIncrementReading;
        moved = maps::Compose(moved, {increment.x(), increment.y(), increment.phi()});
      } else if (log.getType(i) == mrpt::obs::CRawlog::etSensoryFrame) {
        const auto scan = FirstScan(*log.getAsObservations(i));
        if (!scan) continue;
        const double seconds = mrpt::Clock::toDouble(scan->timestamp);
        drive.steps.push_back({static_cast<TimeMicros>(std::llround(seconds * 1e6)), moved, FromMrpt(*scan)});
        moved = {};
      }
    }
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(path + ": " + MrptMessage(error));
  }
  if (drive.steps.empty())
    return absl::InvalidArgumentError(path + ": no action/observation pair with a 2D scan");
  return drive;
}

absl::StatusOr<std::vector<maps::PosedScan>> ReadSimplemap(const std::string& path) {
  if (absl::Status missing = Missing(path); !missing.ok()) return missing;
  std::vector<maps::PosedScan> scans;
  try {
    mrpt::maps::CSimpleMap map;
    if (!map.loadFromFile(path)) return absl::InvalidArgumentError(path + ": not an MRPT simple map");
    for (size_t i = 0; i < map.size(); ++i) {
      const auto [pose, frame] = map.get(i);
      const auto scan = FirstScan(*frame);
      if (!scan) continue;
      const mrpt::poses::CPose3D mean = pose->getMeanVal();
      scans.push_back({{mean.x(), mean.y(), mean.yaw()}, FromMrpt(*scan)});
    }
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(path + ": " + MrptMessage(error));
  }
  if (scans.empty()) return absl::InvalidArgumentError(path + ": no 2D scan in the map");
  return scans;
}

absl::StatusOr<std::shared_ptr<const maps::HallModel>> BuildingFromSimplemap(const std::string& path) {
  const absl::StatusOr<std::vector<maps::PosedScan>> scans = ReadSimplemap(path);
  if (!scans.ok()) return scans.status();
  maps::HallModelSettings settings;
  settings.measured = true;
  // A 2D laser has seen only one plane of the building, so paths of the robot's body are planned in it, too.
  settings.body_min_z_m = settings.laser_min_z_m;
  settings.body_max_z_m = settings.laser_max_z_m;
  return maps::HallModel::FromScans(*scans, kMapRange_m, settings);
}

}  // namespace docent::robot
