// The clock as a source of facts: tells the graph when a time begins, ends or occurs (clock_facts.h).
//
// A thread of its own sleeps until something is due. It looks at the wall clock once a second, too, and sees when that was
// set. What it tells is worked out on the writer's turn, from the newest graph, and is a batch in the log like any other.
#ifndef DOCENT_KB_SERVER_CLOCK_CLOCK_SOURCE_H_
#define DOCENT_KB_SERVER_CLOCK_CLOCK_SOURCE_H_

#include <optional>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/delta.h"
#include "kb_server/clock/clock_facts.h"
#include "kb_server/door/inbox.h"

namespace docent::server {

class ClockSource {
 public:
  // All must outlive it, and it the writer's last turn. `wall`: times of day; `steady`: the clock of turns; `simulated`: a
  // simulator moves both, and says so by Wake.
  ClockSource(const Clock* wall, const Clock* steady, bool simulated, Inbox* inbox,
              const Dictionary* dictionary)
      : wall_(*wall), steady_(*steady), simulated_(simulated), inbox_(*inbox), dictionary_(*dictionary) {}
  ~ClockSource() { Stop(); }

  // From now on; the first look is made at once.
  void Start();
  void Stop();
  // A turn changed the graph: whether that changes which times there are. The writer's thread.
  void Saw(const Delta& delta);
  // The clocks were moved. Any thread.
  void Wake();
  // When it has something to tell next, by the clock of turns; 0: it is about to tell it. Any thread.
  std::optional<TimeMicros> NextDue() const;

 private:
  void Run();
  bool Due() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Look() ABSL_LOCKS_EXCLUDED(mutex_);
  void Looked(const absl::StatusOr<BatchOutcome>& outcome, bool occurred);
  bool Concerns(const Quad& quad);

  const Clock& wall_;
  const Clock& steady_;
  const bool simulated_;
  Inbox& inbox_;
  const Dictionary& dictionary_;
  std::thread thread_;

  // The writer's thread: what is known of predicates, and of the objects of rdf:type.
  absl::flat_hash_map<TermId, bool> predicates_, classes_;
  std::optional<TermId> type_;

  mutable absl::Mutex mutex_;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  bool asked_ ABSL_GUARDED_BY(mutex_) = true;     // a look is wanted
  bool looking_ ABSL_GUARDED_BY(mutex_) = false;  // a batch is under way
  bool woken_ ABSL_GUARDED_BY(mutex_) = false;
  TimeMicros ahead_us_ ABSL_GUARDED_BY(mutex_) = 0;  // of the wall clock to the steady one, when last looked
  std::optional<TimeMicros> next_wall_us_ ABSL_GUARDED_BY(mutex_), next_steady_us_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLOCK_CLOCK_SOURCE_H_
