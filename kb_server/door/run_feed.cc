#include "kb_server/door/run_feed.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace docent::server {

uint64_t RunFeed::Subscribe(std::function<void()> news) {
  absl::MutexLock lock(&subscribers_mutex_);
  subscribers_.emplace(next_subscriber_, std::move(news));
  return next_subscriber_++;
}

void RunFeed::Unsubscribe(uint64_t id) {
  absl::MutexLock lock(&subscribers_mutex_);
  subscribers_.erase(id);
}

void RunFeed::Publish(const std::vector<RunEvent>& events) {
  if (events.empty()) return;
  Keep(events);
  TellNews();
}

void RunFeed::TellNews() {
  absl::MutexLock lock(&subscribers_mutex_);
  for (const auto& [id, news] : subscribers_) news();
}

void RunFeed::Keep(const std::vector<RunEvent>& events) {
  absl::MutexLock lock(&events_mutex_);
  if (events.empty() || events.front().revision <= newest_) return;  // replayed while running: known
  newest_ = events.back().revision;
  for (const RunEvent& event : events) events_.push_back(std::make_shared<const RunEvent>(event));
  while (events_.size() > kept_limit_) {
    forgotten_ = events_.front()->revision;
    events_.pop_front();
    ++first_;
  }
}

void RunFeed::BeginAfter(Revision revision) {
  absl::MutexLock lock(&events_mutex_);
  if (newest_ == Revision()) forgotten_ = newest_ = revision;
}

absl::StatusOr<uint64_t> RunFeed::FirstAfter(Revision revision) const {
  absl::MutexLock lock(&events_mutex_);
  if (revision < forgotten_) {
    return absl::OutOfRangeError(absl::StrCat("events after revision ", revision.value(),
                                              " are no longer all kept; ask for those after ",
                                              forgotten_.value(), ", or for what comes from now on"));
  }
  auto after = [](Revision asked, const RunEventPtr& event) { return asked < event->revision; };
  return first_ + (std::upper_bound(events_.begin(), events_.end(), revision, after) - events_.begin());
}

uint64_t RunFeed::Next() const {
  absl::MutexLock lock(&events_mutex_);
  return first_ + events_.size();
}

absl::StatusOr<RunEventPtr> RunFeed::Get(uint64_t number) const {
  absl::MutexLock lock(&events_mutex_);
  if (number < first_) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "too slow: events were dropped before they were taken; the limit run_events_kept is ", kept_limit_));
  }
  if (number - first_ >= events_.size()) return nullptr;
  return events_[number - first_];
}

}  // namespace docent::server
