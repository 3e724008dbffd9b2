// Time as a parameter: nothing below the composition root reads the wall clock, so a run can be replayed.
#ifndef DOCENT_GRAPH_BASE_CLOCK_H_
#define DOCENT_GRAPH_BASE_CLOCK_H_

#include <atomic>
#include <chrono>
#include <cstdint>

namespace docent {

// Microseconds since 1970-01-01T00:00:00Z, without leap seconds.
using TimeMicros = int64_t;

// Any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual TimeMicros Now() const = 0;
};

class SystemClock final : public Clock {
 public:
  TimeMicros Now() const override {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  }
};

// A clock that a test moves.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(TimeMicros now = 0) : now_(now) {}
  TimeMicros Now() const override { return now_.load(); }
  void Set(TimeMicros now) { now_.store(now); }
  void Advance(std::chrono::microseconds by) { now_.fetch_add(by.count()); }

 private:
  std::atomic<TimeMicros> now_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_CLOCK_H_
