// Throttle for long background work: it takes a third of a core at most. nice(2) is not enough,
// since priorities count only among the threads of one core.
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
  // The thread that works calls it between two small pieces, of a microsecond or so; after about a millisecond of them it
  // sleeps twice as long.
  void Rest() {
    if (++pieces_ % kPiecesALook != 0 || hurry_) return;
    const Clock::duration worked = Clock::now() - since_;
    if (worked < std::chrono::milliseconds(1)) return;
    std::this_thread::sleep_for(std::min<Clock::duration>(2 * worked, std::chrono::milliseconds(10)));
    since_ = Clock::now();
  }
  // Somebody waits after all: no rest from now on. Any thread.
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
