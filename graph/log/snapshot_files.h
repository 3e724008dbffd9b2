// Snapshots as files beside the log: "snapshot-<offset>", each with a header (format, offset,
// length, the log's chain hash at that offset, SHA-256 of these and the content). A snapshot is
// written to a temporary file, synced and renamed, so it exists whole or not at all. One thread at a
// time.
#ifndef DOCENT_GRAPH_LOG_SNAPSHOT_FILES_H_
#define DOCENT_GRAPH_LOG_SNAPSHOT_FILES_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/log/context_log.h"
#include "graph/log/record_chain.h"

namespace docent::log {

class SnapshotFiles {
 public:
  // The newest snapshots, always kept: the second serves if the first is damaged.
  static constexpr size_t kNewestKept = 2;
  // The temporary file; it remains if the server ends while it writes a snapshot.
  static constexpr char kUnfinished[] = "unfinished-snapshot";

  // `kept`: how many snapshots stay, at least kNewestKept.
  SnapshotFiles(std::string folder, size_t kept) : folder_(std::move(folder)), kept_(kept) {}

  struct Snapshot {
    LogSnapshot content;
    ChainHash chain{};  // the log's chain hash at its offset
  };

  // As ContextLog::SnapshotPut and SnapshotGet; `chain` is the log's hash at `offset`.
  absl::Status Put(uint64_t offset, const ChainHash& chain, std::string_view data);
  absl::StatusOr<std::optional<Snapshot>> Get(uint64_t at_most) const;
  // Removes the snapshots before `offset`, but never the two newest.
  absl::Status DropBefore(uint64_t offset);

  std::string Path(uint64_t offset) const;
  // Offsets of the existing snapshots, ascending.
  absl::StatusOr<std::vector<uint64_t>> Offsets() const;

 private:
  // Drops the snapshot whose removal leaves the shortest gap, until at most `kept_` remain.
  absl::Status Thin();

  std::string folder_;
  size_t kept_;
};

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_SNAPSHOT_FILES_H_
