// Who follows the standing queries, when they are woken, and when nobody is left.
#include <algorithm>
#include <memory>
#include <vector>

#include "absl/time/clock.h"
#include "kb_server/service/standing_query.h"
#include "kb_server/service/subscriptions.h"

namespace docent {
namespace {

constexpr absl::Duration kLinger = absl::Seconds(60);  // a query that nobody follows is kept for so long
constexpr size_t kIdleKept = 1000;                     // and so many of them

}  // namespace

void Subscriptions::Close(const std::shared_ptr<Follower>& follower) {
  absl::MutexLock lock(&followers_mutex_);
  const auto found = followers_.find(follower);
  if (found == followers_.end()) return;
  by_standing_[found->second].erase(follower);
  followers_.erase(found);
  counters_.open = followers_.size();
}

void Subscriptions::WakeAt(absl::Time time, std::weak_ptr<Follower> follower) {
  absl::MutexLock lock(&mutex_);
  alarms_.emplace(time, std::move(follower));
}

void Subscriptions::Changed(const Standing& standing) {
  ++counters_.changes;
  if (changed_.empty()) changed_since_ = absl::Now();
  changed_.push_back(standing.number);
}

void Subscriptions::WakeFollowers() {
  if (changed_.empty()) return;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  absl::MutexLock lock(&followers_mutex_);
  const auto for_each = [this](void (Follower::*call)()) ABSL_EXCLUSIVE_LOCKS_REQUIRED(followers_mutex_) {
    for (const uint32_t number : changed_) {
      const auto found = by_standing_.find(number);
      if (found == by_standing_.end()) continue;
      for (const auto& follower : found->second) ((*follower).*call)();
    }
  };
  for_each(&Follower::Wake);
  for_each(&Follower::AllWoken);
  changed_.clear();
}

void Subscriptions::WakeDue(const std::vector<std::weak_ptr<Follower>>& due) {
  std::vector<std::shared_ptr<Follower>> alive;
  absl::MutexLock lock(&followers_mutex_);
  for (const std::weak_ptr<Follower>& follower : due) {
    std::shared_ptr<Follower> locked = follower.lock();
    if (locked != nullptr && followers_.contains(locked)) alive.push_back(std::move(locked));
  }
  for (const auto& follower : alive) follower->Wake();
  for (const auto& follower : alive) follower->AllWoken();
}

// The query cannot be followed any more.
void Subscriptions::FailAll(Standing& standing, const absl::Status& status) {
  {
    absl::MutexLock lock(&followers_mutex_);
    for (const auto& follower : by_standing_[standing.number]) {
      followers_.erase(follower);
      follower->Fail(status);
    }
    by_standing_.erase(standing.number);
    counters_.open = followers_.size();
  }
  Drop(standing.number);
}

void Subscriptions::DropIdle() {
  const absl::Time now = absl::Now();
  if (now < next_idle_check_) return;
  next_idle_check_ = now + absl::Seconds(1);
  std::vector<uint32_t> drop;
  size_t idle = 0;
  {
    absl::MutexLock lock(&followers_mutex_);
    for (auto it = by_standing_.begin(); it != by_standing_.end();) {
      Standing* standing = standing_[it->first].get();
      if (!it->second.empty() || standing == nullptr) {
        ++it;
        continue;
      }
      if (standing->idle_since == absl::InfiniteFuture()) standing->idle_since = now;
      if (++idle > kIdleKept || now - standing->idle_since > kLinger) {
        drop.push_back(it->first);
        by_standing_.erase(it++);
      } else {
        ++it;
      }
    }
  }
  for (uint32_t number : drop) Drop(number);
}

}  // namespace docent
