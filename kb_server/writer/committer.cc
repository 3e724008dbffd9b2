#include "kb_server/writer/committer.h"

#include <pthread.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "graph/store/delta_sum.h"
#include "kb_server/writer/run_events.h"

namespace docent::server {
namespace {

std::vector<History::Step> StepsOf(const DecidedGroup& group) {
  std::vector<History::Step> steps;
  steps.reserve(group.turns.size());
  for (const DecidedTurn& turn : group.turns) {
    steps.push_back({turn.result.record.time_us, steps.empty() ? Delta() : turn.result.delta});
  }
  return steps;
}

}  // namespace

Committer::Committer(const CommitPorts& ports, size_t turns_per_commit, WriterCounters* counters,
                     std::function<void()> halted)
    : ports_(ports),
      turns_per_commit_(turns_per_commit),
      counters_(*counters),
      on_halted_(std::move(halted)),
      thread_([this] { Loop(); }) {}

Committer::~Committer() {
  {
    absl::MutexLock lock(&mutex_);
    ending_ = true;
  }
  thread_.join();
}

void Committer::Start(uint64_t head, uint64_t epoch) {
  absl::MutexLock lock(&mutex_);
  head_ = head;
  epoch_ = epoch;
}

std::vector<GraphVersionPtr> Committer::Commit(DecidedGroup group) {
  const auto room = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return halted_ || turns_ < kTurnsAhead; };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&room));
  turns_ += group.turns.size();
  groups_.push_back(std::move(group));
  return std::exchange(gone_, {});
}

void Committer::Wait() {
  const auto done = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return halted_ || groups_.empty(); };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&done));
}

Committer::Refused Committer::TakeRefused() {
  Refused refused;
  absl::MutexLock lock(&mutex_);
  refused.status = std::exchange(refusal_, absl::OkStatus());
  refused.replaced = replaced_;
  refused.head = head_;
  for (DecidedGroup& group : groups_) refused.groups.push_back(std::move(group));
  groups_.clear();
  turns_ = 0;
  halted_ = false;
  return refused;
}

Committer::Groups Committer::Next() {
  const auto work = [this]()
                        ABSL_NO_THREAD_SAFETY_ANALYSIS { return ending_ || (!halted_ && !groups_.empty()); };
  Groups groups;
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&work));
  if (halted_) return groups;
  size_t turns = 0;
  for (DecidedGroup& group : groups_) {
    turns += group.turns.size();
    if (!groups.empty() && turns > turns_per_commit_) break;
    groups.push_back(&group);
  }
  return groups;
}

void Committer::Loop() {
  pthread_setname_np(pthread_self(), "committer");
  for (Groups groups = Next(); !groups.empty(); groups = Next()) {
    if (absl::Status status = Append(groups); !status.ok()) {
      Halt(status);
      continue;
    }
    std::vector<GraphVersionPtr> gone;
    Publish(groups, &gone);
    for (const DecidedGroup* group : groups) {
      for (const DecidedTurn& turn : group->turns) Send(turn.result);  // what robots wait for comes first
    }
    for (DecidedGroup* group : groups) {
      for (DecidedTurn& turn : group->turns) Tell(&turn);
      for (HeldAnswer& answer : group->answers) answer.done(answer.outcome);
    }
    Forget(groups.size(), std::move(gone));
  }
}

void Committer::Forget(size_t count, std::vector<GraphVersionPtr> gone) {
  std::vector<DecidedGroup> told;  // goes after the lock
  absl::MutexLock lock(&mutex_);
  for (; count > 0; --count) {
    told.push_back(std::move(groups_.front()));
    groups_.pop_front();
    turns_ -= told.back().turns.size();
    gone.push_back(std::move(told.back().version));
    for (DecidedTurn& turn : told.back().turns) gone.push_back(std::move(turn.result.version));
  }
  std::move(gone.begin(), gone.end(), std::back_inserter(gone_));
}

void Committer::Halt(const absl::Status& status) {
  {
    absl::MutexLock lock(&mutex_);
    refusal_ = status;
    halted_ = true;
  }
  on_halted_();
}

absl::Status Committer::Append(const Groups& groups) {
  std::vector<std::string> records;
  for (DecidedGroup* group : groups) {
    for (DecidedTurn& turn : group->turns) records.push_back(std::move(turn.record));
  }
  if (records.empty()) return absl::OkStatus();
  const absl::StatusOr<log::AppendResult> appended = ports_.log->Append(records, epoch_, head_);
  if (!appended.ok()) return appended.status();
  replaced_ = appended->outcome != log::AppendResult::Outcome::kAppended;
  if (replaced_) {
    return absl::FailedPreconditionError("another server has taken over the log; this one stops");
  }
  head_ += records.size();
  ++counters_.commits;
  counters_.turns += records.size();
  return absl::OkStatus();
}

void Committer::Publish(const Groups& groups, std::vector<GraphVersionPtr>* gone) {
  GraphVersionPtr newest;
  std::shared_ptr<const Catalog> catalog;
  for (const DecidedGroup* group : groups) {
    if (group->turns.empty()) continue;
    newest = group->version;
    if (group->catalog != nullptr) catalog = group->catalog;
    NoteChanges(*group);
    if (ports_.history != nullptr) ports_.history->Keep(newest, StepsOf(*group), gone);
  }
  if (newest == nullptr) return;
  // The version last: who sees it sees the catalog, and what has changed.
  if (catalog != nullptr) ports_.catalog->Publish(std::move(catalog));
  gone->push_back(ports_.queries->Publish(std::move(newest)));
  if (ports_.subscriptions == nullptr) return;
  for (const DecidedGroup* group : groups) TellFollowers(*group);
}

void Committer::NoteChanges(const DecidedGroup& group) {
  if (ports_.followed == nullptr) return;
  std::vector<const Delta*> turns;
  for (const DecidedTurn& turn : group.turns) turns.push_back(&turn.result.delta);
  ports_.followed->Add(*group.version, turns, group.catalog != nullptr);
}

void Committer::TellFollowers(const DecidedGroup& group) {
  if (group.turns.empty()) return;
  if (group.turns.front().result.version != nullptr) {
    for (const DecidedTurn& turn : group.turns) {
      ports_.subscriptions->Publish(turn.result.version, turn.result.delta, turn.result.record.time_us);
    }
    return;
  }
  const TimeMicros time_us = group.turns.back().result.record.time_us;
  if (group.turns.size() == 1) {
    return ports_.subscriptions->Publish(group.version, group.turns.front().result.delta, time_us);
  }
  DeltaSum sum;
  for (const DecidedTurn& turn : group.turns) sum.Add(turn.result.delta);
  ports_.subscriptions->Publish(group.version, sum.Net(), time_us);
}

void Committer::Send(const TurnResult& result) {
  if (ports_.notifications != nullptr) {
    for (const Notification& notification : result.notifications) ports_.notifications->Send(notification);
  }
  if (ports_.proxies == nullptr) return;
  TellAddresses(result.addresses);
  const std::set<CommandId> cancelled(result.cancels.begin(), result.cancels.end());
  const std::set<CommandId> recalled(result.recalls.begin(), result.recalls.end());
  for (const RobotCommand& command : result.record.commands) {
    const bool never = cancelled.contains(command.id) || recalled.contains(command.id);
    never ? ports_.proxies->NeverSend(command) : ports_.proxies->Send(command);
  }
  for (const CommandId& id : recalled) ports_.proxies->Recall(id);
  for (const CommandId& id : cancelled) ports_.proxies->Cancel(id);
}

void Committer::Tell(DecidedTurn* turn) {
  counters_.commands += turn->result.record.commands.size();
  counters_.firings_ignored += IgnoredFirings(turn->result.record);
  counters_.inferred += turn->result.inferred;
  const std::vector<RunEvent> events = EventsOf(turn->result.record);
  ports_.feed->Publish(events);
  if (events.empty() && TellsProgress(turn->result.record)) ports_.feed->TellNews();
  turn->done(turn->outcome);
}

void Committer::TellAddresses(const std::vector<AdapterAddress>& addresses) {
  if (ports_.proxies == nullptr) return;
  for (const AdapterAddress& adapter : addresses) {
    ports_.proxies->SetAdapter(adapter.robot, adapter.address, adapter.incarnation);
  }
}

}  // namespace docent::server
