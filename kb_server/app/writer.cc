#include "kb_server/app/writer.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "kb_server/app/run_events.h"
#include "kb_server/log/record_codec.h"
#include "spdlog/spdlog.h"

namespace docent {
namespace {

// A clock tick that was refused (a full disk, a rule that explodes) is tried again after this time, not at
// once.
constexpr TimeMicros kTickPauseUs = 1'000'000;
constexpr uint64_t kTurnsPerProgress = 10000;

// What its client is told of a turn.
BatchOutcome OutcomeOf(const TurnResult& result) {
  BatchOutcome outcome;
  outcome.offset = result.record.offset;
  outcome.added = result.delta.added.size();
  outcome.removed = result.delta.removed.size();
  outcome.inferred = result.inferred;
  outcome.started = result.started;
  return outcome;
}

}  // namespace

Writer::Writer(const Ports& ports)
    : ports_(ports),
      requests_(ports.limits.request_ids_remembered),
      teller_(ports.feed, ports.proxies, ports.dictionary) {}

absl::Status Writer::Recover(const std::function<void(uint64_t, uint64_t)>& progress) {
  absl::Status status = Replay(progress);
  if (!status.ok()) return status;
  GraphVersionPtr version = stages_->writer.Freeze(Revision(head_));
  ports_.queries->Publish(version);
  if (ports_.subscriptions != nullptr) ports_.subscriptions->PublishWhole(std::move(version));
  ports_.catalog->Publish(stages_->documents.MakeCatalog(stages_->engine));
  teller_.TellAddresses(stages_->writer.current());
  PublishCounters();
  return absl::OkStatus();
}

absl::Status Writer::Replay(const std::function<void(uint64_t, uint64_t)>& progress) {
  changes_.Clear();
  if (ports_.history != nullptr) ports_.history->Clear();
  auto head = ports_.log->Head();
  if (!head.ok()) return head.status();
  epoch_ = std::max<uint64_t>(head->epoch, 1);
  auto start = FindStart(ports_.log, head->offset, ports_.dictionary, ports_.functions, ports_.limits);
  if (!start.ok()) return start.status();
  stages_ = std::move(start->stages);
  head_ = start->offset;
  newest_time_us_ = start->time_us;
  for (const RememberedRequestPtr& request : start->requests) requests_.Remember(request->id, request->outcome);
  ports_.inbox->StartAfter(newest_time_us_);
  FillFeed(head_);
  uint64_t bytes = 0;
  absl::Status status = ReplayTurns(
      ports_.log, head_ + 1, head->offset, stages_.get(), [&](TurnResult turn, size_t record_bytes) {
        requests_.Remember(turn.record.batch.request_id, OutcomeOf(turn));
        newest_time_us_ = turn.record.time_us;
        ports_.feed->Keep(EventsOf(turn.record));
        head_ = turn.record.offset;
        bytes += record_bytes;
        if (progress && head_ % kTurnsPerProgress == 0) progress(head_, head->offset);
        return absl::OkStatus();
      });
  if (!status.ok()) return status;
  ports_.inbox->StartAfter(newest_time_us_);
  if (progress && head_ > start->offset) progress(head_, head->offset);
  if (ports_.snapshots != nullptr) ports_.snapshots->Recovered(head_ - start->offset, bytes);
  return absl::OkStatus();
}

// What watchers may ask for of the turns that a snapshot stands for, as far as the log still has them. The feed
// knows them already where this is not the first recovery.
void Writer::FillFeed(uint64_t up_to) {
  const uint64_t wanted = std::min<uint64_t>(up_to, ports_.limits.run_events_kept);
  const absl::StatusOr<uint64_t> first = ports_.log->First();
  const uint64_t from = std::max<uint64_t>(up_to - wanted + 1, first.ok() ? *first : up_to + 1);
  std::vector<std::vector<RunEvent>> turns;
  for (uint64_t next = from; next <= up_to;) {
    auto entries = ports_.log->Read(next, up_to - next + 1);
    if (!entries.ok() || entries->empty()) break;
    for (const LogEntry& entry : *entries) {
      auto record = DecodeTurnRecord(entry.offset, entry.data);
      if (!record.ok()) break;
      turns.push_back(EventsOf(*record));
      next = entry.offset + 1;
    }
    if (entries->back().offset + 1 != next) break;
  }
  if (from + turns.size() <= up_to) turns.clear();  // not readable: the state needs none of it
  ports_.feed->BeginAfter(Revision(up_to - turns.size()));
  for (const std::vector<RunEvent>& events : turns) ports_.feed->Keep(events);
}

ServerState Writer::State() const {
  return TakeState(*stages_, requests_, stages_->writer.Freeze(Revision(head_)), newest_time_us_);
}

void Writer::ResumeCommands() {
  if (ports_.proxies == nullptr) return;
  for (const RobotCommand& command : stages_->engine.OpenCommands()) ports_.proxies->Resume(command);
}

absl::Status Writer::Run() {
  while (fatal_.ok()) {
    std::optional<TimeMicros> deadline = stages_->NextDeadline();
    if (deadline) deadline = std::max(*deadline, next_tick_us_);
    std::vector<PendingBatch> batches = ports_.inbox->PopAll(deadline, ports_.limits.turns_per_commit);
    if (batches.empty()) {
      if (ports_.inbox->closed()) break;
      WriteBatch tick;
      tick.clock_tick = true;
      ports_.inbox->Push(std::move(tick), nullptr);
      continue;
    }
    if (refused_ && LogTakesNothing(&batches)) continue;
    TakeGroup(std::move(batches));
  }
  teller_.WaitUntilTold();
  ports_.inbox->Close();
  for (PendingBatch& pending : ports_.inbox->PopAll(0, SIZE_MAX)) pending.done(fatal_);
  return fatal_;
}

// After a refusal, whether the log still refuses: then these are refused, too, before anything is decided that
// would have to be undone by a recovery.
bool Writer::LogTakesNothing(std::vector<PendingBatch>* batches) {
  const absl::Status status = ports_.log->Probe();
  refused_ = !status.ok();
  if (status.ok()) return false;
  for (PendingBatch& pending : *batches) {
    if (pending.batch.clock_tick) next_tick_us_ = pending.batch.time_us + kTickPauseUs;
    ++counters_.refused;
    pending.done(status);
  }
  return true;
}

void Writer::TakeGroup(std::vector<PendingBatch> batches) {
  std::vector<Decided> group;
  std::set<std::string> ids;
  for (PendingBatch& pending : batches) {
    const std::string& id = pending.batch.request_id;
    if (const BatchOutcome* first = requests_.Find(id)) {
      BatchOutcome outcome = *first;
      outcome.repeated = true;
      pending.done(outcome);
      continue;
    }
    if (!id.empty() && !ids.insert(id).second) {
      repeats_.emplace_back(id, std::move(pending.done));
      continue;
    }
    const uint64_t offset = head_ + group.size() + 1;
    if (pending.prepare) {
      const TurnView view{stages_->writer.current(), Revision(offset - 1), changes_};
      if (absl::Status status = pending.prepare(view, &pending.batch); !status.ok()) {
        pending.done(status);
        continue;
      }
    }
    bool tick = pending.batch.clock_tick;
    TimeMicros time_us = pending.batch.time_us;
    std::string record;
    auto result = RunTurn(stages_.get(), std::move(pending.batch), offset, &record);
    if (!result.ok()) {
      if (tick) next_tick_us_ = time_us + kTickPauseUs;
      ++counters_.refused;
      pending.done(result.status());
      continue;
    }
    newest_time_us_ = time_us;
    changes_.Add(Revision(offset), result->delta);
    BatchOutcome outcome = OutcomeOf(*result);
    group.push_back({{*std::move(result), std::move(outcome), std::move(pending.done)}, std::move(record)});
  }
  if (!group.empty()) fatal_ = Commit(std::move(group));
  for (auto& [id, done] : repeats_) {
    if (const BatchOutcome* first = requests_.Find(id)) {
      BatchOutcome outcome = *first;
      outcome.repeated = true;
      done(outcome);
    } else {
      done(absl::AbortedError("the batch with this request_id was refused; send it again"));
    }
  }
  repeats_.clear();
  PublishCounters();
}

absl::Status Writer::Commit(std::vector<Decided> group) {
  std::vector<std::string> records;
  size_t bytes = 0;
  for (Decided& decided : group) {
    bytes += decided.record.size();
    records.push_back(std::move(decided.record));
  }
  auto appended = ports_.log->Append(records, epoch_, head_);
  if (!appended.ok()) return Reconcile(std::move(group), appended.status());
  if (appended->outcome != AppendResult::Outcome::kAppended) {
    absl::Status fatal =
        absl::FailedPreconditionError("another server has taken over the log; this one stops");
    counters_.refused += group.size();
    for (Decided& decided : group) decided.turn.done(fatal);
    return fatal;
  }
  head_ += records.size();
  ++counters_.commits;
  counters_.turns += group.size();
  GraphVersionPtr newest = group.back().turn.result.version;
  Release(std::move(group));
  if (ports_.snapshots != nullptr) {
    ports_.snapshots->Appended(records.size(), bytes);
    if (ports_.snapshots->Due()) {
      ports_.snapshots->Take(TakeState(*stages_, requests_, std::move(newest), newest_time_us_));
    }
  }
  return absl::OkStatus();
}

// The log refused the group, or cannot say what it did. What it does not have did not happen; what it has
// did.
absl::Status Writer::Reconcile(std::vector<Decided> group, const absl::Status& refusal) {
  spdlog::error("the log refused {} turns: {}", group.size(), std::string(refusal.message()));
  next_tick_us_ = group.back().turn.result.record.time_us + kTickPauseUs;
  const uint64_t head_before = head_;
  teller_.WaitUntilTold();
  refused_ = true;
  if (ports_.snapshots != nullptr) ports_.snapshots->Discard();
  absl::Status recovered = Recover(nullptr);
  if (recovered.ok() && head_ > head_before) ResumeCommands();
  for (Decided& decided : group) {
    const bool happened = recovered.ok() && decided.turn.outcome.offset <= head_;
    if (happened) {
      ++counters_.turns;
      ports_.feed->Publish(EventsOf(decided.turn.result.record));
      decided.turn.done(decided.turn.outcome);
    } else {
      ++counters_.refused;
      decided.turn.done(refusal);
    }
  }
  return recovered;
}

// The records are durable: now the world may know.
void Writer::Release(std::vector<Decided> group) {
  if (ports_.history != nullptr) {
    for (const Decided& decided : group) {
      ports_.history->Keep(decided.turn.result.version, decided.turn.result.record.time_us);
    }
  }
  ports_.queries->Publish(group.back().turn.result.version);
  if (std::any_of(group.begin(), group.end(), [](const Decided& d) { return d.turn.result.documents_changed; })) {
    ports_.catalog->Publish(stages_->documents.MakeCatalog(stages_->engine));
  }
  std::vector<DurableTurn> turns;
  for (Decided& decided : group) {
    TurnResult& result = decided.turn.result;
    if (ports_.subscriptions != nullptr)
      ports_.subscriptions->Publish(result.version, result.delta, result.record.time_us);
    requests_.Remember(result.record.batch.request_id, decided.turn.outcome);
    counters_.commands += result.record.commands.size();
    counters_.inferred += result.inferred;
    result.version.reset();  // freed by the thread that made it
    turns.push_back(std::move(decided.turn));
  }
  teller_.Tell(std::move(turns));
}

void Writer::PublishCounters() {
  counters_.constraint_candidates = stages_->constraints.counters().candidates;
  counters_.constraint_evaluations = stages_->constraints.counters().evaluations;
  counters_.constraints = stages_->constraints.size();
  counters_.live_runs = stages_->engine.live_runs();
}

}  // namespace docent
