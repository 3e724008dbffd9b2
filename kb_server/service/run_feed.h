// What happens in runs, handed to everyone who watches. Events are published only after their turn is
// durable.
//
// Publish from the writer thread; Subscribe and Unsubscribe from any. A subscriber that cannot keep up (its
// callback returns false) is dropped.
#ifndef DOCENT_KB_SERVER_SERVICE_RUN_FEED_H_
#define DOCENT_KB_SERVER_SERVICE_RUN_FEED_H_

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "kb_server/base/clock.h"
#include "kb_server/base/ids.h"

namespace docent {

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

class RunFeed {
 public:
  using Callback = std::function<bool(const RunEvent&)>;

  uint64_t Subscribe(Callback callback);
  void Unsubscribe(uint64_t id);
  void Publish(const std::vector<RunEvent>& events);

 private:
  absl::Mutex mutex_;
  uint64_t next_ ABSL_GUARDED_BY(mutex_) = 1;
  std::map<uint64_t, Callback> subscribers_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_RUN_FEED_H_
