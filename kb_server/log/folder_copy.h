// A consistent copy of a data folder, for backups and for putting them back. Any thread.
#ifndef DOCENT_KB_SERVER_LOG_FOLDER_COPY_H_
#define DOCENT_KB_SERVER_LOG_FOLDER_COPY_H_

#include <string>

#include "absl/status/statusor.h"
#include "kb_server/log/folder_check.h"

namespace docent {

// Copies the log as of one moment and the snapshots that belong to it to `to`, which must be absent or an
// empty folder; a server may go on using `from`. The copy is checked whole and is durable before it has its
// name: `to` is there complete or not at all. What the check of the copy said. INVALID_ARGUMENT (`from` is no
// data folder, `to` is in the way), DATA_LOSS (the copy has faults: `from` is damaged), RESOURCE_EXHAUSTED
// (no room), and other errors of files.
absl::StatusOr<FolderReport> CopyFolder(const std::string& from, const std::string& to);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_LOG_FOLDER_COPY_H_
