#include "robot_adapters/sdk/fleet_member.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "absl/time/clock.h"

namespace docent::robot {
namespace {

constexpr absl::Duration kCallTimeout = absl::Seconds(5);
constexpr absl::Duration kFirstRetry = absl::Milliseconds(100);
constexpr absl::Duration kLastRetry = absl::Seconds(2);
// A third of the lease: two Joins may get lost before the robot counts as offline.
constexpr int kJoinsPerLease = 3;
constexpr absl::Duration kShortestPause = absl::Milliseconds(20);

}  // namespace

FleetMember::FleetMember(ServerLink* link, v1::JoinRequest request, std::function<void()> on_return)
    : link_(link),
      request_(std::move(request)),
      on_return_(std::move(on_return)),
      thread_([this] { Run(); }) {}

void FleetMember::Leave(absl::Duration timeout) {
  const absl::Time end = absl::Now() + timeout;
  {
    absl::MutexLock lock(&mutex_);
    stopped_ = true;
    // A Join that the server took after the Leave would make the robot be there again.
    auto answered = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return !joining_; };
    if (!mutex_.AwaitWithTimeout(absl::Condition(&answered), timeout) || !joined_) return;
    joined_ = false;
  }
  v1::LeaveRequest leave;
  leave.set_robot(request_.description().robot());
  leave.set_incarnation(request_.description().incarnation());
  v1::LeaveReply reply;
  const absl::Status status = link_->Leave(leave, &reply, end - absl::Now());
  if (status.ok()) {
    spdlog::info("left the fleet");
  } else {
    spdlog::warn("the server was not told that the robot leaves: {}", std::string(status.message()));
  }
}

void FleetMember::Stop() {
  {
    absl::MutexLock lock(&mutex_);
    stopped_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

bool FleetMember::joined() const {
  absl::MutexLock lock(&mutex_);
  return joined_;
}

// Once each, though every repetition brings them.
void FleetMember::SayWarnings(const v1::JoinReply& reply) {
  for (const std::string& warning : reply.warnings()) {
    if (warnings_.insert(warning).second)
      spdlog::warn("the server took the description but for: {}", warning);
  }
}

void FleetMember::Run() {
  absl::Duration retry = kFirstRetry;
  bool said = false;
  while (true) {
    {
      absl::MutexLock lock(&mutex_);
      if (stopped_) return;
      joining_ = true;
    }
    v1::JoinReply reply;
    absl::Status status = link_->Join(request_, &reply, kCallTimeout);
    absl::Duration pause = retry;
    bool returned = false;
    if (status.ok()) {
      pause = std::max(kShortestPause, absl::Milliseconds(reply.lease_ms()) / kJoinsPerLease);
      retry = kFirstRetry;
      said = false;
      SayWarnings(reply);
    } else {
      retry = std::min(2 * retry, kLastRetry);
    }
    {
      absl::MutexLock lock(&mutex_);
      joining_ = false;
      returned = status.ok() && (!joined_ || reply.tell_states());
      joined_ = status.ok();
      if (stopped_) return;
    }
    if (returned) {
      spdlog::info("joined the fleet, lease {} ms", reply.lease_ms());
      on_return_();
    }
    if (!status.ok() && !said) {
      said = true;
      spdlog::warn("cannot join the fleet, trying on: {}", std::string(status.message()));
    }
    absl::MutexLock lock(&mutex_);
    if (mutex_.AwaitWithTimeout(absl::Condition(&stopped_), pause)) return;
  }
}

}  // namespace docent::robot
