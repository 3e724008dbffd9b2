// Read-only check of a data folder: every record's checksum, the chain through all of
// them, the head, the head mark, and every snapshot's checksum and place in the chain. A server may be using
// it. Any thread; it takes as long as reading everything does.
#ifndef DOCENT_GRAPH_LOG_FOLDER_CHECK_H_
#define DOCENT_GRAPH_LOG_FOLDER_CHECK_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/log/record_chain.h"

namespace docent::log {

struct FolderReport {
  std::string database;             // the log's file
  uint64_t first = 0;               // offset of the first record that is there
  uint64_t last = 0;                // of the last
  std::vector<uint64_t> snapshots;  // offsets of the good ones, ascending
  // Everything that is wrong, each with its file and offset; no more than kFaultsKept.
  std::vector<std::string> faults;
  std::vector<std::string> passed_over;  // CopyNewestSnapshot: what is wrong with newer snapshots
  // The state cannot be made: a fault lies where it is needed.
  bool sound() const { return faults.empty(); }
};
inline constexpr size_t kFaultsKept = 100;

// A log that is gone (graph/log/log_end.h) is a fault. NOT_FOUND, INVALID_ARGUMENT (no Docent data
// folder), PERMISSION_DENIED, FAILED_PRECONDITION (a newer format): it could not be looked at.
// `progress(done, all)` counts records; may be null.
absl::StatusOr<FolderReport> CheckFolder(const std::string& folder,
                                         const std::function<void(uint64_t, uint64_t)>& progress);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_FOLDER_CHECK_H_
