// Takes snapshots while the server runs, so that a start need not replay everything, and drops the log
// records that nobody needs any more.
//
// The writer hands over a copy of its state, between two turns; a thread of low priority encodes it, resting now and
// then, waits until the log has the record that made it, writes it, and trims the log. One at a time. The writer's thread
// calls everything but the constructor, the destructor and counters.
#ifndef DOCENT_KB_SERVER_WRITER_SNAPSHOT_KEEPER_H_
#define DOCENT_KB_SERVER_WRITER_SNAPSHOT_KEEPER_H_

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "graph/log/context_log.h"
#include "kb_server/writer/server_state.h"

namespace docent::server {

class SnapshotKeeper {
 public:
  // Both must outlive the keeper.
  SnapshotKeeper(log::ContextLog* log, const Dictionary* dictionary, const Limits& limits);
  // A snapshot that is being written is finished.
  ~SnapshotKeeper();
  SnapshotKeeper(const SnapshotKeeper&) = delete;
  SnapshotKeeper& operator=(const SnapshotKeeper&) = delete;

  // The state was made from a snapshot and these turns after it.
  void Recovered(uint64_t records, uint64_t bytes);
  // So much was appended.
  void Appended(uint64_t records, uint64_t bytes);
  // Whether it is time for a snapshot, and the last one is done.
  bool Due() const;
  // Writes this state beside the writer. Its turn may be not durable yet.
  void Take(ServerState state);
  // Turns that were decided but are not in the log did not happen: a snapshot that waits for them is given
  // up.
  void Discard();
  // At the end, after the last turn: writes this state now, unless the newest snapshot has it already.
  absl::Status TakeLast(const ServerState& state);

  // Read by any thread for /metrics.
  struct Counters {
    std::atomic<uint64_t> written{0};
    std::atomic<uint64_t> failed{0};
    std::atomic<uint64_t> newest_offset{0};
    std::atomic<uint64_t> newest_bytes{0};
  };
  const Counters& counters() const { return counters_; }

 private:
  void Run();
  absl::Status Write(const ServerState& state, bool wait);
  absl::Status Trim();
  bool Wanted() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return job_.has_value() || closing_; }

  log::ContextLog* const log_;
  const Dictionary* const dictionary_;
  const Limits limits_;
  Counters counters_;
  Pace pace_;

  // of the writer: since the newest snapshot was taken
  uint64_t records_ = 0;
  uint64_t bytes_ = 0;

  mutable absl::Mutex mutex_;
  std::optional<ServerState> job_ ABSL_GUARDED_BY(mutex_);
  bool busy_ ABSL_GUARDED_BY(mutex_) = false;
  bool discarded_ ABSL_GUARDED_BY(mutex_) = false;  // the job that runs is not to be written
  bool closing_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_SNAPSHOT_KEEPER_H_
