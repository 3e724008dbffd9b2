// The offset that the log of a folder must reach, by the head mark and the snapshots beside it. A
// log that lost its end, or all of it, looks whole otherwise. Nothing is changed, nothing is made. Any
// thread.
#ifndef DOCENT_GRAPH_LOG_LOG_END_H_
#define DOCENT_GRAPH_LOG_LOG_END_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace docent::log {

// OK if `folder` has a log, whatever is in it. NOT_FOUND: there is no such folder. INVALID_ARGUMENT: it is
// not a folder, or none of ours. DATA_LOSS: the log is gone, since it had records or there are snapshots; the
// message says how to go on.
absl::Status FindLog(const std::string& folder);

// OK if the log of `folder`, whose last record is `end`, holds every record that was acknowledged and that a
// snapshot was taken after. DATA_LOSS if not, or if the mark is damaged, so that nobody can tell; the message
// says how to go on.
absl::Status CheckReach(const std::string& folder, uint64_t end);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_LOG_END_H_
