#include "robot_adapters/sim/world_state.h"

#include <cmath>
#include <fstream>

#include "absl/strings/str_format.h"
#include "robot_adapters/sim/text_file.h"

namespace docent::robot {

absl::Status SaveWorld(const std::string& path, const maps::Pose2& robot_in_hall) {
  return WriteTextFile(path, absl::StrFormat("pose %.6f %.6f %.6f\n", robot_in_hall.x_m, robot_in_hall.y_m,
                                             robot_in_hall.heading_rad));
}

std::optional<maps::Pose2> LoadWorld(const std::string& path) {
  std::ifstream in(path);
  std::string word;
  maps::Pose2 pose;
  if (!(in >> word >> pose.x_m >> pose.y_m >> pose.heading_rad) || word != "pose") return std::nullopt;
  if (!std::isfinite(pose.x_m) || !std::isfinite(pose.y_m) || !std::isfinite(pose.heading_rad))
    return std::nullopt;
  return pose;
}

}  // namespace docent::robot
