#include "kb_server/door/send_budget.h"

#include <pthread.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace docent::server {

SendBudget::SendBudget(size_t limit) : limit_(limit) {
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "send-budget");
    Loop();
  });
}

SendBudget::~SendBudget() {
  {
    absl::MutexLock lock(&mutex_);
    ending_ = true;
  }
  thread_.join();
}

SendBudget::Share::Share(SendBudget* budget, std::function<void(const absl::Status&)> cut)
    : budget_(budget), cut_(std::move(cut)) {
  if (budget_ == nullptr) return;
  absl::MutexLock lock(&budget_->mutex_);
  id_ = ++budget_->last_id_;
  budget_->shares_.emplace(id_, this);
}

SendBudget::Share::~Share() {
  if (budget_ == nullptr) return;
  Release(bytes_);
  const auto is_free = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return budget_->cutting_ != this; };
  absl::MutexLock lock(&budget_->mutex_);
  budget_->shares_.erase(id_);
  budget_->mutex_.Await(absl::Condition(&is_free));
}

void SendBudget::Share::Add(size_t bytes) {
  if (budget_ == nullptr || bytes == 0) return;
  if (bytes_.fetch_add(bytes, std::memory_order_relaxed) == 0) since_ = absl::GetCurrentTimeNanos();
  const size_t all = budget_->taken_.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  if (all <= budget_->limit_ || budget_->beyond_.exchange(true)) return;
  absl::MutexLock lock(&budget_->mutex_);  // so that the thread looks
}

void SendBudget::Share::Release(size_t bytes) {
  if (budget_ == nullptr || bytes == 0) return;
  bytes_.fetch_sub(bytes, std::memory_order_relaxed);
  budget_->taken_.fetch_sub(bytes, std::memory_order_relaxed);
  since_ = absl::GetCurrentTimeNanos();
}

std::vector<uint64_t> SendBudget::Choose() {
  std::vector<std::tuple<size_t, int64_t, uint64_t>> all;
  size_t held = 0;  // by those that are not cut
  for (const auto& [id, share] : shares_) {
    const size_t bytes = share->bytes_.load(std::memory_order_relaxed);
    if (bytes == 0 || share->is_cut_) continue;
    all.emplace_back(bytes, -share->since_.load(std::memory_order_relaxed), id);
    held += bytes;
  }
  std::sort(all.begin(), all.end(), std::greater<>());
  std::vector<uint64_t> chosen;
  for (const auto& [bytes, since, id] : all) {
    if (held <= limit_ - limit_ / 8) break;
    chosen.push_back(id);
    held -= bytes;
  }
  return chosen;
}

void SendBudget::Loop() {
  const absl::Status reason = absl::ResourceExhaustedError(absl::StrCat(
      "the clients of this server leave too much of what they asked for: the limit streams_bytes = ", limit_,
      " is reached, and this one holds a large part of it; read faster, or ask for less"));
  const auto work = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return beyond_ || ending_; };
  absl::MutexLock lock(&mutex_);
  while (true) {
    mutex_.Await(absl::Condition(&work));
    if (ending_) return;
    beyond_ = false;
    for (const uint64_t id : Choose()) {
      const auto found = shares_.find(id);
      if (found == shares_.end()) continue;
      Share* const share = found->second;
      share->is_cut_ = true;
      cutting_ = share;
      mutex_.Unlock();
      share->cut_(reason);
      ++cut_;
      mutex_.Lock();
      cutting_ = nullptr;
    }
  }
}

}  // namespace docent::server
