// The data of scenario s02 for tests: log and map are in Debian's mrpt-common; a test without them is
// skipped.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_RAWLOG_REAL_LOG_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_RAWLOG_REAL_LOG_H_

#include <memory>
#include <string>

#include "maps/hall_layout.h"
#include "robot_adapters/rawlog/log_replay.h"
#include "robot_adapters/rawlog/recorded_drive.h"

namespace docent::robot {

inline constexpr char kLog[] = "localization_demo.rawlog";
inline constexpr char kMap[] = "localization_demo.simplemap.gz";
inline const std::string kScenario = std::string(DOCENT_SOURCE_DIR) + "/scenarios/s02_real_robot_log";

// Why a test cannot run; empty: it can.
inline std::string Missing() {
  for (const char* name : {kLog, kMap}) {
    const auto path = FindMrptDataset(name);
    if (!path.ok()) return std::string(path.status().message());
  }
  return "";
}

inline std::shared_ptr<const maps::HallModel> Building() {
  static const std::shared_ptr<const maps::HallModel> building =
      *BuildingFromSimplemap(*FindMrptDataset(kMap));
  return building;
}

inline maps::HallLayout Layout() {
  return *maps::HallLayout::FromFile(kScenario + "/layout.ttl");
}

}  // namespace docent::robot

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_RAWLOG_REAL_LOG_H_
