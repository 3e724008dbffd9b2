// docent_mrpt_files.so: reads MRPT's rawlogs and simple maps for docent-robot, which loads it when it needs it. MRPT brings OpenCV,
// GTK, Qt and GDAL; so only who replays a recording has to install them.
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDF.h>

#include <cmath>
#include <exception>

#include "robot_adapters/mrpt_files/mrpt_error.h"
#include "robot_adapters/mrpt_files/mrpt_scan.h"
#include "robot_adapters/rawlog/mrpt_files_module.h"

namespace docent::robot {
namespace {

mrpt::obs::CObservation2DRangeScan::Ptr FirstScan(const mrpt::obs::CSensoryFrame& frame) {
  return frame.getObservationByClass<mrpt::obs::CObservation2DRangeScan>();
}

absl::StatusOr<RecordedDrive> ReadDrive(const std::string& path) {
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

absl::StatusOr<std::vector<maps::PosedScan>> ReadScans(const std::string& path) {
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

}  // namespace

extern "C" {
extern const MrptFiles docent_mrpt_files;
const MrptFiles docent_mrpt_files = {ReadDrive, ReadScans};
}

}  // namespace docent::robot
