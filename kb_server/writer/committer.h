// Makes decided turns durable, and then lets the world know of them, in their order: readers get the version,
// robots their commands, watchers the events, clients the outcome. Nothing of a turn is seen, sent or answered
// before its record is durable.
//
// It does so on a thread of its own, so that the writer decides the next turns meanwhile: to sync, and to wake an
// adapter or a client, takes about as long as a turn. Group commit: what was decided while the last append ran goes
// into the next one, with one fdatasync.
//
// Where the log refuses an append or cannot say what it did, or another writer has taken it over, the committer
// stands still. The writer learns of it (`halted`), takes all that is in flight (TakeRefused), finds out from the
// log what happened, and begins anew (Start).
//
// Threads: the writer calls everything. `halted` and the callbacks of batches are called from the committer's.
#ifndef DOCENT_KB_SERVER_WRITER_COMMITTER_H_
#define DOCENT_KB_SERVER_WRITER_COMMITTER_H_

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "graph/log/context_log.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/followed_reads.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/notification_sink.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/run_feed.h"
#include "kb_server/robots/robot_records.h"
#include "kb_server/subscriptions/subscriptions.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/history.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent::server {

// Read by any thread for /metrics.
struct WriterCounters {
  std::atomic<uint64_t> turns{0};
  std::atomic<uint64_t> commits{0};
  std::atomic<uint64_t> refused{0};
  std::atomic<uint64_t> commands{0};
  std::atomic<uint64_t> condition_candidates{0};
  std::atomic<uint64_t> condition_evaluations{0};
  std::atomic<uint64_t> condition_whole_evaluations{0};
  std::atomic<uint64_t> condition_whole_ns{0};
  std::atomic<uint64_t> conditions{0};
  std::atomic<uint64_t> inferred{0};
  std::atomic<uint64_t> live_runs{0};
  std::atomic<uint64_t> firings_ignored{0};
};

struct DecidedTurn {  // `result.version`: only where somebody follows queries, who is to see each turn
  TurnResult result;
  BatchOutcome outcome;
  BatchCallback done;
  std::string record;  // as the log keeps it
};

// An answer that supposes turns which may not be durable yet: to a batch that was refused after them, to the repeat of one
// of theirs, or to a visit that saw what they made.
struct HeldAnswer {
  absl::StatusOr<BatchOutcome> outcome;
  BatchCallback done;
};

// Turns decided one after the other, and what is to be told when they are durable. May hold answers alone.
struct DecidedGroup {
  std::vector<DecidedTurn> turns;
  GraphVersionPtr version;  // after them; null if there are none
  std::vector<HeldAnswer> answers;
  std::shared_ptr<const Catalog> catalog;  // after the turns; null: they have not changed it
};

// Where turns go once they are decided. These may be null: `proxies`, `notifications` (nothing is sent), `history`, `subscriptions`,
// `followed`.
struct CommitPorts {
  log::ContextLog* log = nullptr;
  QueryPort* queries = nullptr;
  CatalogPort* catalog = nullptr;
  RunFeed* feed = nullptr;
  proxy::RobotProxies* proxies = nullptr;
  NotificationSink* notifications = nullptr;
  History* history = nullptr;
  Subscriptions* subscriptions = nullptr;
  FollowedReads* followed = nullptr;
};

class Committer {
 public:
  // `halted` is called when it stands still. Everything must outlive the committer.
  Committer(const CommitPorts& ports, size_t turns_per_commit, WriterCounters* counters,
            std::function<void()> halted);
  ~Committer();  // when all is told, or it stands still
  Committer(const Committer&) = delete;
  Committer& operator=(const Committer&) = delete;

  // The log ends at `head`, and this is the writer's claim to it. Nothing is in flight.
  void Start(uint64_t head, uint64_t epoch);
  // Waits while kTurnsAhead turns are in flight. Gives versions that are no longer needed here, for the writer to free: a
  // version shares nearly all of its nodes with others, whose counts are in the caches of the core that made them.
  std::vector<GraphVersionPtr> Commit(DecidedGroup group);
  // Waits until all is told, or it stands still.
  void Wait();
  // Nothing is in flight. Any thread.
  bool idle() const {
    absl::MutexLock lock(&mutex_);
    return groups_.empty();
  }

  bool halted() const { return halted_; }
  struct Refused {
    absl::Status status;
    bool replaced = false;  // by another writer: this one has to stop
    uint64_t head = 0;      // of the log, as far as is known
    std::vector<DecidedGroup> groups;
  };
  // All that is in flight; halted() must be true, and is not any more.
  Refused TakeRefused();

  // Where the proxies find the adapters.
  void TellAddresses(const std::vector<AdapterAddress>& addresses);

 private:
  // Turns that are not told yet keep what they replaced in memory.
  static constexpr size_t kTurnsAhead = 1024;
  using Groups = std::vector<DecidedGroup*>;

  void Loop();
  // The next ones to be made durable together; they stay where they are. Empty: the end.
  Groups Next();
  absl::Status Append(const Groups& groups);
  void Publish(const Groups& groups, std::vector<GraphVersionPtr>* gone);
  void NoteChanges(const DecidedGroup& group);
  void TellFollowers(const DecidedGroup& group);
  void Send(const TurnResult& result);
  void Tell(DecidedTurn* turn);
  void Forget(size_t groups, std::vector<GraphVersionPtr> gone);
  void Halt(const absl::Status& status);

  const CommitPorts ports_;
  const size_t turns_per_commit_;
  WriterCounters& counters_;
  const std::function<void()> on_halted_;

  mutable absl::Mutex mutex_;
  std::deque<DecidedGroup> groups_ ABSL_GUARDED_BY(mutex_);    // in flight
  size_t turns_ ABSL_GUARDED_BY(mutex_) = 0;                   // of these
  std::vector<GraphVersionPtr> gone_ ABSL_GUARDED_BY(mutex_);  // see Commit
  absl::Status refusal_ ABSL_GUARDED_BY(mutex_);
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  std::atomic<bool> halted_{false};

  // Of the thread; of the writer while nothing is in flight.
  uint64_t head_ = 0;  // offset of the newest durable record
  uint64_t epoch_ = 0;
  bool replaced_ = false;
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_COMMITTER_H_
