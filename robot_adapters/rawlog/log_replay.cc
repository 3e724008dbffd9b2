#include "robot_adapters/rawlog/log_replay.h"

#include <utility>

namespace docent::robot {

LogReplay::LogReplay(std::shared_ptr<const maps::HallModel> building, RecordedDrive drive,
                     const maps::RegionIndex* regions, const LocaliserSettings& settings, uint64_t seed)
    : drive_(std::move(drive)), regions_(regions), localiser_(std::move(building), settings, seed) {}

absl::StatusOr<ReplayedStep> LogReplay::Next() {
  const RecordedStep& recorded = drive_.steps[next_];
  absl::StatusOr<Estimate> estimate;
  if (next_ == 0) {
    // The search has already used this scan; weighing it again would count it twice.
    if (absl::Status status = localiser_.InitialiseGlobally(recorded.scan); !status.ok()) return status;
    estimate = localiser_.estimate();
  } else {
    estimate = localiser_.Update(recorded.odometry, recorded.scan);
    if (!estimate.ok()) return estimate.status();
  }
  ReplayedStep step = {next_, recorded.time_us, *estimate, nullptr};
  if (regions_ != nullptr && estimate->localised)
    step.region = regions_->Innermost(estimate->pose().position());
  ++next_;
  return step;
}

}  // namespace docent::robot
