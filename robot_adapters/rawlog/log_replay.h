// Replay of a recorded drive through the localiser of our own robot: poses, and the named regions that
// contain them.
#ifndef DOCENT_ROBOT_ADAPTERS_RAWLOG_LOG_REPLAY_H_
#define DOCENT_ROBOT_ADAPTERS_RAWLOG_LOG_REPLAY_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/regions.h"
#include "robot_adapters/localization/localiser.h"
#include "robot_adapters/rawlog/recorded_drive.h"

namespace docent::robot {

struct ReplayedStep {
  size_t number = 0;  // from 0, as in the recording
  TimeMicros time_us = 0;
  Estimate estimate;
  const maps::Region* region = nullptr;  // innermost; nullptr: none, or not localised
};

// Feeds the drive to a localiser without a start pose: it searches with the first scan, then tracks. One
// thread.
class LogReplay {
 public:
  // `regions` may be nullptr; it must outlive the replay.
  LogReplay(std::shared_ptr<const maps::HallModel> building, RecordedDrive drive,
            const maps::RegionIndex* regions, const LocaliserSettings& settings, uint64_t seed);

  bool Done() const { return next_ == drive_.steps.size(); }
  // Processes the next step of the recording. Requires !Done(). An error of the localiser ends the replay.
  absl::StatusOr<ReplayedStep> Next();
  // The recorded time of the next step. Requires !Done().
  TimeMicros NextTime() const { return drive_.steps[next_].time_us; }

 private:
  RecordedDrive drive_;
  const maps::RegionIndex* regions_;
  Localiser localiser_;
  size_t next_ = 0;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_RAWLOG_LOG_REPLAY_H_
