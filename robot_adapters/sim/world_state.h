// Pose of the simulated robot, kept in a file, so that the robot stays in place when its program
// restarts.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_WORLD_STATE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_WORLD_STATE_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "maps/geometry.h"

namespace docent::robot {

absl::Status SaveWorld(const std::string& path, const maps::Pose2& robot_in_hall);
// nullopt: no such file, or not a world file.
std::optional<maps::Pose2> LoadWorld(const std::string& path);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_WORLD_STATE_H_
