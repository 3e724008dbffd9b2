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
  ports_.queries->Publish(stages_->writer.Freeze(Revision(head_)));
  ports_.catalog->Publish(stages_->documents.MakeCatalog(stages_->engine));
  teller_.TellAddresses(stages_->writer.current());
  PublishCounters();
  return absl::OkStatus();
}

absl::Status Writer::Replay(const std::function<void(uint64_t, uint64_t)>& progress) {
  changes_.Clear();
  stages_ = std::make_unique<Stages>(ports_.dictionary, ports_.functions, ports_.limits);
  auto head = ports_.log->Head();
  if (!head.ok()) return head.status();
  epoch_ = std::max<uint64_t>(head->epoch, 1);
  head_ = 0;
  ports_.feed->BeginAfter(Revision(head_));
  while (head_ < head->offset) {
    auto entries = ports_.log->Read(head_ + 1, 10000);
    if (!entries.ok()) return entries.status();
    for (const LogEntry& entry : *entries) {
      auto recorded = DecodeTurnRecord(entry.offset, entry.data);
      if (!recorded.ok()) return recorded.status();
      auto derived = RunTurn(stages_.get(), recorded->batch, entry.offset);
      if (!derived.ok()) {
        return absl::DataLossError(
            absl::StrCat("log offset ", entry.offset,
                         ": the recorded batch is refused on replay: ", derived.status().message()));
      }
      if (auto difference = DecisionDifference(*recorded, derived->record)) {
        return absl::DataLossError(absl::StrCat(
            "log offset ", entry.offset, ": replay decides otherwise (recorded by engine version ",
            recorded->engine_version, ", this is ", kEngineVersion, ")\n", *difference));
      }
      requests_.Remember(recorded->batch.request_id, OutcomeOf(*derived));
      ports_.inbox->StartAfter(recorded->time_us);
      ports_.feed->Keep(EventsOf(derived->record));
      head_ = entry.offset;
    }
    if (progress) progress(head_, head->offset);
  }
  return absl::OkStatus();
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
    TakeGroup(std::move(batches));
  }
  teller_.WaitUntilTold();
  ports_.inbox->Close();
  for (PendingBatch& pending : ports_.inbox->PopAll(0, SIZE_MAX)) pending.done(fatal_);
  return fatal_;
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
  for (Decided& decided : group) records.push_back(std::move(decided.record));
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
  Release(std::move(group));
  return absl::OkStatus();
}

// The log refused the group, or cannot say what it did. What it does not have did not happen; what it has
// did.
absl::Status Writer::Reconcile(std::vector<Decided> group, const absl::Status& refusal) {
  spdlog::error("the log refused {} turns: {}", group.size(), std::string(refusal.message()));
  next_tick_us_ = group.back().turn.result.record.time_us + kTickPauseUs;
  const uint64_t head_before = head_;
  teller_.WaitUntilTold();
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
  ports_.queries->Publish(group.back().turn.result.version);
  if (std::any_of(group.begin(), group.end(), [](const Decided& d) { return d.turn.result.documents_changed; })) {
    ports_.catalog->Publish(stages_->documents.MakeCatalog(stages_->engine));
  }
  std::vector<DurableTurn> turns;
  for (Decided& decided : group) {
    TurnResult& result = decided.turn.result;
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
