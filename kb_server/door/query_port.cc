#include "kb_server/door/query_port.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"

namespace docent::server {
namespace {

constexpr absl::Duration kLookAtWaiting = absl::Milliseconds(50);

}  // namespace

QueryPort::~QueryPort() {
  Stop();
  std::thread watch;
  {
    absl::MutexLock lock(&waiting_mutex_);
    watch.swap(watch_);
  }
  if (watch.joinable()) watch.join();
}

void QueryPort::Await(Revision revision, absl::Time deadline, std::shared_ptr<Cancellation> cancellation,
                      Then then) {
  absl::Status status;
  {
    absl::MutexLock lock(&waiting_mutex_);
    ++count_;  // before the newest revision is looked at: Publish then wakes this one, too
    const uint64_t newest = Newest()->revision().value();
    if (newest < revision.value()) {
      if (closed_) {
        status = absl::UnavailableError("the server stops; nothing was done, try again");
      } else if (revision.value() - newest > limits_.revisions_ahead) {
        status = absl::OutOfRangeError(
            absl::StrCat("revision ", revision.value(), " is not here yet; the newest is ", newest,
                         ", and none further ahead of it is waited for than the limit revisions_ahead = ",
                         limits_.revisions_ahead, "; give a revision that this server has answered with"));
      } else if (waiting_.size() >= limits_.revisions_waiting) {
        status = OverloadError(absl::StrCat("too many wait for a revision: the limit revisions_waiting is ",
                                            limits_.revisions_waiting, "; try again later"));
      } else {
        waiting_.emplace(revision, Waiting{deadline, std::move(cancellation), std::move(then)});
        if (!watch_.joinable()) watch_ = std::thread([this] { WatchWaiting(); });
        return;
      }
    }
    --count_;
  }
  then(status);
}

absl::StatusOr<GraphVersionPtr> QueryPort::WaitForRevision(Revision revision, absl::Time deadline) const {
  {
    absl::MutexLock lock(&mutex_);
    const auto there = [this, revision]()
                           ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return newest_->revision() >= revision; };
    if (mutex_.AwaitWithDeadline(absl::Condition(&there), deadline)) return newest_;
  }
  return NotHere(revision);
}

absl::Status QueryPort::NotHere(Revision revision) const {
  return absl::DeadlineExceededError(absl::StrCat(
      "revision ", revision.value(), " is not here yet; the newest is ", Newest()->revision().value()));
}

GraphVersionPtr QueryPort::Publish(GraphVersionPtr version) {
  const Revision revision = version->revision();
  {
    absl::MutexLock lock(&mutex_);
    newest_.swap(version);
  }
  if (count_ == 0) return version;
  std::vector<Then> there;
  {
    absl::MutexLock lock(&waiting_mutex_);
    const auto end = waiting_.upper_bound(revision);
    for (auto it = waiting_.begin(); it != end; ++it) there.push_back(std::move(it->second.then));
    waiting_.erase(waiting_.begin(), end);
    count_ -= there.size();
  }
  for (const Then& then : there) then(absl::OkStatus());
  return version;
}

absl::Status QueryPort::CheckWaiting(Revision revision, const Waiting& waiting) const {
  if (absl::Now() >= waiting.deadline) return NotHere(revision);
  if (waiting.cancellation == nullptr || !waiting.cancellation->IsOver()) return absl::OkStatus();
  return waiting.cancellation->Left().count() > 0 ? absl::CancelledError("the caller went away")
                                                  : NotHere(revision);
}

void QueryPort::WatchWaiting() {
  while (true) {
    Told told;
    {
      absl::MutexLock lock(&waiting_mutex_);
      waiting_mutex_.Await(absl::Condition(this, &QueryPort::ClosedOrWaited));
      if (!closed_) waiting_mutex_.AwaitWithTimeout(absl::Condition(&closed_), kLookAtWaiting);
      if (closed_) return;
      for (auto it = waiting_.begin(); it != waiting_.end();) {
        absl::Status status = CheckWaiting(it->first, it->second);
        if (status.ok()) {
          ++it;
          continue;
        }
        told.emplace_back(std::move(it->second.then), std::move(status));
        it = waiting_.erase(it);
      }
      count_ -= told.size();
    }
    for (const auto& [then, status] : told) then(status);
  }
}

void QueryPort::Stop() {
  std::multimap<Revision, Waiting> refused;
  {
    absl::MutexLock lock(&waiting_mutex_);
    closed_ = true;
    refused.swap(waiting_);
    count_ -= refused.size();
  }
  for (const auto& [revision, waiting] : refused)
    waiting.then(absl::UnavailableError("the server stops; nothing was done, try again"));
}

}  // namespace docent::server
