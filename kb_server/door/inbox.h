// Bounded queue of write batches for the writer thread: the one door for all input, in order.
//
// Bounded: Push never waits and never grows beyond the limits; it refuses and says which limit. Every batch
// pushed is answered exactly once through its callback: by the writer, or with the refusal. A visit looks at the
// writer's state in its place among the batches. Push and Visit from any thread, PopAll from the writer's.
#ifndef DOCENT_KB_SERVER_DOOR_INBOX_H_
#define DOCENT_KB_SERVER_DOOR_INBOX_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/clock.h"
#include "graph/base/diagnostic.h"
#include "graph/base/ids.h"
#include "graph/base/limits.h"
#include "graph/store/graph_version.h"
#include "graph/store/recent_changes.h"
#include "graph/store/write_batch.h"

namespace docent::server {

// What became of a batch, once it is durable and visible.
struct BatchOutcome {
  uint64_t offset = 0;          // of its log record = revision of the version that holds it
  uint64_t added = 0;           // told quads that were new
  uint64_t removed = 0;         // told quads that went
  uint64_t inferred = 0;        // facts that rules added or withdrew because of it
  bool repeated = false;        // its request id was known: applied before, at `offset`
  std::vector<RunId> started;   // runs that its requests started
  uint64_t cancelled_runs = 0;  // with workflows that it undeployed; not kept for a repeated request
  std::vector<RunId> steered;   // that they paused or resumed; not kept for a repeated request
  Diagnostics warnings;  // of shapes and unknown words (kb_server/work/load_runner.h); not kept likewise
};

// The graph that a batch is about to be applied to, on the writer's turn.
struct TurnView {
  const GraphVersion& graph;
  Revision revision;  // of `graph`; may not be visible to readers yet
  const RecentChanges& changes;
  // Whether a document of that kind and name has been put and not removed, whatever it holds.
  absl::FunctionRef<bool(Document::Kind kind, const std::string& name)> has_document;
};
// Called on the writer's turn just before the batch is applied: may look whether what the batch was made from
// still holds, and may fill its operations. An error refuses the batch. It must be quick: nothing else is
// written meanwhile.
using BatchPreparation = std::function<absl::Status(const TurnView& view, WriteBatch* batch)>;

using BatchCallback = std::function<void(const absl::StatusOr<BatchOutcome>&)>;

struct Stages;  // kb_server/turn/turn.h
// Called between two turns, on the writer's thread: may copy the state, and changes nothing. It must be quick: nothing is
// written meanwhile. `revision`: what the state is at; it may not be durable yet.
using StateVisit = std::function<void(Stages* stages, Revision revision)>;

struct PendingBatch {
  WriteBatch batch;
  BatchCallback done;        // never null
  BatchPreparation prepare;  // may be null
  StateVisit visit;          // not null: there is no batch
};

// Why a batch is refused by itself, whatever waits beside it. INVALID_ARGUMENT: a document, or what it defines, has a
// name that cannot be one (graph/rdf/docent_iris.h). RESOURCE_EXHAUSTED: beyond batch_operations or batch_bytes (kLoad:
// load_operations), or one of its documents beyond document_bytes. Any thread. The log may hold batches that an earlier
// version took and this one refuses: a replay does not ask.
absl::Status CheckBatch(const WriteBatch& batch, const Limits& limits);

class Inbox {
 public:
  Inbox(const Clock* clock, const Limits& limits) : clock_(*clock), limits_(limits) {}

  // To `done`, at once, from this thread: what CheckBatch says; RESOURCE_EXHAUSTED: with those that wait the batch
  // would exceed inbox_batches or inbox_bytes (an overload). UNAVAILABLE: the inbox is closed. A null `done` is allowed.
  void Push(WriteBatch batch, BatchCallback done, BatchPreparation prepare = nullptr);

  // `done` is called once: with OK when what the visit saw is durable, or with why it was not made, or why what it saw did
  // not happen. RESOURCE_EXHAUSTED and UNAVAILABLE as for a batch.
  void Visit(StateVisit visit, std::function<void(const absl::Status&)> done);

  // Waits until something is there, `deadline` has passed, Wake was called or the inbox is closed; takes at most
  // `max` batches, each stamped with the time of taking. Stamps never decrease, across restarts too (see
  // StartAfter).
  std::vector<PendingBatch> PopAll(std::optional<TimeMicros> deadline, size_t max);
  // Ends one wait of PopAll, the one under way or the next.
  void Wake();
  bool Passed(TimeMicros deadline) const { return clock_.Now() >= deadline; }

  // No stamp will be lower than this: the time of the newest record of the log.
  void StartAfter(TimeMicros time_us);

  // Pushes are refused from now on; what waits can still be taken.
  void Close();
  bool closed() const;
  size_t size() const;

 private:
  struct Waiting {
    PendingBatch pending;
    size_t bytes;
  };

  // Into the queue, or why not.
  absl::Status Add(PendingBatch pending, size_t bytes);
  // Why a batch of `bytes` is refused now.
  absl::Status CheckRoom(size_t bytes) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Clock& clock_;
  const Limits limits_;
  mutable absl::Mutex mutex_;
  std::deque<Waiting> queue_ ABSL_GUARDED_BY(mutex_);
  size_t waiting_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  TimeMicros last_stamp_us_ ABSL_GUARDED_BY(mutex_) = 0;
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
  bool woken_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_INBOX_H_
