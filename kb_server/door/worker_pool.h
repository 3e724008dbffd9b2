// A few threads for work that may take long (queries, parsing), so that network threads never wait for it.
//
// At most `running` pieces of work run at the same time. One that waits for something else than the processor
// (a client that reads slowly, a revision that is not here yet) says so with a `Waiting`, and the next one
// runs meanwhile: so a few slow clients stop nobody. `open` bounds the pieces that are begun and not ended,
// each of which holds a thread; `queue_limit` those that are not begun: Submit refuses instead of growing.
// Who asked for a piece of work may say until when it has to begin. The destructor finishes what is queued. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_
#define DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_

#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace docent {

// When a piece of work has to begin, and what is called instead, on a thread of the pool's, when it did not.
struct Patience {
  absl::Time until = absl::InfiniteFuture();
  std::function<void()> over;
};

class WorkerPool {
 public:
  WorkerPool(int running, int open, size_t queue_limit);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // False: the queue is full; neither `work` nor `patience.over` will run.
  bool Submit(std::function<void()> work, Patience patience = {});

  // On the stack of a piece of work while it waits. It goes on when a place is free again.
  class Waiting {
   public:
    explicit Waiting(WorkerPool* pool);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

   private:
    WorkerPool& pool_;
  };

 private:
  struct Queued {
    std::function<void()> work;
    Patience patience;
  };

  void Run();
  // The next piece of work, when there is a place for it; null: the pool ends.
  std::function<void()> Take();
  // Ends the waiting of those whose patience is over.
  void WatchQueue();
  std::vector<Queued> TakeLate() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool ClosedOrWaited() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return closed_ || !queue_.empty(); }
  // Threads are started when they are first needed.
  void StartThreadIfNeeded() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool HasPlace() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return running_ < running_limit_; }
  bool CanBegin() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return HasPlace() && !queue_.empty(); }
  bool CanBeginOrEnd() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return CanBegin() || (closed_ && queue_.empty());
  }

  const int running_limit_;
  const size_t open_limit_;
  const size_t queue_limit_;
  absl::Mutex mutex_;
  std::deque<Queued> queue_ ABSL_GUARDED_BY(mutex_);
  int running_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t idle_ ABSL_GUARDED_BY(mutex_) = 0;  // threads without work
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_ ABSL_GUARDED_BY(mutex_);
  std::thread watch_ ABSL_GUARDED_BY(mutex_);
};

// DEADLINE_EXCEEDED: what is said of work whose patience is over.
absl::Status NotBegun(int timeout_ms);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_
