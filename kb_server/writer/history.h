// The past of the graph: the newest versions are kept in memory, within a bound of bytes, and what the turns
// between them changed; older ones are made
// again from the newest snapshot before them and the log after it, on the thread that asks, one at a time.
//
// Keep is the committer's, Clear the writer's while nothing is committed, At is for any thread.
#ifndef DOCENT_KB_SERVER_WRITER_HISTORY_H_
#define DOCENT_KB_SERVER_WRITER_HISTORY_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/limits.h"
#include "graph/log/context_log.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/delta.h"
#include "kb_server/door/history_port.h"
#include "kb_server/door/query_port.h"

namespace docent::server {

class History final : public HistoryPort {
 public:
  // All must outlive the history. `queries` says what is visible; `dictionary` is that of its versions.
  History(log::ContextLog* log, const QueryPort* queries, const Dictionary* dictionary,
          const sparql::FunctionRegistry* functions, const Limits& limits);

  // What a turn changed; of the first of several that led to a version it may be left empty.
  struct Step {
    TimeMicros time_us;
    Delta delta;
  };
  // The next version, and the turns that led to it from the one before: at least one. Versions that are no longer
  // kept go to `gone`, for the writer to free.
  void Keep(GraphVersionPtr version, std::vector<Step> turns, std::vector<GraphVersionPtr>* gone);
  // The versions that follow come from another beginning.
  void Clear();

  absl::StatusOr<QueryGraph> At(const AsOf& when, Cancellation* cancellation) override;

  // For /metrics.
  size_t kept_versions() const;
  size_t kept_bytes() const;

 private:
  // A version and the turns that led to it; those in between are made again by taking the later ones back.
  struct Kept {
    GraphVersionPtr version;
    std::vector<Step> turns;

    uint64_t last() const { return version->revision().value(); }
    uint64_t first() const { return last() + 1 - turns.size(); }
    size_t DeltaBytes() const;
    GraphVersionPtr At(uint64_t offset) const;
  };
  // A version that was made again.
  struct Remade {
    Dictionary dictionary;
    GraphVersionPtr version;
  };

  size_t Bytes() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The newest version of this time or before; nullopt: older than those that are kept.
  std::optional<uint64_t> KeptAt(TimeMicros time_us) const;
  absl::StatusOr<uint64_t> OffsetAt(TimeMicros time_us, uint64_t newest, Cancellation* cancellation);
  absl::StatusOr<TimeMicros> TimeOf(uint64_t offset);
  absl::Status NoLongerKept(const std::string& what);
  GraphVersionPtr FindKept(uint64_t offset) const;
  std::shared_ptr<const Remade> FindRemade(uint64_t offset) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::StatusOr<QueryGraph> MakeAgain(uint64_t offset, Cancellation* cancellation);
  absl::StatusOr<std::shared_ptr<const Remade>> Replay(uint64_t offset, Cancellation* cancellation);
  // Makes room for one more among those that are remade.
  // Until no other query makes a past graph.
  absl::Status AwaitMade(Cancellation* cancellation) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status MakeRoom() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  log::ContextLog* const log_;
  const QueryPort* const queries_;
  const Dictionary* const dictionary_;
  const sparql::FunctionRegistry* const functions_;
  const Limits limits_;

  mutable absl::Mutex mutex_;
  std::deque<std::shared_ptr<const Kept>> kept_ ABSL_GUARDED_BY(mutex_);       // revisions without a gap
  size_t delta_bytes_ ABSL_GUARDED_BY(mutex_) = 0;                             // of these
  std::vector<std::shared_ptr<const Remade>> remade_ ABSL_GUARDED_BY(mutex_);  // last used last
  bool making_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_HISTORY_H_
