// What docent_mrpt_files.so has, and where it is found. Any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_RAWLOG_MRPT_FILES_MODULE_H_
#define DOCENT_ROBOT_ADAPTERS_RAWLOG_MRPT_FILES_MODULE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/laser_scan.h"
#include "robot_adapters/rawlog/recorded_drive.h"

namespace docent::robot {

// The module's variable `docent_mrpt_files`. Of a file that is there; errors as ReadRawlog.
struct MrptFiles {
  absl::StatusOr<RecordedDrive> (*read_drive)(const std::string& path);
  absl::StatusOr<std::vector<maps::PosedScan>> (*read_scans)(const std::string& path);
};
inline constexpr char kMrptFilesSymbol[] = "docent_mrpt_files";

// Loads lib/docent/docent_mrpt_files.so beside the program's folder, once. NOT_FOUND names the package to install.
absl::StatusOr<const MrptFiles*> LoadMrptFiles();

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_RAWLOG_MRPT_FILES_MODULE_H_
