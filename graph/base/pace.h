// Throttle for long background work: the work takes at most a third of a core. nice(2) is not enough, since
// priorities count only among the threads of one core.
#ifndef DOCENT_GRAPH_BASE_PACE_H_
#define DOCENT_GRAPH_BASE_PACE_H_

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

namespace docent {

class Pace {
 public:
  // The working thread calls Rest between two small pieces of work of about a microsecond. After about a
  // millisecond of work Rest sleeps twice as long as the work took, at most 10 ms.
  void Rest() {
    if (++pieces_ % kPiecesALook != 0 || hurry_) return;
    const Clock::duration worked = Clock::now() - since_;
    if (worked < std::chrono::milliseconds(1)) return;
    std::this_thread::sleep_for(std::min<Clock::duration>(2 * worked, std::chrono::milliseconds(10)));
    since_ = Clock::now();
  }
  // No further rests: another thread waits for the result. Any thread.
  void Hurry() { hurry_ = true; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr uint32_t kPiecesALook = 256;
  std::atomic<bool> hurry_{false};
  uint32_t pieces_ = 0;
  Clock::time_point since_ = Clock::now();
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_PACE_H_
