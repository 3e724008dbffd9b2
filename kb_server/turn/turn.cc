#include "kb_server/turn/turn.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/log/record_codec.h"
#include "graph/store/delta_sum.h"
#include "kb_server/turn/fact_port.h"

namespace docent::server {
namespace {

template <typename T>
void Append(std::vector<T>&& from, std::vector<T>* to) {
  to->insert(to->end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

void Record(engine::EngineOutput* output, TurnResult* result) {
  Append(std::move(output->transitions), &result->record.transitions);
  Append(std::move(output->commands), &result->record.commands);
  Append(std::move(output->cancels), &result->cancels);
  Append(std::move(output->recalls), &result->recalls);
  Append(std::move(output->notifications), &result->notifications);
  Append(std::move(output->started), &result->started);
  Append(std::move(output->nested), &result->nested);
  Append(std::move(output->undeployed), &result->undeployed);
  Append(std::move(output->steered), &result->steered);
}

// What follows from events that left the graph since they are over or told again: conditions see them go before they come back.
absl::StatusOr<Delta> FollowWithdrawal(Stages* stages, Delta withdrawn, TimeMicros now_us, DeltaSum* sum) {
  if (withdrawn.empty()) return withdrawn;
  absl::StatusOr<Delta> delta = stages->rules.Update(stages->writer, withdrawn, stages->cancellation);
  if (!delta.ok()) return delta.status();
  stages->applier.Learn(*delta);
  sum->Add(*delta);
  auto changes =
      stages->standing_conditions.Update(stages->writer.current(), *delta, now_us, stages->cancellation);
  if (!changes.ok()) return changes.status();
  stages->conditions.Take(*changes, now_us);
  return delta;
}

// What of a round's writes is told now: of an event that is told twice, the second telling is of the next round, as is its
// withdrawal. Where a turn has gone on for long, such tellings are one.
size_t WritesOfRound(const Stages& stages, absl::Span<const engine::FactWrite> writes, int round) {
  if (round >= stages.limits.engine_rounds_per_turn / 2) return writes.size();
  return EventShelf::OneTelling(writes, stages.applier);
}

// What the stages behind the conditions see in the first round.
Delta Both(const Delta& withdrawn, Delta delta) {
  delta.added.insert(delta.added.end(), withdrawn.added.begin(), withdrawn.added.end());
  delta.removed.insert(delta.removed.end(), withdrawn.removed.begin(), withdrawn.removed.end());
  return delta;
}

absl::StatusOr<Delta> ApplyToStore(Stages* stages, const WriteBatch& batch, uint64_t offset) {
  // Without a cancellation the log is replayed, whose texts were accepted.
  const rules::RuleTextOrigin origin =
      stages->cancellation != nullptr ? rules::RuleTextOrigin::kNew : rules::RuleTextOrigin::kAccepted;
  const DocumentStages documents{
      &stages->rules, &stages->engine, stages->dictionary, stages->writer.current(),
      stages->limits, origin,          batch.time_us};
  absl::StatusOr<std::vector<QuadOperation>> brought_about =
      stages->documents.Apply(batch, Revision(offset), documents);
  if (!brought_about.ok()) return brought_about.status();
  return stages->applier.Apply(batch, stages->writer, *brought_about);
}

absl::Status Decide(Stages* stages, const WriteBatch& given, uint64_t offset, TurnResult* result) {
  stages->applier.Announce(given, stages->writer.current());
  const std::optional<WriteBatch> named = stages->events.WithOwnNames(given, stages->applier, offset);
  const WriteBatch& batch = named ? *named : given;
  stages->robots.Refresh(stages->writer.current(), {});  // requests are checked on the graph before the turn
  const engine::RobotDirectory* robots = stages->cancellation != nullptr ? &stages->robots : nullptr;
  for (const RunRequest& request : batch.run_requests) {  // what the log has was accepted
    if (absl::Status status = stages->engine.CheckRequest(request, robots); !status.ok()) return status;
  }

  const auto allow_steps = [stages] {
    if (stages->cancellation != nullptr)
      stages->cancellation->AllowSteps(stages->limits.StepsOfTurn(stages->writer.current().size()));
  };
  DeltaSum sum;
  allow_steps();
  absl::StatusOr<Delta> withdrawn = FollowWithdrawal(
      stages, stages->events.Withdraw(batch, &stages->applier, &stages->writer), batch.time_us, &sum);
  if (!withdrawn.ok()) return withdrawn.status();
  const std::vector<Quad> left_first = withdrawn->removed;
  absl::StatusOr<Delta> delta = ApplyToStore(stages, batch, offset);  // store
  if (!delta.ok()) return delta.status();
  std::vector<Quad> told_events = stages->applier.told_events();
  const auto told_facts_of = [&](const Delta& of) {
    return told_events.empty() && stages->events.events().empty() ? Delta() : of;
  };
  Delta told_facts = told_facts_of(*delta);
  std::vector<engine::FactWrite> writes;  // of runs, that are to be told
  allow_steps();

  const FactPort facts(&stages->dictionary, &stages->writer.current(), stages->functions, batch.time_us,
                       offset, stages->cancellation);
  for (int round = 0;; ++round) {
    if (round == stages->limits.engine_rounds_per_turn) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "workflows went on for ", round, " rounds in one turn; the limit engine_rounds_per_turn is ",
          stages->limits.engine_rounds_per_turn, "; look for a loop without a wait"));
    }
    if (stages->cancellation != nullptr) {
      if (absl::Status status = stages->cancellation->CheckNow(); !status.ok()) return status;
    }
    size_t told = delta->size();
    delta = stages->rules.Update(stages->writer, *delta, stages->cancellation);  // rules, to a fixpoint
    if (!delta.ok()) return delta.status();
    stages->applier.Learn(*delta);
    result->inferred += delta->size() - std::min(told, delta->size());
    sum.Add(*delta);
    stages->events.Take(told_events, told_facts, stages->writer.current(), offset);

    const GraphVersion& graph = stages->writer.current();
    auto changes = stages->standing_conditions.Update(graph, *delta, batch.time_us,
                                                      stages->cancellation);  // standing conditions
    if (!changes.ok()) return changes.status();
    stages->conditions.Take(*changes, batch.time_us);
    stages->conditions.BeginRound(graph, batch.time_us, stages->cancellation);

    if (!withdrawn->empty())
      stages->robots.Refresh(graph, Both(*withdrawn, *delta));
    else
      stages->robots.Refresh(graph, *delta);
    stages->ranking.BeginRound(graph, {&*withdrawn, &*delta}, batch.time_us, stages->cancellation);
    engine::EngineInput view;
    view.now_us = batch.time_us;
    view.revision = Revision(offset);
    view.clock_tick = batch.clock_tick;
    view.reports = round == 0 ? &batch.reports : nullptr;
    view.requests = round == 0 ? &batch.run_requests : nullptr;
    view.events = &stages->events.news();
    view.conditions = &stages->conditions;
    view.robots = &stages->robots;
    view.facts = &facts;
    view.ranking = &stages->ranking;
    view.untold = &writes;
    engine::EngineOutput output = stages->engine.Step(view);  // workflow engine
    if (!output.refused.ok()) return output.refused;
    if (stages->cancellation != nullptr) {  // it took what it could get
      if (absl::Status status = stages->cancellation->CheckNow(); !status.ok()) return status;
    }
    const bool quiet = output.quiet();
    Record(&output, result);
    stages->conditions.Disarm(output.disarm);
    if (absl::Status armed = stages->conditions.Arm(output.arm, graph, batch.time_us, stages->cancellation);
        !armed.ok()) {
      return armed;
    }
    if (quiet) break;
    writes = std::move(output.writes);
    const size_t told_now = WritesOfRound(*stages, writes, round);
    const absl::Span<const engine::FactWrite> tell(writes.data(), told_now);
    withdrawn = FollowWithdrawal(stages, stages->events.Withdraw(tell, &stages->applier, &stages->writer),
                                 batch.time_us, &sum);
    if (!withdrawn.ok()) return withdrawn.status();
    // seen by rules and conditions in this same turn
    delta = stages->writer.Apply(output.add, output.remove);
    told_events.clear();
    if (absl::Status written =
            ApplyWrites(tell, batch.time_us, &stages->applier, &stages->writer, &*delta, &told_events);
        !written.ok()) {
      return written;
    }
    told_facts = told_facts_of(*delta);
    for (engine::FactWrite& write : absl::MakeSpan(writes.data(), told_now)) {
      if (write.tells) result->record.told.push_back({std::move(write.by), std::move(write.quad)});
    }
    writes.erase(writes.begin(), writes.begin() + static_cast<ptrdiff_t>(told_now));
  }
  stages->events.Settle(stages->engine.AwaitedEvents(), stages->writer.current(), batch.time_us);
  result->delta = sum.Net();
  const GraphVersion& after = stages->writer.current();
  result->told_again =
      static_cast<size_t>(std::count_if(left_first.begin(), left_first.end(), [&after](const Quad& quad) {
        return after.ContainsMatch({quad.subject, quad.predicate, quad.object, quad.graph});
      }));
  result->addresses = stages->robots.AddressesIn(result->delta, after);
  return absl::OkStatus();
}

absl::Status Encode(const log::TurnRecord& record, const Limits& limits, std::string* bytes) {
  absl::StatusOr<std::string> encoded = log::EncodeTurnRecord(record);
  if (!encoded.ok()) return encoded.status();
  if (encoded->size() > limits.record_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the turn's record has ", encoded->size(),
                                                     " bytes; the limit record_bytes is ",
                                                     limits.record_bytes, "; send smaller batches"));
  }
  *bytes = *std::move(encoded);
  return absl::OkStatus();
}

}  // namespace

void Stages::Commit() {
  writer.Commit();
  applier.Commit();
  events.Commit();
  rules.Commit();
  standing_conditions.Commit();
  conditions.Commit();
  engine.Commit();
  documents.Commit();
  dictionary.KeepTurn();
}

void Stages::Rollback() {
  writer.Rollback();
  applier.Rollback();
  events.Rollback();
  rules.Rollback();
  conditions.Rollback();
  robots.Rollback();
  standing_conditions.Rollback();
  engine.Rollback();
  documents.Rollback();
  ranking.Rollback();
  dictionary.DropTurn();  // last: no stage has ids of its terms any more
}

std::optional<TimeMicros> Stages::NextDeadline() const {
  std::optional<TimeMicros> next;
  for (const std::optional<TimeMicros>& due :
       {applier.NextDeadline(), events.NextDeadline(), conditions.NextDeadline(), engine.NextDeadline()}) {
    if (due && (!next || *due < *next)) next = due;
  }
  return next;
}

absl::StatusOr<TurnResult> RunTurn(Stages* stages, WriteBatch batch, uint64_t offset,
                                   std::string* record_bytes) {
  TurnResult result;
  stages->dictionary.BeginTurn();
  absl::Status status = Decide(stages, batch, offset, &result);
  if (status.ok()) {
    result.documents_changed = !batch.documents.empty();
    result.record.offset = offset;
    result.record.time_us = batch.time_us;
    result.record.engine_version = kEngineVersion;
    result.record.batch = std::move(batch);
    // Before the stages commit: a record that is too large for the log is refused alone, not with its group.
    if (record_bytes != nullptr) status = Encode(result.record, stages->limits, record_bytes);
  }
  if (!status.ok()) {
    stages->Rollback();
    return status;
  }
  stages->Commit();
  if (stages->freezes) result.version = stages->writer.Freeze(Revision(offset));
  return result;
}

}  // namespace docent::server
