// Snapshots as files beside the log: "snapshot-<offset>", each with a header (format, offset, length, the log's
// chain hash at that offset, SHA-256 of all that and of the content), written to a temporary file, synced and
// renamed: a snapshot is there whole or not at all.
// One thread at a time.
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
  // The newest snapshots, always kept: the second is for the case that the first is damaged.
  static constexpr size_t kNewestKept = 2;
  // What was being written when the server ended.
  static constexpr char kUnfinished[] = "unfinished-snapshot";

  // `kept`: how many snapshots stay, at least kNewestKept.
  SnapshotFiles(std::string folder, size_t kept) : folder_(std::move(folder)), kept_(kept) {}

  struct Snapshot {
    LogSnapshot content;
    ChainHash chain{};  // the log's hash at its offset
  };

  // As ContextLog::SnapshotPut and SnapshotGet; `chain` is the log's hash at `offset`.
  absl::Status Put(uint64_t offset, const ChainHash& chain, std::string_view data);
  absl::StatusOr<std::optional<Snapshot>> Get(uint64_t at_most) const;
  // Removes those before `offset`, but never the two newest.
  absl::Status DropBefore(uint64_t offset);

  std::string Path(uint64_t offset) const;
  // Offsets of the snapshots that are there, ascending.
  absl::StatusOr<std::vector<uint64_t>> Offsets() const;

 private:
  // Drops the one whose absence leaves the shortest gap, until no more than `kept_` are there.
  absl::Status Thin();

  std::string folder_;
  size_t kept_;
};

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_SNAPSHOT_FILES_H_
