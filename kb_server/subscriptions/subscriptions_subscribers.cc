// Who follows the subscribed queries, when they are woken, and when nobody is left.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"
#include "kb_server/subscriptions/subscribed_query.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLinger = absl::Seconds(60);  // a query that nobody follows is kept for so long
constexpr size_t kIdleKept = 1000;                     // and so many of them
constexpr size_t kIdlePart = 8;                        // of subscriptions_bytes, one in so many
constexpr size_t kTimesFree = 3;                       // a client may have so many times what is free of all
constexpr size_t kKeptRowBytes = 200;                  // of a row in a StandingConditions, about

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
  if (subscription.idle_since != absl::InfiniteFuture()) {
    idle_.erase({subscription.idle_since, subscription.number});
    idle_bytes_ -= subscription.charged;
  }
  if (since != absl::InfiniteFuture()) {
    idle_.emplace(since, subscription.number);
    idle_bytes_ += subscription.charged;
  }
  subscription.idle_since = since;
}

void Subscriptions::SetCharged(Subscription& subscription, size_t bytes) {
  const size_t had = std::exchange(subscription.charged, bytes);
  size_t& of_client = charged_[subscription.payer];
  of_client += bytes - had;
  if (of_client == 0) charged_.erase(subscription.payer);
  counters_.bytes += bytes - had;
  if (subscription.idle_since != absl::InfiniteFuture()) idle_bytes_ += bytes - had;
}

bool Subscriptions::HasRoomFor(const Client* client, size_t bytes) const {
  const size_t limit = settings_.subscription_limits.subscriptions_bytes, taken = this->bytes();
  if (taken + bytes > limit) return false;
  if (client == nullptr) return true;
  const auto found = charged_.find(client);
  const size_t has = found == charged_.end() ? 0 : found->second;
  return has + bytes <= kTimesFree * (limit - taken - bytes);
}

absl::Status Subscriptions::Charge(Subscription& subscription) {
  const size_t bytes = subscription.query_bytes + subscription.answer->bytes() +
                       (subscription.kept ? subscription.answer->size() * kKeptRowBytes : 0);
  if (bytes > subscription.charged) {
    const size_t more = bytes - subscription.charged;
    while (!HasRoomFor(subscription.payer, more)) {
      const auto oldest = std::find_if(idle_.begin(), idle_.end(),
                                       [&](const auto& idle) { return idle.second != subscription.number; });
      if (oldest == idle_.end()) {
        return OverloadError(
            absl::StrCat("what is followed is too much together: the limit subscriptions_bytes is ",
                         settings_.subscription_limits.subscriptions_bytes,
                         ", and this would hold a large part of it; ask for less, or try again later"));
      }
      Drop(oldest->second);
    }
  }
  SetCharged(subscription, bytes);
  return absl::OkStatus();
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
  const size_t most = settings_.subscription_limits.subscriptions_bytes / kIdlePart;
  while (!idle_.empty() &&
         (idle_.size() > kIdleKept || idle_bytes_ > most || now - idle_.begin()->first > kLinger)) {
    Drop(idle_.begin()->second);
  }
}

}  // namespace docent::server
