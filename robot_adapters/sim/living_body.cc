#include "robot_adapters/sim/living_body.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "robot_adapters/sim/world_state.h"

namespace docent::robot {
namespace {

using Steady = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPosePeriod{250};
constexpr std::chrono::milliseconds kLookPeriod{20};
// A process that was stopped for longer than this does not catch up: its world stopped with it.
constexpr std::chrono::milliseconds kMostBehind{200};

LivingBody::Pose PoseOf(const GuideBody& body) {
  return {body.estimate(), body.localised(), body.deviation_m(), body.path()};
}

}  // namespace

LivingBody::LivingBody(std::unique_ptr<GuideBody> body, double speed, std::string world_path,
                       std::function<void(const Pose&)> on_pose)
    : speed_(speed),
      world_path_(std::move(world_path)),
      on_pose_(std::move(on_pose)),
      body_(std::move(body)),
      thread_([this] { Live(); }) {}

LivingBody::~LivingBody() {
  {
    absl::MutexLock lock(&mutex_);
    ending_ = true;
  }
  thread_.join();
}

void LivingBody::Live() {
  Steady::duration tick;
  {
    absl::MutexLock lock(&mutex_);
    tick = std::chrono::duration_cast<Steady::duration>(
        std::chrono::duration<double>(body_->settings().tick_s / speed_));
  }
  Steady::time_point next_tick = Steady::now(), next_pose = next_tick;
  double saved_at_s = -1;
  while (true) {
    Pose pose;
    maps::Pose2 truth;
    double time_s = 0;
    {
      absl::MutexLock lock(&mutex_);
      if (ending_) break;
      body_->Tick();
      pose = PoseOf(*body_);
      truth = body_->truth();
      time_s = body_->time_s();
    }
    const Steady::time_point now = Steady::now();
    if (now >= next_pose) {
      next_pose = now + kPosePeriod;
      on_pose_(pose);
    }
    if (time_s >= saved_at_s + 1) {
      saved_at_s = time_s;
      if (absl::Status status = SaveWorld(world_path_, truth); !status.ok()) {
        spdlog::warn("{}", std::string(status.message()));
      }
    }
    next_tick = std::max(next_tick + tick, now - kMostBehind);
    std::this_thread::sleep_until(next_tick);
  }
  absl::MutexLock lock(&mutex_);
  if (absl::Status status = SaveWorld(world_path_, body_->truth()); !status.ok()) {
    spdlog::warn("{}", std::string(status.message()));
  }
}

absl::Status LivingBody::WaitUntilLocalised(OperationContext& context) {
  while (true) {
    {
      absl::MutexLock lock(&mutex_);
      if (body_->localised()) return absl::OkStatus();
    }
    context.ReportProgress(0, "looking around: not sure where it is");
    if (!context.SleepFor(kLookPeriod))
      return absl::CancelledError("stopped before the robot knew where it was");
  }
}

absl::Status LivingBody::Drive(const maps::Pose2& goal_in_hall, OperationContext& context) {
  if (absl::Status status = WaitUntilLocalised(context); !status.ok()) return status;
  {
    absl::MutexLock lock(&mutex_);
    if (driving_) return absl::AbortedError("the robot is driving for another command");
    if (absl::Status status = body_->DriveTo(goal_in_hall); !status.ok()) return status;
    driving_ = true;
  }
  absl::Status ended;
  for (bool go_on = true;;) {
    DriveStatus status;
    {
      absl::MutexLock lock(&mutex_);
      status = body_->drive();
      if (!go_on) body_->Halt();
    }
    if (status.state == DriveStatus::State::kArrived) break;
    if (status.state == DriveStatus::State::kFailed) {
      ended = absl::UnavailableError(status.message);
      break;
    }
    if (!go_on) {
      ended = absl::CancelledError("stopped on the way");
      break;
    }
    context.ReportProgress(status.progress, status.message);
    go_on = context.SleepFor(kLookPeriod);
  }
  absl::MutexLock lock(&mutex_);
  driving_ = false;
  return ended;
}

LivingBody::Pose LivingBody::pose() const {
  absl::MutexLock lock(&mutex_);
  return PoseOf(*body_);
}

DriveReport LivingBody::Report() const {
  absl::MutexLock lock(&mutex_);
  return body_->Report();
}

absl::StatusOr<maps::Point2> LivingBody::NearestFree(const maps::Point2& wanted, double radius_m) const {
  absl::MutexLock lock(&mutex_);
  return body_->planner().NearestFree(wanted, radius_m);
}

}  // namespace docent::robot
