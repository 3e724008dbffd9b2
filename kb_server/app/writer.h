// The writer thread: takes batches from the door, runs a turn for each, makes the records durable in one
// commit, and only then lets anybody see, hear or be answered (turn_teller.h).
//
// Group commit: all batches that wait are turned and appended together, with one fdatasync. Recovery is the
// same turns fed from the log. Where the log refuses an append (disk full), all of that group is refused, and
// the state is made anew from the log: what the log does not have did not happen, and what it has did, also
// where its answer was lost.
#ifndef DOCENT_KB_SERVER_APP_WRITER_H_
#define DOCENT_KB_SERVER_APP_WRITER_H_

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "kb_server/app/history.h"
#include "kb_server/app/recovery.h"
#include "kb_server/app/snapshot_keeper.h"
#include "kb_server/app/turn.h"
#include "kb_server/app/turn_teller.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/log/context_log.h"
#include "kb_server/service/catalog.h"
#include "kb_server/service/run_feed.h"
#include "kb_server/service/subscriptions.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent {

// Read by any thread for /metrics.
struct WriterCounters {
  std::atomic<uint64_t> turns{0};
  std::atomic<uint64_t> commits{0};
  std::atomic<uint64_t> refused{0};
  std::atomic<uint64_t> commands{0};
  std::atomic<uint64_t> constraint_candidates{0};
  std::atomic<uint64_t> constraint_evaluations{0};
  std::atomic<uint64_t> constraints{0};
  std::atomic<uint64_t> inferred{0};
  std::atomic<uint64_t> live_runs{0};
};

class Writer {
 public:
  // Everything must outlive the writer. These may be null: `proxies` (nothing is sent: tools, tests), `snapshots`
  // and `history` (none are kept).
  struct Ports {
    Inbox* inbox = nullptr;
    ContextLog* log = nullptr;
    QueryPort* queries = nullptr;
    CatalogPort* catalog = nullptr;
    RunFeed* feed = nullptr;
    RobotProxies* proxies = nullptr;
    SnapshotKeeper* snapshots = nullptr;
    History* history = nullptr;
    Subscriptions* subscriptions = nullptr;  // may be null
    Dictionary* dictionary = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    Limits limits;
  };
  explicit Writer(const Ports& ports);

  // Makes the newest state from the newest good snapshot and the log after it, and publishes its version. Errors:
  // see FindStart and ReplayTurns. `progress(done, all)` is called now and then.
  absl::Status Recover(const std::function<void(uint64_t, uint64_t)>& progress);
  // Tells the adapters of commands that were open when the server ended. After Recover.
  void ResumeCommands();
  // Serves until the inbox is closed and empty. OK, or why it cannot go on. The thread that calls it is the
  // writer.
  absl::Status Run();

  // What a snapshot would hold now. Not while Run runs.
  ServerState State() const;

  const WriterCounters& counters() const { return counters_; }

  // Between two turns, on the writer's thread (from a batch's preparation): to be copied, not changed.
  Stages* stages() { return stages_.get(); }

 private:
  struct Decided {
    DurableTurn turn;    // once it is
    std::string record;  // as the log keeps it
  };

  absl::Status Replay(const std::function<void(uint64_t, uint64_t)>& progress);
  void FillFeed(uint64_t up_to);
  bool LogTakesNothing(std::vector<PendingBatch>* batches);
  void TakeGroup(std::vector<PendingBatch> batches);
  absl::Status Commit(std::vector<Decided> group);
  absl::Status Reconcile(std::vector<Decided> group, const absl::Status& refusal);
  void Release(std::vector<Decided> group);
  void PublishCounters();

  const Ports ports_;
  std::unique_ptr<Stages> stages_;
  RequestMemory requests_;
  RecentChanges changes_;  // of the turns, durable or not yet
  uint64_t head_ = 0;      // offset of the newest durable record
  uint64_t epoch_ = 0;
  TimeMicros newest_time_us_ = 0;  // of the newest turn, durable or not yet
  bool refused_ = false;           // by the log, the last time
  absl::Status fatal_;
  TimeMicros next_tick_us_ = 0;  // no clock tick before this time
  // A repeat of a batch of the running group is answered after it.
  std::vector<std::pair<std::string, BatchCallback>> repeats_;
  WriterCounters counters_;
  TurnTeller teller_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_APP_WRITER_H_
