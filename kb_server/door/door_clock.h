// The server's clock: its times never jump within a life of the process, and never go back over a restart.
//
// It is the wall clock of the start, and steady time since, moved on where the log has later times already. Turns are
// stamped with it, and every duration is counted with it: lasting conditions, timeouts, leases, lifetimes, deadlines. A wall
// clock that is set moves none of them. Any thread.
#ifndef DOCENT_KB_SERVER_DOOR_DOOR_CLOCK_H_
#define DOCENT_KB_SERVER_DOOR_DOOR_CLOCK_H_

#include <algorithm>
#include <atomic>

#include "graph/base/clock.h"
#include "graph/base/steady_clock.h"

namespace docent::server {

class DoorClock final : public Clock {
 public:
  // `source`: a clock that a test moves; null: steady time from now on. It must outlive this.
  explicit DoorClock(const Clock* source = nullptr) : source_(source != nullptr ? *source : steady_) {}

  TimeMicros Now() const override { return source_.Now() + ahead_us_.load(); }
  // Now() is at least `time_us`, and goes on from there. Before others read the clock.
  void NotBefore(TimeMicros time_us) { ahead_us_ += std::max<TimeMicros>(0, time_us - Now()); }

 private:
  const SteadyClock steady_;
  const Clock& source_;
  std::atomic<TimeMicros> ahead_us_ = 0;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_DOOR_CLOCK_H_
