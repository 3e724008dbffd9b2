// A consistent copy of a data folder, for backup and restore. Any thread.
#ifndef DOCENT_GRAPH_LOG_FOLDER_COPY_H_
#define DOCENT_GRAPH_LOG_FOLDER_COPY_H_

#include <string>

#include "absl/status/statusor.h"
#include "graph/log/folder_check.h"

namespace docent::log {

// Copies the log as of one moment, and its snapshots, to `to`, which must be absent or an empty folder; a
// server may go on using `from`. The copy is checked and durable before it gets its name: `to` is complete or
// absent. Returns the report of the check. INVALID_ARGUMENT (`from` is no data folder, or `to` exists),
// NOT_FOUND, DATA_LOSS (the copy has faults, or the log is missing: `from` is damaged), RESOURCE_EXHAUSTED
// (disk full), and other file errors.
absl::StatusOr<FolderReport> CopyFolder(const std::string& from, const std::string& to);

// Creates the folder `to` from the newest undamaged snapshot in `from`, whose log is lost or damaged: the
// snapshot, and an empty log that begins after it. Later records and older history are not in it. `from`
// stays as it is. Otherwise as CopyFolder; DATA_LOSS: no snapshot is undamaged.
absl::StatusOr<FolderReport> CopyNewestSnapshot(const std::string& from, const std::string& to);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_FOLDER_COPY_H_
