#include "kb_server/service/worker_pool.h"

#include <utility>

namespace docent {

WorkerPool::WorkerPool(int running, int open, size_t queue_limit)
    : running_limit_(running), open_limit_(static_cast<size_t>(open)), queue_limit_(queue_limit) {}

WorkerPool::~WorkerPool() {
  while (true) {
    std::vector<std::thread> threads;
    {
      absl::MutexLock lock(&mutex_);
      closed_ = true;
      threads.swap(threads_);  // those that end may start others for what is still queued
    }
    if (threads.empty()) return;
    for (std::thread& thread : threads) thread.join();
  }
}

bool WorkerPool::Submit(std::function<void()> work) {
  absl::MutexLock lock(&mutex_);
  if (closed_ || queue_.size() >= queue_limit_) return false;
  queue_.push_back(std::move(work));
  StartThreadIfNeeded();
  return true;
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
  std::function<void()> work = std::move(queue_.front());
  queue_.pop_front();
  ++running_;
  StartThreadIfNeeded();
  return work;
}

}  // namespace docent
