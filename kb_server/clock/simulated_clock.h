// Clock of a simulation: its time is the one that a file says, which the simulator writes.
//
// The file holds one xsd:dateTime with a zone, such as 2026-05-12T09:00:00Z; microseconds count. It may be written over or
// replaced at any time. A file that is away, empty or half written leaves the time as it is, and so does an earlier time: the
// clock never goes back. Between two writings time stands still. Any thread.
#ifndef DOCENT_KB_SERVER_CLOCK_SIMULATED_CLOCK_H_
#define DOCENT_KB_SERVER_CLOCK_SIMULATED_CLOCK_H_

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/clock.h"

namespace docent::server {

class SimulatedClock final : public Clock {
 public:
  // The file has to say a time now: NOT_FOUND, INVALID_ARGUMENT. After that a thread of its own reads it each millisecond.
  static absl::StatusOr<std::unique_ptr<SimulatedClock>> Open(const std::string& path);
  ~SimulatedClock() override;

  TimeMicros Now() const override { return now_.Now(); }
  // `moved` is called after each change of the time, from the clock's thread, and at once. Null: no longer; it does not run
  // any more when this returns.
  void OnMove(std::function<void()> moved);

 private:
  SimulatedClock(std::string path, TimeMicros now_us) : path_(std::move(path)), now_(now_us) {}
  void Run();
  void Look();

  const std::string path_;
  ManualClock now_;
  std::string fault_;  // what was last wrong with the file; the thread's own
  absl::Mutex mutex_;
  std::function<void()> moved_ ABSL_GUARDED_BY(mutex_);
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLOCK_SIMULATED_CLOCK_H_
