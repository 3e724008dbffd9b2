// A long evaluation polls a Cancellation; whoever wants it to end sets it, or its deadline passes.
#ifndef DOCENT_KB_SERVER_BASE_CANCELLATION_H_
#define DOCENT_KB_SERVER_BASE_CANCELLATION_H_

#include <atomic>
#include <chrono>
#include <string>

#include "absl/status/status.h"

namespace docent {

// `Cancel` may be called from any thread; `Check` from the evaluating one.
class Cancellation {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;

  Cancellation() = default;
  explicit Cancellation(std::chrono::milliseconds timeout)
      : deadline_(std::chrono::steady_clock::now() + timeout), timeout_(timeout) {}
  Cancellation(const Cancellation&) = delete;
  Cancellation& operator=(const Cancellation&) = delete;

  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }

  // OK; CANCELLED; or DEADLINE_EXCEEDED naming the timeout. Reads the steady clock at every 1024th call, so
  // it may stand in an inner loop.
  absl::Status Check() {
    const bool ended = cancelled_.load(std::memory_order_relaxed) || expired_;
    return ended || (++polls_ & 1023) == 0 ? CheckNow() : absl::OkStatus();
  }
  // The same, reading the clock at once.
  absl::Status CheckNow() {
    if (cancelled_.load(std::memory_order_relaxed)) return absl::CancelledError("the caller went away");
    if (timeout_.count() == 0 || (!expired_ && std::chrono::steady_clock::now() < deadline_)) return absl::OkStatus();
    expired_ = true;
    return Expired();
  }
  // Whether half of the time is over: who can give a part of the answer stops then.
  bool HalfIsOver() const {
    return timeout_.count() != 0 && std::chrono::steady_clock::now() + timeout_ / 2 > deadline_;
  }

 private:
  absl::Status Expired() const {
    return absl::DeadlineExceededError("evaluation stopped at its limit query_timeout_ms = " +
                                       std::to_string(timeout_.count()));
  }

  std::atomic<bool> cancelled_{false};
  SteadyTime deadline_;
  std::chrono::milliseconds timeout_{0};  // 0: none
  unsigned polls_ = 0;
  bool expired_ = false;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_BASE_CANCELLATION_H_
