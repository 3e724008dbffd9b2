// Clock that cannot be set: the wall clock's time when it was made, and steady time since.
//
// A step of the wall clock in either direction moves nothing that is counted with it. After a long life it may differ from
// the wall clock by what that was set meanwhile.
#ifndef DOCENT_GRAPH_BASE_STEADY_CLOCK_H_
#define DOCENT_GRAPH_BASE_STEADY_CLOCK_H_

#include <chrono>

#include "graph/base/clock.h"

namespace docent {

class SteadyClock final : public Clock {
 public:
  // `wall`: tells the time of the beginning.
  explicit SteadyClock(const Clock& wall = SystemClock()) : began_us_(wall.Now()) {}
  TimeMicros Now() const override {
    return began_us_ +
           std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - began_)
               .count();
  }

 private:
  const TimeMicros began_us_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_STEADY_CLOCK_H_
