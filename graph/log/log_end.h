// Check of the log's end: the head mark and the snapshots beside the log say which offset it must
// reach. Without this check, a log that lost its end, or all of it, looks whole. Read-only. Any
// thread.
#ifndef DOCENT_GRAPH_LOG_LOG_END_H_
#define DOCENT_GRAPH_LOG_LOG_END_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace docent::log {

// OK if `folder` has a log; its content is not checked. NOT_FOUND: the folder does not exist.
// INVALID_ARGUMENT: not a folder, or not a Docent data folder. DATA_LOSS: the log is missing, although there
// were records or there are snapshots; the message says how to go on.
absl::Status FindLog(const std::string& folder);

// OK if the log of `folder`, whose last record is `end`, holds every acknowledged record and every record
// before a snapshot. DATA_LOSS if records are missing, or if the mark is damaged, so that this cannot be
// decided; the message says how to go on.
absl::Status CheckReach(const std::string& folder, uint64_t end);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_LOG_END_H_
