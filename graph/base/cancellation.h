// Stop signal that a long evaluation polls: cancelled, past its deadline, or out of steps. A step is one row
// that a join looks at; unlike time, the number of steps hardly depends on the machine.
#ifndef DOCENT_GRAPH_BASE_CANCELLATION_H_
#define DOCENT_GRAPH_BASE_CANCELLATION_H_

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "absl/status/status.h"

namespace docent {

// `Cancel` may be called from any thread, all other functions only from the evaluating thread.
class Cancellation {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;

  Cancellation() = default;
  explicit Cancellation(std::chrono::milliseconds timeout)
      : deadline_(std::chrono::steady_clock::now() + timeout), timeout_(timeout) {}
  Cancellation(const Cancellation&) = delete;
  Cancellation& operator=(const Cancellation&) = delete;

  // `look` runs whenever the clock is read: the query scheduler shares processors by it. Null: none.
  void OnLook(std::function<void(const Cancellation&)> look) { look_ = std::move(look); }

  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }

  // Allows this many steps (limits steps_per_turn, steps_per_fact). Without this call: no limit.
  void AllowSteps(uint64_t steps) {
    steps_ = static_cast<int64_t>(steps);
    steps_left_ = steps_;
  }
  // Counts `steps` as done. The next Check reports an error if they were too many.
  void Spend(uint64_t steps) { steps_left_ -= static_cast<int64_t>(steps); }

  bool CanSpend(uint64_t steps) const { return steps_left_ >= static_cast<int64_t>(steps); }
  int64_t steps_left() const { return steps_left_; }
  // Allows `steps` more steps.
  void Lend(uint64_t steps) {
    if (steps_ != 0) steps_left_ += static_cast<int64_t>(steps);
  }

  // OK; CANCELLED; DEADLINE_EXCEEDED naming the timeout; or RESOURCE_EXHAUSTED naming the limit of steps.
  // Reads the steady clock only at every 1024th call, so an inner loop may call it.
  absl::Status Check() {
    const bool ended = cancelled_.load(std::memory_order_relaxed) || expired_ || steps_left_ < 0;
    return ended || (++polls_ & 1023) == 0 ? CheckNow() : absl::OkStatus();
  }
  // The same, but reads the clock at each call.
  absl::Status CheckNow() {
    if (look_) look_(*this);
    if (cancelled_.load(std::memory_order_relaxed)) return absl::CancelledError("the caller went away");
    if (steps_left_ < 0) return TooManySteps();
    if (timeout_.count() == 0 || (!expired_ && std::chrono::steady_clock::now() < deadline_))
      return absl::OkStatus();
    expired_ = true;
    return Expired();
  }
  // True if it was cancelled or the deadline has passed.
  bool IsOver() const {
    return cancelled_.load(std::memory_order_relaxed) ||
           (timeout_.count() != 0 && std::chrono::steady_clock::now() >= deadline_);
  }
  // Time until the deadline; a year if there is no deadline.
  std::chrono::milliseconds Left() const {
    if (timeout_.count() == 0) return std::chrono::hours(24 * 365);
    return std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ -
                                                                 std::chrono::steady_clock::now());
  }
  // True if half of the time is over. An evaluation that can return a partial answer stops then.
  bool HalfIsOver() const {
    return timeout_.count() != 0 && std::chrono::steady_clock::now() + timeout_ / 2 > deadline_;
  }

 private:
  absl::Status TooManySteps() const {
    return absl::ResourceExhaustedError(
        "evaluation stopped after " + std::to_string(steps_) +
        " steps, what the limits steps_per_turn and steps_per_fact allow; does much follow from few facts (a "
        "long "
        "chain of a transitive property, a large class of equal things), or does it join patterns that share "
        "no variable?");
  }
  absl::Status Expired() const {
    return absl::DeadlineExceededError("evaluation stopped at its limit query_timeout_ms = " +
                                       std::to_string(timeout_.count()));
  }

  std::atomic<bool> cancelled_{false};
  SteadyTime deadline_;
  std::chrono::milliseconds timeout_{0};  // 0: none
  int64_t steps_ = 0;                     // allowed; 0: any number
  int64_t steps_left_ = std::numeric_limits<int64_t>::max();
  unsigned polls_ = 0;
  bool expired_ = false;
  std::function<void(const Cancellation&)> look_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_CANCELLATION_H_
