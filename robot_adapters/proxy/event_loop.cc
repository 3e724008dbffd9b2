#include "robot_adapters/proxy/event_loop.h"

#include <chrono>
#include <utility>

namespace docent::proxy {
namespace {

// Steady, so that a step of the system's clock moves no timer.
absl::Time SteadyNow() {
  return absl::UnixEpoch() + absl::FromChrono(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace

EventLoop::EventLoop() : thread_([this] { Run(); }) {}

EventLoop::~EventLoop() {
  {
    absl::MutexLock lock(&mutex_);
    ending_ = true;
  }
  thread_.join();
}

void EventLoop::Post(std::function<void()> task) {
  absl::MutexLock lock(&mutex_);
  tasks_.push_back(std::move(task));
}

EventLoop::Timer EventLoop::PostAfter(absl::Duration delay, std::function<void()> task) {
  const Timer timer(SteadyNow() + delay, ++last_timer_);
  timers_.emplace(timer, std::move(task));
  return timer;
}

void EventLoop::Run() {
  auto has_task = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return ending_ || !tasks_.empty(); };
  while (true) {
    std::function<void()> task;
    {
      absl::MutexLock lock(&mutex_);
      absl::Duration wait =
          timers_.empty() ? absl::InfiniteDuration() : timers_.begin()->first.first - SteadyNow();
      mutex_.AwaitWithTimeout(absl::Condition(&has_task), wait);
      if (!tasks_.empty()) {
        task = std::move(tasks_.front());
        tasks_.pop_front();
      } else if (ending_) {
        return;
      }
    }
    if (!task && !timers_.empty() && timers_.begin()->first.first <= SteadyNow()) {
      task = std::move(timers_.begin()->second);
      timers_.erase(timers_.begin());
    }
    if (task) task();
  }
}

}  // namespace docent::proxy
