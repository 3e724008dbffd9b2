// Event feed of workflow runs, for all watchers. Events are published only after their turn is
// durable.
//
// The newest events are kept (Limits::run_events_kept), each under a number that grows by one, so that a
// watcher reads them at its own pace and one that comes back hears what it missed.
//
// Publish from the committer's thread, Keep and BeginAfter from the writer's while nothing is committed (a
// recovery); the rest from any.
#ifndef DOCENT_KB_SERVER_DOOR_RUN_FEED_H_
#define DOCENT_KB_SERVER_DOOR_RUN_FEED_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/base/limits.h"

namespace docent::server {

// One thing that happened. `kind`: fact, run, node, invocation, command, report.
struct RunEvent {
  Revision revision;
  TimeMicros time_us = 0;
  std::string run;
  std::string node;
  std::string kind;
  std::string from;
  std::string to;
  std::string detail;
};
using RunEventPtr = std::shared_ptr<const RunEvent>;

class RunFeed {
 public:
  explicit RunFeed(size_t kept = Limits().run_events_kept) : kept_limit_(kept) {}

  // `news` is called whenever there are new events to Get, on the thread that publishes.
  uint64_t Subscribe(std::function<void()> news);
  // Waits for a call of `news` that is under way.
  void Unsubscribe(uint64_t id);

  // The events of one turn, to be kept and told. Revisions grow.
  void Publish(const std::vector<RunEvent>& events);
  // Calls `news` although there is no new event: the graph says more of a run that is under way.
  void TellNews();
  // As Publish, but no news: of a turn that the log had already.
  void Keep(const std::vector<RunEvent>& events);
  // Events of turns up to `revision` are not known here (a start from a snapshot). Before the first event.
  void BeginAfter(Revision revision);

  // The number of the first event of a turn after `revision`. OUT_OF_RANGE: some of them are no longer kept.
  absl::StatusOr<uint64_t> FirstAfter(Revision revision) const;
  // The number that the next event will have.
  uint64_t Next() const;
  // Null: there is no such event yet. RESOURCE_EXHAUSTED: it is no longer kept.
  absl::StatusOr<RunEventPtr> Get(uint64_t number) const;

 private:
  const size_t kept_limit_;
  mutable absl::Mutex events_mutex_;
  std::deque<RunEventPtr> events_ ABSL_GUARDED_BY(events_mutex_);  // in order
  uint64_t first_ ABSL_GUARDED_BY(events_mutex_) = 1;              // the number of events_.front()
  Revision forgotten_ ABSL_GUARDED_BY(events_mutex_);  // events of turns up to this one may be missing
  Revision newest_ ABSL_GUARDED_BY(events_mutex_);     // the turn of the newest event

  absl::Mutex subscribers_mutex_;
  uint64_t next_subscriber_ ABSL_GUARDED_BY(subscribers_mutex_) = 1;
  std::map<uint64_t, std::function<void()>> subscribers_ ABSL_GUARDED_BY(subscribers_mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_RUN_FEED_H_
