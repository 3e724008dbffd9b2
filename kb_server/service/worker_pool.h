// A few threads for work that may take long (queries, parsing), so that network threads never wait for it.
//
// The queue is bounded: Submit refuses instead of growing. The destructor finishes what is queued.
// Thread-safe.
#ifndef DOCENT_KB_SERVER_SERVICE_WORKER_POOL_H_
#define DOCENT_KB_SERVER_SERVICE_WORKER_POOL_H_

#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "absl/synchronization/mutex.h"

namespace docent {

class WorkerPool {
 public:
  WorkerPool(int threads, size_t queue_limit);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // False: the queue is full; `work` will not run.
  bool Submit(std::function<void()> work);

 private:
  void Run();
  bool HasWorkOrClosed() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return closed_ || !queue_.empty(); }

  const size_t queue_limit_;
  absl::Mutex mutex_;
  std::deque<std::function<void()>> queue_ ABSL_GUARDED_BY(mutex_);
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_WORKER_POOL_H_
