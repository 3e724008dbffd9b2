// Reference poses of a recorded drive: computed once by a filter that shares neither our map nor our sensor
// model (docent-bench localisation --make-reference), kept as a small CSV beside the scenario.
//
// A file has comment lines ("# …"), one line of column names, and one line a step:
//   step,time_us,x_m,y_m,heading_rad,spread_m
// Values and free functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_RAWLOG_REFERENCE_TRACK_H_
#define DOCENT_ROBOT_ADAPTERS_RAWLOG_REFERENCE_TRACK_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "maps/hall_layout.h"

namespace docent::robot {

struct ReferencePose {
  size_t step = 0;  // of the recording, from 0
  TimeMicros time_us = 0;
  maps::Pose2 robot_in_hall;
  double spread_m = 0;  // standard deviation between the runs that were averaged
};

// NOT_FOUND; INVALID_ARGUMENT naming the unreadable line.
absl::StatusOr<std::vector<ReferencePose>> ReadReference(const std::string& path);
// Comment lines of `how_made` (each without "# ") come first. Errors of the file system as UNAVAILABLE.
absl::Status WriteReference(const std::string& path, const std::vector<std::string>& how_made,
                            const std::vector<ReferencePose>& poses);

// The first step whose pose lies in the region's outline; nullopt: none.
std::optional<size_t> StepOfEntry(const std::vector<ReferencePose>& poses, const maps::Region& region);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_RAWLOG_REFERENCE_TRACK_H_
