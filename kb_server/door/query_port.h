// The newest visible graph version. The committer publishes a version only after its record is durable; any
// thread takes it and keeps it as long as it likes. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_QUERY_PORT_H_
#define DOCENT_KB_SERVER_DOOR_QUERY_PORT_H_

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "graph/store/graph_version.h"

namespace docent::server {

class QueryPort {
 public:
  // Never null: before the first publication it is the empty graph, revision 0.
  GraphVersionPtr Newest() const {
    absl::MutexLock lock(&mutex_);
    return newest_;
  }

  // The newest version once it is at least `revision` (read your writes). DEADLINE_EXCEEDED after `deadline`;
  // CANCELLED soon after the caller went away.
  absl::StatusOr<GraphVersionPtr> WaitForRevision(Revision revision, absl::Time deadline,
                                                  Cancellation* cancellation) const {
    while (true) {
      auto version = WaitForRevision(revision, std::min(deadline, absl::Now() + absl::Milliseconds(100)));
      if (version.ok() || absl::Now() >= deadline) return version;
      if (absl::Status status = cancellation->Check(); !status.ok()) return status;
    }
  }
  absl::StatusOr<GraphVersionPtr> WaitForRevision(Revision revision, absl::Time deadline) const {
    absl::MutexLock lock(&mutex_);
    auto there = [this, revision]()
                     ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return newest_->revision() >= revision; };
    if (mutex_.AwaitWithDeadline(absl::Condition(&there), deadline)) return newest_;
    return absl::DeadlineExceededError(absl::StrCat(
        "revision ", revision.value(), " is not here yet; the newest is ", newest_->revision().value()));
  }

  // One thread at a time, that of the committer or of a recovery; revisions grow but for the latter. Returns the
  // version before: the thread that made it frees it most cheaply.
  GraphVersionPtr Publish(GraphVersionPtr version) {
    absl::MutexLock lock(&mutex_);
    return std::exchange(newest_, std::move(version));
  }

 private:
  mutable absl::Mutex mutex_;
  GraphVersionPtr newest_ ABSL_GUARDED_BY(mutex_) = std::make_shared<const GraphVersion>();
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_QUERY_PORT_H_
