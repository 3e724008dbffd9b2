#include "robot_adapters/rawlog/reference_track.h"

#include <fstream>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"

namespace docent::robot {
namespace {

constexpr char kColumns[] = "step,time_us,x_m,y_m,heading_rad,spread_m";

bool ReadRow(const std::string& line, ReferencePose& pose) {
  const std::vector<std::string> cells = absl::StrSplit(line, ',');
  return cells.size() == 6 && absl::SimpleAtoi(cells[0], &pose.step) &&
         absl::SimpleAtoi(cells[1], &pose.time_us) && absl::SimpleAtod(cells[2], &pose.robot_in_hall.x_m) &&
         absl::SimpleAtod(cells[3], &pose.robot_in_hall.y_m) &&
         absl::SimpleAtod(cells[4], &pose.robot_in_hall.heading_rad) &&
         absl::SimpleAtod(cells[5], &pose.spread_m);
}

}  // namespace

absl::StatusOr<std::vector<ReferencePose>> ReadReference(const std::string& path) {
  std::ifstream in(path);
  if (!in) return absl::NotFoundError("cannot read the reference " + path);
  std::vector<ReferencePose> poses;
  std::string line;
  bool columns_seen = false;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    ReferencePose pose;
    if (!columns_seen && line == kColumns) {
      columns_seen = true;
    } else if (columns_seen && ReadRow(line, pose)) {
      poses.push_back(pose);
    } else {
      return absl::InvalidArgumentError(absl::StrFormat("%s:%d: expected %s, found '%s'", path, number,
                                                        columns_seen ? "six numbers" : kColumns, line));
    }
  }
  if (poses.empty()) return absl::InvalidArgumentError(path + ": no pose in the reference");
  return poses;
}

absl::Status WriteReference(const std::string& path, const std::vector<std::string>& how_made,
                            const std::vector<ReferencePose>& poses) {
  std::ofstream out(path);
  for (const std::string& line : how_made) out << "# " << line << "\n";
  out << kColumns << "\n";
  for (const ReferencePose& pose : poses) {
    out << absl::StrFormat("%d,%d,%.4f,%.4f,%.5f,%.4f\n", pose.step, pose.time_us, pose.robot_in_hall.x_m,
                           pose.robot_in_hall.y_m, pose.robot_in_hall.heading_rad, pose.spread_m);
  }
  out.flush();
  return out ? absl::OkStatus() : absl::UnavailableError("cannot write the reference " + path);
}

std::optional<size_t> StepOfEntry(const std::vector<ReferencePose>& poses, const maps::Region& region) {
  for (const ReferencePose& pose : poses) {
    if (maps::Contains(region.outline, pose.robot_in_hall.position())) return pose.step;
  }
  return std::nullopt;
}

}  // namespace docent::robot
