// One thread that runs tasks in order and timers when they are due. What only this thread touches needs no
// lock.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_EVENT_LOOP_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_EVENT_LOOP_H_

#include <deque>
#include <functional>
#include <map>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace docent {

class EventLoop {
 public:
  EventLoop();
  // Runs the tasks that are queued, but no more timers, and ends the thread.
  ~EventLoop();

  // Any thread. After the destructor has begun, tasks may only be posted by tasks.
  void Post(std::function<void()> task);
  // Runs `task` on the loop's thread after `delay`. Loop thread only; there is no way to take it back, so a
  // task looks whether it still matters.
  void PostAfter(absl::Duration delay, std::function<void()> task);

 private:
  void Run();

  absl::Mutex mutex_;
  std::deque<std::function<void()>> tasks_ ABSL_GUARDED_BY(mutex_);
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  std::multimap<absl::Time, std::function<void()>> timers_;  // loop thread only
  std::thread thread_;
};

}  // namespace docent

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_EVENT_LOOP_H_
