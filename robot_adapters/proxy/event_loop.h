// One thread that runs tasks in order and timers when they are due. What only this thread touches needs no
// lock.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_EVENT_LOOP_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_EVENT_LOOP_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <thread>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace docent::proxy {

class EventLoop {
 public:
  EventLoop();
  // Runs the tasks that are queued, but no more timers, and ends the thread.
  ~EventLoop();

  // Any thread. After the destructor has begun, tasks may only be posted by tasks.
  void Post(std::function<void()> task);
  using Timer = std::pair<absl::Time, uint64_t>;  // when it is due, and its number
  // Runs `task` on the loop's thread after `delay`. Loop thread only, as is Cancel, which does nothing where it has run.
  Timer PostAfter(absl::Duration delay, std::function<void()> task);
  void Cancel(const Timer& timer) { timers_.erase(timer); }

 private:
  void Run();

  absl::Mutex mutex_;
  std::deque<std::function<void()>> tasks_ ABSL_GUARDED_BY(mutex_);
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  // Loop thread only.
  std::map<Timer, std::function<void()>> timers_;
  uint64_t last_timer_ = 0;
  std::thread thread_;
};

}  // namespace docent::proxy

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_EVENT_LOOP_H_
