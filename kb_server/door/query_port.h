// The newest visible graph version. The committer publishes a version only after its record is durable; any
// thread takes it and keeps it as long as it likes. Who needs a version that is not there yet leaves word: it holds no
// thread meanwhile. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_QUERY_PORT_H_
#define DOCENT_KB_SERVER_DOOR_QUERY_PORT_H_

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "graph/base/waiting_limits.h"
#include "graph/store/graph_version.h"

namespace docent::server {

class QueryPort {
 public:
  explicit QueryPort(const WaitingLimits& limits = {}) : limits_(limits) {}
  // Nobody may wait any more (Stop).
  ~QueryPort();
  QueryPort(const QueryPort&) = delete;
  QueryPort& operator=(const QueryPort&) = delete;

  // Never null: before the first publication it is the empty graph, revision 0.
  GraphVersionPtr Newest() const {
    absl::MutexLock lock(&mutex_);
    return newest_;
  }

  // Has `then` called once, when the newest version is at least `revision` (read your writes): now, or from another thread,
  // the publisher's, which it must not keep. It is called with an error instead: OUT_OF_RANGE: the revision is further ahead than
  // revisions_ahead; RESOURCE_EXHAUSTED (an overload): revisions_waiting; DEADLINE_EXCEEDED after `deadline`; CANCELLED soon after the
  // caller went away (`cancellation`, may be null); UNAVAILABLE after Stop.
  using Then = std::function<void(const absl::Status&)>;
  void Await(Revision revision, absl::Time deadline, std::shared_ptr<Cancellation> cancellation, Then then);
  // The same for a thread that may wait.
  absl::StatusOr<GraphVersionPtr> WaitForRevision(Revision revision, absl::Time deadline) const;
  // Those who wait; for metrics.
  size_t waiting() const { return count_; }

  // One thread at a time, that of the committer or of a recovery; revisions grow but for the latter. Returns the
  // version before: the thread that made it frees it most cheaply.
  GraphVersionPtr Publish(GraphVersionPtr version);

  // Refuses those who wait, and who comes.
  void Stop();

 private:
  struct Waiting {
    absl::Time deadline;
    std::shared_ptr<Cancellation> cancellation;
    Then then;
  };
  using Told = std::vector<std::pair<Then, absl::Status>>;

  absl::Status NotHere(Revision revision) const;
  // Why one who waits for `revision` waits in vain; OK: it does not.
  absl::Status CheckWaiting(Revision revision, const Waiting& waiting) const;
  void WatchWaiting();
  bool ClosedOrWaited() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(waiting_mutex_) {
    return closed_ || !waiting_.empty();
  }

  const WaitingLimits limits_;
  mutable absl::Mutex mutex_;
  GraphVersionPtr newest_ ABSL_GUARDED_BY(mutex_) = std::make_shared<const GraphVersion>();

  absl::Mutex waiting_mutex_ ABSL_ACQUIRED_BEFORE(mutex_);
  std::multimap<Revision, Waiting> waiting_ ABSL_GUARDED_BY(waiting_mutex_);
  std::atomic<size_t> count_{0};  // of those who wait, or are about to
  bool closed_ ABSL_GUARDED_BY(waiting_mutex_) = false;
  std::thread watch_ ABSL_GUARDED_BY(waiting_mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_QUERY_PORT_H_
