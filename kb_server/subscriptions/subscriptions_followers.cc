// Who follows the standing queries, when they are woken, and when nobody is left.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "kb_server/subscriptions/standing_query.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent {
namespace {

constexpr absl::Duration kLinger = absl::Seconds(60);  // a query that nobody follows is kept for so long
constexpr size_t kIdleKept = 1000;                     // and so many of them

}  // namespace

void Subscriptions::Close(const std::shared_ptr<Follower>& follower) {
  absl::MutexLock lock(&followers_mutex_);
  const auto found = followers_.find(follower);
  if (found == followers_.end()) return;
  const auto [number, index] = found->second;
  followers_.erase(found);
  std::vector<std::shared_ptr<Follower>>& others = followed_by_[number];
  if (index + 1 < others.size()) {
    others[index] = std::move(others.back());
    followers_.at(others[index]).index = index;
  }
  others.pop_back();
  if (others.empty()) left_.push_back(number);
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
      for (const auto& follower : followed_by_[number]) ((*follower).*call)();
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
    for (const auto& follower : std::exchange(followed_by_[standing.number], {})) {
      followers_.erase(follower);
      follower->Fail(status);
    }
    counters_.open = followers_.size();
  }
  Drop(standing.number);
}

void Subscriptions::NoteIdle(Standing& standing, absl::Time since) {
  if (standing.idle_since != absl::InfiniteFuture()) idle_.erase({standing.idle_since, standing.number});
  if (since != absl::InfiniteFuture()) idle_.emplace(since, standing.number);
  standing.idle_since = since;
}

void Subscriptions::DropIdle() {
  const absl::Time now = absl::Now();
  if (now < next_idle_check_) return;
  next_idle_check_ = now + absl::Seconds(1);
  {
    absl::MutexLock lock(&followers_mutex_);
    for (const uint32_t number : std::exchange(left_, {})) {
      Standing* const standing = standing_[number].get();
      if (standing != nullptr && followed_by_[number].empty() &&
          standing->idle_since == absl::InfiniteFuture())
        NoteIdle(*standing, now);
    }
  }
  while (!idle_.empty() && (idle_.size() > kIdleKept || now - idle_.begin()->first > kLinger)) {
    Drop(idle_.begin()->second);
  }
}

}  // namespace docent
