// Pool of threads for work that may take long (queries, parsing), so that network threads never wait for it.
//
// `running` pieces of work run at the same time, and beside them `short_running` that have just begun: each has
// `short_time` of a processor there. Who goes first is a matter of clients (FairShares): the client that has had the least
// of the processors lately, and of its pieces the oldest. A piece that evaluates (SharedWork) gives its place up as soon as
// somebody is before it: so small work passes large work, however much of that there is.
// Work that waits for something else than the processor (a client that reads slowly, another server) says so with a
// `Waiting`, and others run meanwhile; what waits for a revision does not begin before (await_version.h). `open` bounds the
// pieces that are begun and not ended, each of which holds a thread; `queue` those that are not begun. Of both, a client may
// have three times as much as is free then, so that there is room for the next one. Beyond `open`, `first` more are begun, of
// clients that have nothing begun: whose work is small does not wait for a thread behind hundreds of others. Where all threads
// are held and others wait for one, the client that has been waited for the longest is `Crowded` out. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_
#define DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_

#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "kb_server/door/client.h"
#include "kb_server/door/fair_shares.h"

namespace docent::server {

// One piece of work. Either `run` or `refuse` is called, once.
struct Work {
  std::function<void()> run;  // on a thread of the pool
  // On any thread, also within Submit. RESOURCE_EXHAUSTED (an overload): the queue is full; DEADLINE_EXCEEDED: it has not
  // begun by `until`; UNAVAILABLE: the pool has stopped.
  std::function<void(const absl::Status&)> refuse;
  ClientPtr client = nullptr;
  absl::Time until = absl::InfiniteFuture();
  std::shared_ptr<Cancellation> cancellation =
      nullptr;  // cancelled when the pool stops; null: it ends soon by itself
};

struct WorkerPoolLimits {
  int running = 1;
  int open = 1;
  size_t queue = 0;
  int short_running = 0;
  absl::Duration short_time = absl::ZeroDuration();
  absl::Duration crowded_time = absl::InfiniteDuration();  // a client is waited for so long at least
  int stalled = std::numeric_limits<int>::max();           // that wait for something else than a client
  int first = 0;
};

// As the server's limits say.
WorkerPoolLimits WorkerPoolLimitsOf(const Limits& limits);

class WorkerPool {
  struct Piece;

 public:
  explicit WorkerPool(const WorkerPoolLimits& limits) : limits_(limits), shares_(limits.short_time) {}
  // Stops, and waits until what has begun has ended.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void Submit(Work work);
  // Refuses what has not begun and what comes, and cancels what has.
  void Stop();

  // What there is at the moment; for metrics.
  struct Load {
    int running = 0, short_running = 0;  // places that are taken
    size_t held_up = 0;                  // begun, and waiting for a place
    size_t queued = 0, begun = 0, threads = 0;
    size_t clients = 0;  // that have work
  };
  Load load() const;

  // On the stack of a piece of work while it waits. It goes on when a place is free again.
  class Waiting {
   public:
    enum class What { kClient, kOther };
    explicit Waiting(What what = What::kOther);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

    // RESOURCE_EXHAUSTED (an overload): too many wait for something else; this one must not.
    const absl::Status& status() const { return status_; }
    // Of a client: true if others wait for this thread, and the client has to go.
    bool Crowded();

   private:
    const What what_;
    Piece* const piece_;  // of this thread; null: it is none of a pool's
    absl::Status status_;
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
    Work work;
    absl::Time since;
    uint64_t number = 0;  // in the order of arrival
  };
  // Of one client.
  struct ClientWork {
    std::deque<Queued> queue;
    size_t begun = 0;
  };
  // A piece of work that is begun. On the stack of its thread.
  struct Piece {
    WorkerPool* pool = nullptr;
    ClientPtr client;
    std::shared_ptr<Cancellation> cancellation;
    bool placed = false;    // it runs
    bool is_short = false;  // its place, or the one that it had
    absl::Time begun;
    absl::Duration processor_time;  // of its thread, when it was last charged
    absl::Duration used = absl::ZeroDuration();
    absl::Time client_since = absl::InfiniteFuture();
    absl::Duration client_time = absl::ZeroDuration();  // waited for clients before
    bool crowded_out = false;
    absl::CondVar goes_on;  // it is placed
    const Cancellation* held =
        nullptr;  // while it waits in line: ends that when it is over; null: nothing does
  };
  // It has a place, and a thread is on its way.
  struct Starting {
    Work work;
    bool is_short = false;
  };
  static thread_local Piece* current_;

  void Run();
  // The next piece of work; null: the pool ends.
  std::function<void()> Take(Piece* piece);
  void End(Piece* piece);
  // Ends the waiting of those whose time is over.
  void Watch();
  std::vector<Queued> TakeLate() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Short places are not held for long by work that never looks at its cancellation.
  void MoveOverdue() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void HoldUp(const Cancellation& cancellation);
  // What the piece of this thread has used since it was last charged.
  void Charge(Piece* piece) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void LeavePlace(Piece* piece) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Waits in line for a place; without one where `cancellation`, if there is one, is over before.
  void AwaitPlace(Piece* piece, const Cancellation* cancellation) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Those in line that are over, or all where the pool is closed, end by themselves: they go on without a place.
  void LetGoEnded() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void GoOn(Piece* piece, bool is_short) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Gives the free places to those who are first.
  void Dispatch() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Of those that have begun and wait for a place, the first; null: none.
  Piece* FirstInLine(bool short_only) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The client whose oldest piece may begin next; null: none.
  ClientWork* FirstQueued() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Begin(ClientWork* client) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Whether somebody who waits is before it.
  bool IsOutranked(const Piece& piece) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool IsShort(const Piece& piece) const { return piece.used < limits_.short_time; }
  void Forget(const Client* client) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Time OldestQueued() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool HasShortPlace() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return short_ < limits_.short_running; }
  bool HasPlace() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return running_ < limits_.running; }
  bool IsWaitedFor() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return queued_ > 0 || !line_.empty(); }

  const WorkerPoolLimits limits_;
  mutable absl::Mutex mutex_;
  FairShares shares_ ABSL_GUARDED_BY(mutex_);
  absl::flat_hash_map<const Client*, std::unique_ptr<ClientWork>> clients_ ABSL_GUARDED_BY(mutex_);
  size_t queued_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t last_number_ ABSL_GUARDED_BY(mutex_) = 0;
  std::deque<Starting> starting_ ABSL_GUARDED_BY(mutex_);
  std::vector<Piece*> pieces_ ABSL_GUARDED_BY(mutex_);  // that are begun
  std::deque<Piece*> line_ ABSL_GUARDED_BY(mutex_);     // of these, those that wait for a place to go on
  int running_ ABSL_GUARDED_BY(mutex_) = 0;
  int short_ ABSL_GUARDED_BY(mutex_) = 0;
  int stalled_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t idle_ ABSL_GUARDED_BY(mutex_) = 0;  // threads without work
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_ ABSL_GUARDED_BY(mutex_);
  std::thread watch_ ABSL_GUARDED_BY(mutex_);
  // Hundreds of threads may wait: each is woken alone.
  absl::CondVar work_;     // for threads without work
  absl::CondVar waiting_;  // for watch_: somebody waits
  absl::CondVar closing_;  // for watch_: the pool is closed
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_WORKER_POOL_H_
