// The ordered, durable log of everything that affects a turn. Its one engine is SQLite (sqlite_log.h); tests
// have others. Its records are opaque bytes here;
// graph/log/record_codec.h says what is in them.
//
// Every record carries a CRC32C of its own bytes and the SHA-256 of the record before it. A record that is
// wrong is corruption: an error that names its offset, never a silent cut. Offsets count from 1 without gaps;
// 0 is "before the first record".
//
// Threads: all methods may be called from any thread. `Append` is meant for one writer; several are served
// one by one. Reads do not wait for appends, nor appends for reads.
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
  uint64_t epoch = 0;  // of the writer that appended it
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
    kConflict   // the log does not end at `expected_head`: read what came in between. Nothing was appended
  };
  Outcome outcome = Outcome::kAppended;
  LogHead head;  // after the append; on kFenced and kConflict as it stands
};

struct LogSnapshot {
  uint64_t offset = 0;  // the state after this record
  std::string data;
};

// What an engine does for its files beside the appends.
struct LogUpkeep {
  uint64_t wal_bytes =
      0;  // length of the write-ahead file; used again from its beginning, it does not shrink
  uint64_t failures =
      0;  // attempts to carry it over that failed: the records are as durable as before, but it grows
};

class ContextLog {
 public:
  virtual ~ContextLog() = default;

  // Appends `records` as one transaction with one sync to disk (group commit): all of them or none. They get
  // the offsets expected_head+1, expected_head+2, …. A higher `epoch` than the head's claims the log for this
  // writer; an empty `records` with a higher epoch only claims. Refusals are outcomes. Errors:
  // RESOURCE_EXHAUSTED (disk full), UNAVAILABLE (I/O error), DATA_LOSS; after an error nothing of the batch
  // is in the log, and a later append may succeed. (But for an error of the sync itself, after which a crash may bring the
  // batch back: a client that repeats it does so under its request id; and for one of CheckPlace, see there.)
  virtual absl::StatusOr<AppendResult> Append(absl::Span<const std::string> records, uint64_t epoch,
                                              uint64_t expected_head) = 0;

  // Records from offset `from` on in order: at most `max`, and no more than about kReadBytes of data (at
  // least one record); none beyond the head. Verified. OUT_OF_RANGE for a `from` that was trimmed away;
  // DATA_LOSS naming the first wrong offset.
  virtual absl::StatusOr<std::vector<LogEntry>> Read(uint64_t from, size_t max) = 0;
  static constexpr size_t kReadBytes = 16u << 20;

  // Waits until the log has a record after `after`, or `timeout` has passed. Returns the offset of the head.
  virtual absl::StatusOr<uint64_t> Wait(uint64_t after, std::chrono::milliseconds timeout) = 0;

  virtual absl::StatusOr<LogHead> Head() = 0;
  // The offset of the first record that is still there; head + 1 if there is none.
  virtual absl::StatusOr<uint64_t> First() = 0;

  // Keeps `data` as the state after record `offset` (≤ head), durably; replaces a snapshot of the same
  // offset. Afterwards the two newest are kept and so many others as the engine's options say, far apart.
  virtual absl::Status SnapshotPut(uint64_t offset, std::string_view data) = 0;
  // The newest snapshot with offset ≤ `at_most`, verified; nullopt if there is none. DATA_LOSS if it is
  // damaged: the caller may go on with an older one (at_most = its offset - 1) as long as the records after
  // it are there. Likewise one that is of another log than this.
  virtual absl::StatusOr<std::optional<LogSnapshot>> SnapshotGet(uint64_t at_most) = 0;
  // The offsets of the snapshots, ascending.
  virtual absl::StatusOr<std::vector<uint64_t>> SnapshotOffsets() = 0;
  // Drops the snapshots before `offset`, but never the two newest.
  virtual absl::Status SnapshotDrop(uint64_t before) = 0;

  // Drops the records with offset < `before`. FAILED_PRECONDITION unless a snapshot with offset ≥ before-1
  // exists: the state must stay derivable.
  virtual absl::Status Trim(uint64_t before) = 0;

  // About how many bytes the records take on disk.
  virtual absl::StatusOr<uint64_t> Bytes() = 0;
  // What became of its files; zeros of an engine without such.
  virtual LogUpkeep Upkeep() { return {}; }
  // Whether a small append would go through now, without making one: the error that it would have.
  virtual absl::Status Probe() = 0;
  // Whether what is appended can be found by the next start: UNAVAILABLE where the log's files have been deleted, moved or
  // replaced while they are in use. Append looks before and after: what it refuses so may be in files that are lost.
  virtual absl::Status CheckPlace() { return absl::OkStatus(); }
  // Room on the log's disk; nullopt: not known.
  virtual std::optional<uint64_t> FreeBytes() { return std::nullopt; }
};

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_CONTEXT_LOG_H_
