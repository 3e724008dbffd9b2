// Read your writes: the version that a request has to see. On a worker of the pool.
#ifndef DOCENT_KB_SERVER_DOOR_AWAIT_VERSION_H_
#define DOCENT_KB_SERVER_DOOR_AWAIT_VERSION_H_

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "kb_server/door/ports.h"

namespace docent::server {

// The newest version that is at least `revision`; others have the worker's place while it is not there.
// DEADLINE_EXCEEDED after `deadline`; CANCELLED soon after the caller went away.
absl::StatusOr<GraphVersionPtr> AwaitVersion(const ReadPorts& ports, Revision revision, absl::Time deadline,
                                             Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_AWAIT_VERSION_H_
