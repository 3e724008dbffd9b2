// The body in real time: a thread ticks it at `speed` times real time, and gives other threads access to its
// state. Thread-safe.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_LIVING_BODY_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_LIVING_BODY_H_

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "robot_adapters/sdk/operation.h"
#include "robot_adapters/sim/guide_body.h"

namespace docent::robot {

class LivingBody {
 public:
  // Pose and state of the body.
  struct Pose {
    maps::Pose2 estimate;
    bool localised = false;
    double deviation_m = 0;          // standard deviation of the estimated position
    std::vector<maps::Point2> path;  // that it drives along; empty: it does not drive
  };
  // The body's thread calls `on_pose` four times a real second. It saves the world to `world_path` once a
  // simulated second.
  LivingBody(std::unique_ptr<GuideBody> body, double speed, std::string world_path,
             std::function<void(const Pose&)> on_pose);
  ~LivingBody();

  // Drives to the goal; blocks until it is reached, the drive has failed, or the command must stop. ABORTED:
  // a drive is already under way.
  absl::Status Drive(const maps::Pose2& goal_in_hall, OperationContext& context);

  Pose pose() const;
  DriveReport Report() const;
  absl::StatusOr<maps::Point2> NearestFree(const maps::Point2& wanted, double radius_m) const;

 private:
  void Live();
  absl::Status WaitUntilLocalised(OperationContext& context);

  const double speed_;
  const std::string world_path_;
  const std::function<void(const Pose&)> on_pose_;
  mutable absl::Mutex mutex_;
  const std::unique_ptr<GuideBody> body_ ABSL_PT_GUARDED_BY(mutex_);
  bool driving_ ABSL_GUARDED_BY(mutex_) = false;
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_LIVING_BODY_H_
