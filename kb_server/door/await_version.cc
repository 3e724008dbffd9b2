#include "kb_server/door/await_version.h"

namespace docent::server {

absl::StatusOr<GraphVersionPtr> AwaitVersion(const ReadPorts& ports, Revision revision, absl::Time deadline,
                                             Cancellation* cancellation) {
  GraphVersionPtr newest = ports.queries->Newest();
  if (newest->revision() >= revision) return newest;
  WorkerPool::Waiting waiting(ports.workers);
  return ports.queries->WaitForRevision(revision, deadline, cancellation);
}

}  // namespace docent::server
