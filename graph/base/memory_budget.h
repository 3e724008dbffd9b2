// Memory accounting: a limit for each task (MemoryUse) and one for all tasks together (MemoryBudget).
#ifndef DOCENT_GRAPH_BASE_MEMORY_BUDGET_H_
#define DOCENT_GRAPH_BASE_MEMORY_BUDGET_H_

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "graph/base/overload.h"

namespace docent {

// Memory that several tasks hold together, on any threads. Thread-safe.
class MemoryBudget {
 public:
  // `limit_name`: as in Limits.
  MemoryBudget(std::string_view limit_name, size_t limit) : limit_name_(limit_name), limit_(limit) {}

  // Reserves `bytes`. False, and nothing is reserved, if that exceeds the limit.
  bool Take(size_t bytes) {
    size_t taken = taken_.load(std::memory_order_relaxed);
    do {
      if (bytes > limit_ || taken > limit_ - bytes) return false;
    } while (!taken_.compare_exchange_weak(taken, taken + bytes, std::memory_order_relaxed));
    return true;
  }
  void Give(size_t bytes) { taken_.fetch_sub(bytes, std::memory_order_relaxed); }
  bool HasRoom(size_t bytes) const { return bytes <= limit_ && taken() <= limit_ - bytes; }
  size_t taken() const { return taken_.load(std::memory_order_relaxed); }

  // Overload error: the tasks together hold too much at the moment.
  absl::Status Refusal() const {
    return OverloadError("too much is in work at the same time: the limit " + limit_name_ + " = " +
                         std::to_string(limit_) + " is reached; try again later");
  }

 private:
  const std::string limit_name_;
  const size_t limit_;
  std::atomic<size_t> taken_{0};
};

// Memory that one task holds. One thread.
class MemoryUse {
 public:
  // `all` counts the part beyond kFree; null: no shared budget. `all` must outlive this object.
  explicit MemoryUse(size_t limit, MemoryBudget* all = nullptr)
      : limit_(limit), all_(all), granted_(all == nullptr ? limit : std::min(limit, kFree)) {}
  ~MemoryUse() { GiveBack(taken_); }
  MemoryUse(const MemoryUse&) = delete;
  MemoryUse& operator=(const MemoryUse&) = delete;

  // Counts `bytes`. False if that exceeds one of the limits; the bytes are counted all the same.
  bool Add(size_t bytes) {
    used_ += bytes;
    return used_ <= granted_ || Extend();
  }
  void Release(size_t bytes) {
    used_ -= bytes;
    if (taken_ != 0 && granted_ > used_ + kSlack) GiveBack(granted_ - used_ - kStep);
  }
  // True if `bytes` more would fit now.
  bool HasRoom(size_t bytes) const {
    if (bytes > limit_ || used_ > limit_ - bytes) return false;
    return used_ + bytes <= granted_ || all_->HasRoom(used_ + bytes - granted_);
  }
  // Gives back what is reserved and not used.
  void Settle() {
    if (granted_ > used_) GiveBack(granted_ - used_);
  }
  // True if `bytes` more would leave half of the memory free: for caches.
  bool MayKeep(size_t bytes) const {
    if (bytes >= limit_ / 2 || used_ + bytes >= limit_ / 2) return false;
    return used_ + bytes <= granted_ || all_->HasRoom(2 * bytes);
  }
  size_t used() const { return used_; }

  // The error after a false Add or HasRoom(`more`): `own` for this task's limit, else the budget's.
  absl::Status Refusal(absl::Status own, size_t more = 0) const {
    return more > limit_ || used_ > limit_ - more ? std::move(own) : all_->Refusal();
  }

 private:
  static constexpr size_t kFree = 256u << 10;
  static constexpr size_t kStep = 1u << 20;   // reserved at once
  static constexpr size_t kSlack = 8u << 20;  // reserved and unused, before some is given back

  bool Extend() {
    if (used_ > limit_) return false;
    const size_t least = used_ - granted_;
    size_t more = std::min(std::max(least, std::max(kStep, granted_ / 4)), limit_ - granted_);
    if (!all_->Take(more)) {
      more = least;
      if (!all_->Take(more)) return false;
    }
    granted_ += more;
    taken_ += more;
    return true;
  }
  void GiveBack(size_t bytes) {
    bytes = std::min(bytes, taken_);
    if (bytes == 0) return;
    all_->Give(bytes);
    granted_ -= bytes;
    taken_ -= bytes;
  }

  const size_t limit_;
  MemoryBudget* const all_;
  size_t granted_;    // usable without a further reservation
  size_t taken_ = 0;  // reserved from `all_`
  size_t used_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_MEMORY_BUDGET_H_
