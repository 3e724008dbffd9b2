#include "kb_server/door/worker_pool.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace docent {

namespace {

constexpr absl::Duration kLookAtQueue = absl::Milliseconds(20);

}  // namespace

WorkerPool::WorkerPool(int running, int open, size_t queue_limit)
    : running_limit_(running), open_limit_(static_cast<size_t>(open)), queue_limit_(queue_limit) {}

WorkerPool::~WorkerPool() {
  while (true) {
    std::vector<std::thread> threads;
    {
      absl::MutexLock lock(&mutex_);
      closed_ = true;
      threads.swap(threads_);  // those that end may start others for what is still queued
      if (watch_.joinable()) threads.push_back(std::move(watch_));
    }
    if (threads.empty()) return;
    for (std::thread& thread : threads) thread.join();
  }
}

bool WorkerPool::Submit(std::function<void()> work, Patience patience) {
  absl::MutexLock lock(&mutex_);
  if (closed_ || queue_.size() >= queue_limit_) return false;
  if (patience.over && !watch_.joinable()) watch_ = std::thread([this] { WatchQueue(); });
  queue_.push_back({std::move(work), std::move(patience)});
  StartThreadIfNeeded();
  return true;
}

void WorkerPool::WatchQueue() {
  while (true) {
    std::vector<Queued> late;  // with the work that never began, which may be large
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(this, &WorkerPool::ClosedOrWaited));
      if (closed_) return;  // what is queued still runs
      mutex_.AwaitWithTimeout(absl::Condition(&closed_), kLookAtQueue);
      late = TakeLate();
    }
    for (const Queued& queued : late) queued.patience.over();
  }
}

std::vector<WorkerPool::Queued> WorkerPool::TakeLate() {
  std::vector<Queued> late;
  const absl::Time now = absl::Now();
  std::erase_if(queue_, [&](Queued& queued) {
    if (queued.patience.until > now || !queued.patience.over) return false;
    late.push_back(std::move(queued));
    return true;
  });
  return late;
}

WorkerPool::Waiting::Waiting(WorkerPool* pool) : pool_(*pool) {
  absl::MutexLock lock(&pool_.mutex_);
  --pool_.running_;
  pool_.StartThreadIfNeeded();
}

WorkerPool::Waiting::~Waiting() {
  absl::MutexLock lock(&pool_.mutex_);
  pool_.mutex_.Await(absl::Condition(&pool_, &WorkerPool::HasPlace));
  ++pool_.running_;
}

void WorkerPool::StartThreadIfNeeded() {
  if (!CanBegin() || idle_ > 0 || threads_.size() >= open_limit_) return;
  ++idle_;  // it is on its way
  threads_.emplace_back([this] { Run(); });
}

void WorkerPool::Run() {
  while (std::function<void()> work = Take()) {
    work();
    work = nullptr;  // what it holds goes before its place is free
    absl::MutexLock lock(&mutex_);
    --running_;
    ++idle_;
  }
}

std::function<void()> WorkerPool::Take() {
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(this, &WorkerPool::CanBeginOrEnd));
  --idle_;
  if (queue_.empty()) return nullptr;
  std::function<void()> work = std::move(queue_.front().work);
  queue_.pop_front();
  ++running_;
  StartThreadIfNeeded();
  return work;
}

absl::Status NotBegun(int timeout_ms) {
  return absl::DeadlineExceededError(
      absl::StrCat("it waited for others to end until its limit query_timeout_ms = ", timeout_ms,
                   ", and was not begun; try again"));
}

}  // namespace docent
