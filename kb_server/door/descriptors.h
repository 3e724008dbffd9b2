// Budget of the process's file descriptors: both doors take connections, and some are kept for the log, snapshots, robots
// and other servers. Any thread.
#ifndef DOCENT_KB_SERVER_DOOR_DESCRIPTORS_H_
#define DOCENT_KB_SERVER_DOOR_DESCRIPTORS_H_

#include <cstddef>

#include "absl/status/status.h"
#include "graph/base/limits.h"

namespace docent::server {

// With fewer a server is not started.
inline constexpr size_t kLeastDescriptors = 48;

// Raises the soft limit of open files (ulimit -n) to the hard one; common soft limits are less than the connections that
// a server takes. FAILED_PRECONDITION: even the hard one is below kLeastDescriptors.
absl::Status RaiseDescriptorLimit();

size_t DescriptorLimit();  // the soft one
size_t OpenDescriptors();

// Connections that each door may have at one time.
struct ConnectionShares {
  size_t grpc = 0;
  size_t http = 0;
};
// `limit`, `open`: descriptors that there may be, and that are open before the doors are.
ConnectionShares ShareDescriptors(size_t limit, size_t open, const Limits& limits);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_DESCRIPTORS_H_
