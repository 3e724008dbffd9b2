#include "robot_adapters/sdk/fleet_member.h"

#include <spdlog/spdlog.h>

#include <algorithm>

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
      if (stopped_) return;
      returned = status.ok() && (!joined_ || reply.tell_states());
      joined_ = status.ok();
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
