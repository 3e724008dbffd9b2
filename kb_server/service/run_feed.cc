#include "kb_server/service/run_feed.h"

#include <utility>

namespace docent {

uint64_t RunFeed::Subscribe(Callback callback) {
  absl::MutexLock lock(&mutex_);
  subscribers_.emplace(next_, std::move(callback));
  return next_++;
}

void RunFeed::Unsubscribe(uint64_t id) {
  absl::MutexLock lock(&mutex_);
  subscribers_.erase(id);
}

void RunFeed::Publish(const std::vector<RunEvent>& events) {
  if (events.empty()) return;
  absl::MutexLock lock(&mutex_);
  for (auto it = subscribers_.begin(); it != subscribers_.end();) {
    bool keeps_up = true;
    for (const RunEvent& event : events) keeps_up = keeps_up && it->second(event);
    it = keeps_up ? std::next(it) : subscribers_.erase(it);
  }
}

}  // namespace docent
