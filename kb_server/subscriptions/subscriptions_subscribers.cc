// Who follows the subscribed queries, when they are woken, and when nobody is left.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "kb_server/subscriptions/subscribed_query.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLinger = absl::Seconds(60);  // a query that nobody follows is kept for so long
constexpr size_t kIdleKept = 1000;                     // and so many of them

}  // namespace

void Subscriptions::Close(const std::shared_ptr<Subscriber>& subscriber) {
  absl::MutexLock lock(&subscribers_mutex_);
  const auto found = subscribers_.find(subscriber);
  if (found == subscribers_.end()) return;
  const auto [number, index] = found->second;
  subscribers_.erase(found);
  std::vector<std::shared_ptr<Subscriber>>& others = subscribers_of_[number];
  if (index + 1 < others.size()) {
    others[index] = std::move(others.back());
    subscribers_.at(others[index]).index = index;
  }
  others.pop_back();
  if (others.empty()) left_.push_back(number);
  counters_.open = subscribers_.size();
}

void Subscriptions::WakeAt(absl::Time time, std::weak_ptr<Subscriber> subscriber) {
  absl::MutexLock lock(&mutex_);
  alarms_.emplace(time, std::move(subscriber));
}

void Subscriptions::Changed(const Subscription& subscription) {
  ++counters_.changes;
  if (changed_.empty()) changed_since_ = absl::Now();
  changed_.push_back(subscription.number);
}

void Subscriptions::WakeSubscribers() {
  if (changed_.empty()) return;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  absl::MutexLock lock(&subscribers_mutex_);
  const auto for_each = [this](void (Subscriber::*call)()) ABSL_EXCLUSIVE_LOCKS_REQUIRED(subscribers_mutex_) {
    for (const uint32_t number : changed_) {
      for (const auto& subscriber : subscribers_of_[number]) ((*subscriber).*call)();
    }
  };
  for_each(&Subscriber::Wake);
  for_each(&Subscriber::AllWoken);
  changed_.clear();
}

void Subscriptions::WakeDue(const std::vector<std::weak_ptr<Subscriber>>& due) {
  std::vector<std::shared_ptr<Subscriber>> alive;
  absl::MutexLock lock(&subscribers_mutex_);
  for (const std::weak_ptr<Subscriber>& subscriber : due) {
    std::shared_ptr<Subscriber> locked = subscriber.lock();
    if (locked != nullptr && subscribers_.contains(locked)) alive.push_back(std::move(locked));
  }
  for (const auto& subscriber : alive) subscriber->Wake();
  for (const auto& subscriber : alive) subscriber->AllWoken();
}

// The query cannot be followed any more.
void Subscriptions::FailAll(Subscription& subscription, const absl::Status& status) {
  {
    absl::MutexLock lock(&subscribers_mutex_);
    for (const auto& subscriber : std::exchange(subscribers_of_[subscription.number], {})) {
      subscribers_.erase(subscriber);
      subscriber->Fail(status);
    }
    counters_.open = subscribers_.size();
  }
  Drop(subscription.number);
}

void Subscriptions::NoteIdle(Subscription& subscription, absl::Time since) {
  if (subscription.idle_since != absl::InfiniteFuture())
    idle_.erase({subscription.idle_since, subscription.number});
  if (since != absl::InfiniteFuture()) idle_.emplace(since, subscription.number);
  subscription.idle_since = since;
}

void Subscriptions::DropIdle() {
  const absl::Time now = absl::Now();
  if (now < next_idle_check_) return;
  next_idle_check_ = now + absl::Seconds(1);
  {
    absl::MutexLock lock(&subscribers_mutex_);
    for (const uint32_t number : std::exchange(left_, {})) {
      Subscription* const subscription = by_number_[number].get();
      if (subscription != nullptr && subscribers_of_[number].empty() &&
          subscription->idle_since == absl::InfiniteFuture())
        NoteIdle(*subscription, now);
    }
  }
  while (!idle_.empty() && (idle_.size() > kIdleKept || now - idle_.begin()->first > kLinger)) {
    Drop(idle_.begin()->second);
  }
}

}  // namespace docent::server
