// The writer thread: takes batches from the door and decides a turn for each; the committer (committer.h) makes
// them durable meanwhile, and only then lets anybody see, hear or be answered.
//
// The writer goes on from the state that its turns lead to, durable or not yet. Recovery is the same turns fed
// from the log. Where the log refuses an append (disk full), everything that is in flight is refused, and the
// state is made anew from the log: what the log does not have did not happen, and what it has did, also where
// its answer was lost.
#ifndef DOCENT_KB_SERVER_WRITER_WRITER_H_
#define DOCENT_KB_SERVER_WRITER_WRITER_H_

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/log/context_log.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/door/run_feed.h"
#include "kb_server/subscriptions/subscriptions.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/committer.h"
#include "kb_server/writer/history.h"
#include "kb_server/writer/recovery.h"
#include "kb_server/writer/snapshot_keeper.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent::server {

class Writer {
 public:
  // Everything must outlive the writer.
  struct Ports : CommitPorts {
    Inbox* inbox = nullptr;
    SnapshotKeeper* snapshots = nullptr;  // null: none are kept
    Dictionary* dictionary = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    Limits limits;
    std::function<void(const Delta&)> saw;  // what each turn changes, durable or not yet; null: not wanted
  };
  explicit Writer(const Ports& ports);

  // Makes the newest state from the newest good snapshot and the log after it, and publishes its version. Errors:
  // see FindStart and ReplayTurns. `progress(done, all)` is called now and then.
  absl::Status Recover(const std::function<void(uint64_t, uint64_t)>& progress);
  // Tells the adapters of commands that were open when the server ended, and sends again what was not known to be delivered.
  // After Recover.
  void ResumeCommands();
  // Serves until the inbox is closed and empty. OK, or why it cannot go on. The thread that calls it is the
  // writer.
  absl::Status Run();

  // The turn that is under way is refused, and so are all after it: a long one does not hold up the end. Any thread.
  void EndTurns() { cancellation_.Cancel(); }

  // When a turn falls due though nothing comes in, by the clock of turns; 0: a turn is under way. Any thread.
  std::optional<TimeMicros> NextDue() const;

  // Of the newest turn. Not while Run runs.
  TimeMicros newest_time_us() const { return newest_time_us_; }

  // What a snapshot would hold now. Not while Run runs.
  ServerState State() const;

  const WriterCounters& counters() const { return counters_; }

  // OK, or why the log took nothing the last time that it was asked. Any thread.
  absl::Status LogStatus() const;
  // To be called now and then while that is not OK: asks the log again, though nothing is to be written. Any thread.
  void AskLogAgain() { ports_.inbox->Wake(); }

 private:
  absl::Status Replay(const std::function<void(uint64_t, uint64_t)>& progress);
  void FillFeed(uint64_t up_to);
  bool LogTakesNothing(std::vector<PendingBatch>* batches);
  void SetLogStatus(const absl::Status& status);
  void TakeGroup(std::vector<PendingBatch> batches);
  void GoOnWithRuns();
  void RefusedTick(TimeMicros time_us, const absl::Status& why);
  void Decide(PendingBatch pending, DecidedGroup* group);
  void Commit(DecidedGroup group);
  void FreeGone();
  absl::Status Reconcile();
  absl::Status End();
  void PublishCounters();

  const Ports ports_;
  Cancellation cancellation_;  // of turns that are decided here, not of those that are replayed
  std::unique_ptr<Stages> stages_;
  // All of these of the turns that were decided, durable or not yet.
  RequestMemory requests_;
  RecentChanges changes_;
  uint64_t newest_ = 0;  // offset of the newest one's record
  TimeMicros newest_time_us_ = 0;

  uint64_t epoch_ = 0;
  bool refused_ = false;  // by the log, the last time
  bool lost_ = false;     // the state could not be made from the log again, since that is not where it was
  mutable absl::Mutex log_status_mutex_;
  absl::Status log_status_ ABSL_GUARDED_BY(log_status_mutex_);
  absl::Status fatal_;
  TimeMicros next_tick_us_ = 0;  // no clock tick before this time
  std::string tick_refusal_;     // why the last one was refused; empty: it was not
  static constexpr TimeMicros kNever = INT64_MAX;
  std::atomic<TimeMicros> next_due_us_ = 0;  // see NextDue
  std::deque<GraphVersionPtr> gone_;         // held here alone, to be freed, the oldest first
  WriterCounters counters_;
  Committer committer_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_WRITER_H_
