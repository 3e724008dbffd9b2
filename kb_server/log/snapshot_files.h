// Snapshots as files beside the log: "snapshot-<offset>", each with a header (format, offset, length, SHA-256
// of the content), written to a temporary file, synced and renamed: a snapshot is there whole or not at all.
// One thread at a time.
#ifndef DOCENT_KB_SERVER_LOG_SNAPSHOT_FILES_H_
#define DOCENT_KB_SERVER_LOG_SNAPSHOT_FILES_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "kb_server/log/context_log.h"

namespace docent {

class SnapshotFiles {
 public:
  static constexpr size_t kKept =
      2;  // newest snapshots kept: the second is for the case that the first is damaged

  explicit SnapshotFiles(std::string folder) : folder_(std::move(folder)) {}

  // As ContextLog::SnapshotPut and SnapshotGet.
  absl::Status Put(uint64_t offset, std::string_view data);
  absl::StatusOr<std::optional<LogSnapshot>> Get(uint64_t at_most) const;

  // Offsets of the snapshots that are there, ascending.
  absl::StatusOr<std::vector<uint64_t>> Offsets() const;

 private:
  std::string Path(uint64_t offset) const;

  std::string folder_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_LOG_SNAPSHOT_FILES_H_
