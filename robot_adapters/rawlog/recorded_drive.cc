#include "robot_adapters/rawlog/recorded_drive.h"

#include <filesystem>

#include "robot_adapters/rawlog/mrpt_files_module.h"

namespace docent::robot {
namespace {

// Longer beams are too sparse to draw walls (half a degree apart: 35 cm at 40 m).
constexpr double kMapRange_m = 40;

absl::Status Missing(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return absl::OkStatus();
  return absl::NotFoundError("no such file: " + path);
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
  const absl::StatusOr<const MrptFiles*> files = LoadMrptFiles();
  if (!files.ok()) return files.status();
  return (*files)->read_drive(path);
}

absl::StatusOr<std::vector<maps::PosedScan>> ReadSimplemap(const std::string& path) {
  if (absl::Status missing = Missing(path); !missing.ok()) return missing;
  const absl::StatusOr<const MrptFiles*> files = LoadMrptFiles();
  if (!files.ok()) return files.status();
  return (*files)->read_scans(path);
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
