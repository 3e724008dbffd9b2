// A consistent copy of a data folder, for backups and for putting them back. Any thread.
#ifndef DOCENT_GRAPH_LOG_FOLDER_COPY_H_
#define DOCENT_GRAPH_LOG_FOLDER_COPY_H_

#include <string>

#include "absl/status/statusor.h"
#include "graph/log/folder_check.h"

namespace docent::log {

// Copies the log as of one moment and the snapshots that belong to it to `to`, which must be absent or an
// empty folder; a server may go on using `from`. The copy is checked whole and is durable before it has its
// name: `to` is there complete or not at all. What the check of the copy said. INVALID_ARGUMENT (`from` is no
// data folder, `to` is in the way), NOT_FOUND, DATA_LOSS (the copy has faults, or the log is gone: `from` is
// damaged), RESOURCE_EXHAUSTED (no room), and other errors of files.
absl::StatusOr<FolderReport> CopyFolder(const std::string& from, const std::string& to);

// Makes of the newest whole snapshot in `from`, whose log is lost or damaged, a folder `to` that goes on from
// it: the snapshot, and a log that begins after it. What came after the snapshot is not in it, nor what came
// before it as history. `from` stays as it is. Otherwise as CopyFolder; DATA_LOSS: no snapshot is whole.
absl::StatusOr<FolderReport> CopyNewestSnapshot(const std::string& from, const std::string& to);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_FOLDER_COPY_H_
