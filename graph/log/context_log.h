// The ordered, durable log of everything that affects a turn. Its only implementation is SQLite
// (sqlite_log.h); tests have others. Its records are opaque bytes here; graph/log/record_codec.h defines
// their content.
//
// Every record carries a CRC32C of its own bytes and the SHA-256 of the record before it. A wrong record is
// corruption: an error that names its offset, never a silent cut. Offsets count from 1 without gaps; 0 is
// "before the first record".
//
// Threads: all methods may be called from any thread. `Append` is meant for one writer; concurrent calls run
// one after the other. Reads do not wait for appends, and appends do not wait for reads.
#ifndef DOCENT_GRAPH_LOG_CONTEXT_LOG_H_
#define DOCENT_GRAPH_LOG_CONTEXT_LOG_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"

namespace docent::log {

struct LogEntry {
  uint64_t offset = 0;
  uint64_t epoch = 0;  // of the writer that appended the record
  std::string data;
};

// Where the log ends: the newest durable record and the highest epoch that a writer has claimed.
struct LogHead {
  uint64_t offset = 0;
  uint64_t epoch = 0;
  friend bool operator==(const LogHead&, const LogHead&) = default;
};

struct AppendResult {
  enum class Outcome : uint8_t {
    kAppended,  // durable; `head.offset` is the offset of the last record of the batch
    kFenced,    // a writer with a higher epoch has taken over: stop writing. Nothing was appended
    kConflict   // the log does not end at `expected_head`: read the records in between. Nothing was appended
  };
  Outcome outcome = Outcome::kAppended;
  LogHead head;  // after the append; on kFenced and kConflict the current head
};

struct LogSnapshot {
  uint64_t offset = 0;  // the state after this record
  std::string data;
};

// State of the write-ahead file, apart from the appends.
struct LogUpkeep {
  uint64_t wal_bytes =
      0;  // length of the write-ahead file; it is reused from its beginning and does not shrink
  uint64_t failures = 0;  // failed checkpoints: the records are as durable as before, but the file grows
};

class ContextLog {
 public:
  virtual ~ContextLog() = default;

  // Appends `records` as one transaction with one sync to disk (group commit): all of them or none. They get
  // the offsets expected_head+1, expected_head+2, …. A higher `epoch` than the head's claims the log for this
  // writer; an empty `records` with a higher epoch only claims. A refusal is an outcome, not an error.
  // Errors: RESOURCE_EXHAUSTED (disk full), UNAVAILABLE (I/O error), DATA_LOSS. After an error no record of
  // the batch is in the log, and a later append may succeed. (Two exceptions: after a failed sync a crash may
  // restore the batch, so a client repeats it under the same request id; and an error of CheckPlace, see
  // there.)
  virtual absl::StatusOr<AppendResult> Append(absl::Span<const std::string> records, uint64_t epoch,
                                              uint64_t expected_head) = 0;

  // Records from offset `from` on in order: at most `max` records and about kReadBytes of data (at least one
  // record); none beyond the head. They are verified. OUT_OF_RANGE if `from` was trimmed away; DATA_LOSS
  // naming the first wrong offset.
  virtual absl::StatusOr<std::vector<LogEntry>> Read(uint64_t from, size_t max) = 0;
  static constexpr size_t kReadBytes = 16u << 20;

  // Waits until the log has a record after `after`, or `timeout` has passed. Returns the offset of the head.
  virtual absl::StatusOr<uint64_t> Wait(uint64_t after, std::chrono::milliseconds timeout) = 0;

  virtual absl::StatusOr<LogHead> Head() = 0;
  // The offset of the oldest record in the log; head + 1 if the log has none.
  virtual absl::StatusOr<uint64_t> First() = 0;

  // Keeps `data` as the state after record `offset` (≤ head), durably; replaces a snapshot of the same
  // offset. Then the two newest are kept, and others spread over time, as many as the engine's options allow.
  virtual absl::Status SnapshotPut(uint64_t offset, std::string_view data) = 0;
  // The newest snapshot with offset ≤ `at_most`, verified; nullopt if there is none. DATA_LOSS if it is
  // damaged or belongs to another log: the caller may go on with an older one (at_most = its offset - 1) as
  // long as the records after it exist.
  virtual absl::StatusOr<std::optional<LogSnapshot>> SnapshotGet(uint64_t at_most) = 0;
  // The offsets of the snapshots, ascending.
  virtual absl::StatusOr<std::vector<uint64_t>> SnapshotOffsets() = 0;
  // Drops the snapshots before `offset`, but never the two newest.
  virtual absl::Status SnapshotDrop(uint64_t before) = 0;

  // Drops the records with offset < `before`. FAILED_PRECONDITION unless a snapshot with offset ≥ before-1
  // exists: the state must stay derivable.
  virtual absl::Status Trim(uint64_t before) = 0;

  // The approximate size of the records on disk, in bytes.
  virtual absl::StatusOr<uint64_t> Bytes() = 0;
  // The state of its files; zeros if the implementation has no files.
  virtual LogUpkeep Upkeep() { return {}; }
  // OK if a small append would succeed now, else the error that it would return. Appends nothing.
  virtual absl::Status Probe() = 0;
  // OK if the next start would find what is appended now. UNAVAILABLE: the log's files were deleted, moved or
  // replaced. Append checks before and after it writes: a batch refused afterwards may be in a lost file.
  virtual absl::Status CheckPlace() { return absl::OkStatus(); }
  // Free space on the log's disk, in bytes; nullopt: not known.
  virtual std::optional<uint64_t> FreeBytes() { return std::nullopt; }
};

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_CONTEXT_LOG_H_
