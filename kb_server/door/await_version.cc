#include "kb_server/door/await_version.h"

#include <memory>
#include <utility>

namespace docent::server {

void SubmitOnVersion(const ReadPorts& ports, Revision revision, Work work) {
  if (ports.queries->Newest()->revision() >= revision) return ports.workers->Submit(std::move(work));
  const absl::Time until = work.until;
  std::shared_ptr<Cancellation> cancellation = work.cancellation;
  ports.queries->Await(revision, until, std::move(cancellation),
                       [workers = ports.workers,
                        waiting = std::make_shared<Work>(std::move(work))](const absl::Status& status) {
                         if (!status.ok()) return waiting->refuse(status);
                         workers->Submit(std::move(*waiting));
                       });
}

}  // namespace docent::server
