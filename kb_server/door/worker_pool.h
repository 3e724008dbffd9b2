// Pool of threads for work that may take long (queries, parsing), so that network threads never wait for it.
//
// `running` pieces of work run at the same time, and beside them `short_running` that have just begun: each has
// `short_time` of a processor there. What takes longer goes on among the others, and waits where these are full (it is a
// SharedWork then): so short work passes long work, however much of that there is.
// Work that waits for something else than the processor (a client that reads slowly, a revision that is not here yet) says
// so with a `Waiting`, and others run meanwhile. `open` bounds the pieces that are begun and not ended, each of which holds
// a thread; `queue` those that are not begun: Submit refuses instead of growing. Where all threads are held and others wait
// for one, the client that has been waited for the longest is `Crowded` out.
// Who asked for a piece of work may say until when it has to begin. The destructor finishes what is queued. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_
#define DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_

#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"

namespace docent::server {

// When a piece of work has to begin, and what is called instead, on a thread of the pool's, when it did not.
struct Patience {
  absl::Time until = absl::InfiniteFuture();
  std::function<void()> over;
};

struct WorkerPoolLimits {
  int running = 1;
  int open = 1;
  size_t queue = 0;
  int short_running = 0;
  absl::Duration short_time = absl::ZeroDuration();
  absl::Duration crowded_time = absl::InfiniteDuration();  // a client is waited for so long at least
};

// As the server's limits say.
WorkerPoolLimits WorkerPoolLimitsOf(const Limits& limits);

class WorkerPool {
 public:
  explicit WorkerPool(const WorkerPoolLimits& limits) : limits_(limits) {}
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // RESOURCE_EXHAUSTED (an overload): the queue is full; neither `work` nor `patience.over` will run.
  absl::Status Submit(std::function<void()> work, Patience patience = {});

  // On the stack of a piece of work while it waits. It goes on when a place is free again.
  class Waiting {
   public:
    enum class What { kClient, kOther };
    explicit Waiting(WorkerPool* pool, What what = What::kOther);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

    // Of a client: true if others wait for this thread, and the client has to go.
    bool Crowded();

   private:
    WorkerPool& pool_;
  };

  // On the stack of a piece of work while it evaluates: where `cancellation` looks at the clock, the work may be held up
  // for others. It must hold nothing then that these wait for, such as a mutex.
  class SharedWork {
   public:
    SharedWork(WorkerPool* pool, Cancellation* cancellation);
    ~SharedWork() { cancellation_.OnLook(nullptr); }
    SharedWork(const SharedWork&) = delete;
    SharedWork& operator=(const SharedWork&) = delete;

   private:
    Cancellation& cancellation_;
  };

 private:
  struct Queued {
    std::function<void()> work;
    Patience patience;
    absl::Time since;
  };
  // A piece of work that is begun. On the stack of its thread.
  struct Piece {
    WorkerPool* pool = nullptr;
    bool placed = false;    // it runs
    bool is_short = false;  // its place, or the one that it had
    absl::Time begun;
    absl::Duration processor_time;  // of its thread at its begin
    absl::Time client_since = absl::InfiniteFuture();
    absl::Duration client_time = absl::ZeroDuration();  // waited for clients before
    bool crowded_out = false;
  };
  static thread_local Piece* current_;

  void Run();
  // The next piece of work, when there is a place for it; null: the pool ends.
  std::function<void()> Take(Piece* piece);
  void End(Piece* piece);
  // Ends the waiting of those whose patience is over.
  void WatchQueue();
  std::vector<Queued> TakeLate() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Short places are not held for long by work that never looks at its cancellation.
  void MoveOverdue() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void HoldUp(const Cancellation& cancellation);
  void LeavePlace(Piece* piece) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Waits in line for a place; without one where `cancellation`, if there is one, is over before.
  void AwaitPlace(Piece* piece, const Cancellation* cancellation) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool CanGoOn(const Piece* piece) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool ClosedOrWaited() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return closed_ || !queue_.empty(); }
  // Threads are started when they are first needed.
  void StartThreadIfNeeded() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool HasShortPlace() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return short_ < limits_.short_running; }
  bool HasPlace() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return running_ < limits_.running; }
  bool CanBegin() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return !queue_.empty() && (HasShortPlace() || (HasPlace() && line_.empty()));
  }
  bool CanBeginOrEnd() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return CanBegin() || (closed_ && queue_.empty());
  }

  const WorkerPoolLimits limits_;
  absl::Mutex mutex_;
  std::deque<Queued> queue_ ABSL_GUARDED_BY(mutex_);
  std::vector<Piece*> pieces_ ABSL_GUARDED_BY(mutex_);  // that are begun
  std::deque<Piece*> line_ ABSL_GUARDED_BY(mutex_);     // of these, those that wait for a place to go on
  int running_ ABSL_GUARDED_BY(mutex_) = 0;
  int short_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t idle_ ABSL_GUARDED_BY(mutex_) = 0;  // threads without work
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_ ABSL_GUARDED_BY(mutex_);
  std::thread watch_ ABSL_GUARDED_BY(mutex_);
};

// DEADLINE_EXCEEDED: what is said of work whose patience is over.
absl::Status NotBegun(int timeout_ms);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_
