// Read-only check of a data folder: every record's checksum, the chain through all records, the head, the
// head mark, and every snapshot's checksum and place in the chain. A server may use the folder meanwhile. Any
// thread; takes as long as reading everything.
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
  uint64_t first = 0;               // offset of the oldest record
  uint64_t last = 0;                // offset of the newest record
  std::vector<uint64_t> snapshots;  // offsets of the good ones, ascending
  // All faults, each with its file and offset; at most kFaultsKept.
  std::vector<std::string> faults;
  std::vector<std::string> passed_over;  // CopyNewestSnapshot: what is wrong with newer snapshots
  // False if the state cannot be rebuilt: a fault lies in a part that it needs.
  bool sound() const { return faults.empty(); }
};
inline constexpr size_t kFaultsKept = 100;

// A missing log (graph/log/log_end.h) is a fault. Errors mean that the folder could not be checked:
// NOT_FOUND, INVALID_ARGUMENT (no Docent data folder), PERMISSION_DENIED, FAILED_PRECONDITION (a newer
// format). `progress(done, all)` counts records; may be null.
absl::StatusOr<FolderReport> CheckFolder(const std::string& folder,
                                         const std::function<void(uint64_t, uint64_t)>& progress);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_FOLDER_CHECK_H_
