// Addition of derived facts, and evaluation of rules. See materialiser.h.
#include <algorithm>
#include <utility>

#include "graph/base/step_costs.h"
#include "graph/sparql/run/evaluator.h"
#include "reasoner/rules/materialiser.h"

namespace docent::rules {
namespace {

constexpr size_t kMany = 1 << 17;  // triples

}  // namespace

absl::Status Materialiser::Add(int stratum) {
  seen_.clear();
  candidates_.clear();
  compact_at_ = 0;
  BeginEquality();
  if (absl::Status status = FirstRound(stratum); !status.ok()) return status;
  scope_ = Scope::kAll;
  for (int rounds = 1; !round_.empty(); ++rounds) {
    if (rounds >= context_.limits.rule_rounds) {
      return LimitError(program_.rules[last_rule_], "rule_rounds",
                        static_cast<size_t>(context_.limits.rule_rounds));
    }
    if (absl::Status status = DispatchRound(stratum); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// Matches the triples of the last round with the rules in scope_; their results are the next round.
absl::Status Materialiser::DispatchRound(int stratum) {
  whole_.clear();
  for (const Triple& triple : round_) {
    const Quad quad = InferredQuad(triple);
    absl::Status status = DispatchInstances(quad, stratum, Phase::kAdd);
    if (status.ok()) status = DispatchRules(quad, stratum, Phase::kAdd, /*also_negative=*/true);
    if (!status.ok()) return status;
  }
  return EndRound();
}

// Derives all schema facts of the new schema rules. The remaining rules see them as new.
absl::Status Materialiser::CloseSchema(int stratum) {
  bool any = false;
  for (const uint32_t rule : entering_) {
    if (program_.rules[rule].stratum != stratum || !program_.rules[rule].of_schema ||
        program_.rules[rule].of_equality)
      continue;
    any = true;
    if (absl::Status status = FireWhole(program_, rule, Phase::kAdd); !status.ok()) return status;
  }
  if (!any) return absl::OkStatus();
  scope_ = Scope::kEnteringSchema;
  absl::Status status = EndRound();
  for (int rounds = 1; status.ok() && !round_.empty(); ++rounds) {
    gained_.insert(gained_.end(), round_.begin(), round_.end());
    if (rounds >= context_.limits.rule_rounds) {
      return LimitError(program_.rules[last_rule_], "rule_rounds",
                        static_cast<size_t>(context_.limits.rule_rounds));
    }
    status = DispatchRound(stratum);
  }
  return status;
}

absl::Status Materialiser::FirstRound(int stratum) {
  whole_.clear();
  if (absl::Status status = Rederive(stratum); !status.ok()) return status;
  if (absl::Status status = CloseSchema(stratum); !status.ok()) return status;
  scope_ = Scope::kStaying;
  for (const uint32_t number : entering_) {
    const CompiledRule& rule = program_.rules[number];
    if (!program_.Runs(number, stratum) || (rule.of_schema && rule.stratum == stratum) || rule.of_equality)
      continue;
    const absl::Status status =
        rule.schema != 0 ? FireInstances(number) : FireWhole(program_, number, Phase::kAdd);
    if (!status.ok()) return status;
  }
  if (absl::Status status = RepeatChecks(stratum); !status.ok()) return status;
  std::vector<Task> tasks;
  for (const Triple& t : lost_) {
    program_.triggers.ForEachMatch(InferredQuad(t), [&](matching::PatternIndex::Reference reference) {
      const CompiledRule& rule = program_.rules[reference.owner];
      if (!program_.Runs(reference.owner, stratum) || is_entering_[reference.owner]) return;
      if (rule.body->triggers()[reference.pattern].polarity == matching::Polarity::kPositive) return;
      tasks.push_back({reference.owner, reference.pattern, t});
    });
  }
  for (const Task& task : tasks) {
    if (absl::Status status = FireTask(task, Phase::kAdd); !status.ok()) return status;
  }
  for (const Triple& triple : gained_) {
    const Quad quad = InferredQuad(triple);
    absl::Status status = DispatchInstances(quad, stratum, Phase::kAdd);
    if (status.ok()) status = DispatchRules(quad, stratum, Phase::kAdd, /*also_negative=*/true);
    if (!status.ok()) return status;
  }
  return EndRound();
}

// New facts enter the graph together, so that each index is walked once, in its order.
absl::Status Materialiser::EndRound() {
  if (!TakeMade()) return status_;
  if (absl::Status status = WriteOutEquals(); !status.ok()) return status;
  std::sort(candidates_.begin(), candidates_.end());
  round_.clear();
  std::vector<Quad> quads;
  QuadCursor cursor;
  Spend(candidates_.size() * kStepsOfLookup);
  for (const Triple& t : candidates_) {
    graph().Rescan({t.subject, t.predicate, t.object, TermId()}, &cursor);
    if (cursor.Valid()) continue;
    round_.push_back(t);
    quads.push_back(InferredQuad(t));
  }
  candidates_.clear();
  if (!program_.ordered.empty()) new_facts_.insert(new_facts_.end(), round_.begin(), round_.end());
  for (const Triple& t : round_) {
    if (removed_.erase(t) != 0) continue;
    added_.push_back(t);
    ++context_.inferred_so_far;
  }
  Spend(round_.size() * kStepsOfFact);
  if (absl::Status status = CheckSteps(program_.rules[last_rule_]); !status.ok()) return status;
  if (context_.inferred_so_far > context_.limits.inferred_per_turn) {
    return LimitError(program_.rules[last_rule_], "inferred_per_turn", context_.limits.inferred_per_turn);
  }
  context_.writer.AddAll(std::move(quads));
  context_.classes.Settle();
  for (const Triple& t : round_) {
    if (absl::Status status = context_.schema.Gained(t, graph(), context_.cancellation); !status.ok())
      return status;
  }
  return absl::OkStatus();
}

bool Materialiser::InScope(uint32_t rule) const {
  switch (scope_) {
    case Scope::kAll:
      return true;
    case Scope::kStaying:
      return !is_entering_[rule];
    case Scope::kEnteringSchema:
      return is_entering_[rule] && program_.rules[rule].of_schema;
  }
  return true;
}

absl::Status Materialiser::DispatchInstances(const Quad& quad, int stratum, Phase phase) {
  const sparql::RunOptions run = Now();
  context_.schema.triggers().ForEachMatch(quad, [&](matching::PatternIndex::Reference reference) {
    const SchemaIndex::Instance& instance = context_.schema.instance(reference.owner);
    const CompiledRule& rule = program_.rules[instance.rule];
    if (!program_.Runs(instance.rule, stratum) || !status_.ok()) return;
    if (phase == Phase::kAdd && !InScope(instance.rule)) return;
    const matching::Trigger& trigger = rule.body->triggers()[reference.pattern];
    seed_ = instance.row;
    const std::array<TermId, 3> terms = {quad.subject, quad.predicate, quad.object};
    for (int i = 0; i < 3; ++i) {
      if (trigger.columns[i] != matching::Trigger::kNoColumn) seed_[trigger.columns[i]] = terms[i];
    }
    const uint32_t matched = rule.schema | (1u << trigger.pattern);
    if (matched == rule.patterns && !rule.filters) {
      Emit(rule, seed_, phase);
      return;
    }
    const absl::Status status = rule.body->EvaluateRest(
        run, seed_, matched, rule.filters ? matching::Body::Filters::kAll : matching::Body::Filters::kNone,
        [&](absl::Span<const TermId> row) { return Emit(rule, row, phase); });
    if (!status.ok()) status_ = rule.Named(status);
  });
  return status_;
}

absl::Status Materialiser::DispatchRules(const Quad& quad, int stratum, Phase phase, bool also_negative) {
  const sparql::RunOptions run = Now();
  const Triple triple = {quad.subject, quad.predicate, quad.object};
  program_.triggers.ForEachMatch(quad, [&](matching::PatternIndex::Reference reference) {
    const CompiledRule& rule = program_.rules[reference.owner];
    if (!program_.Runs(reference.owner, stratum) || !status_.ok()) return;
    if (phase == Phase::kAdd && !InScope(reference.owner)) return;
    const matching::Trigger& trigger = rule.body->triggers()[reference.pattern];
    absl::Status status;
    if (!rule.positive) {
      if (!also_negative || trigger.polarity == matching::Polarity::kNegative) return;
      status = FireTask({reference.owner, reference.pattern, triple}, phase);
    } else {
      rule.body->SeedFrom(trigger, quad, seed_);
      const uint32_t matched = 1u << trigger.pattern;
      if (matched == rule.patterns && !rule.filters) {
        Emit(rule, seed_, phase);
        return;
      }
      status = rule.body->EvaluateRest(run, seed_, matched, matching::Body::Filters::kAll,
                                       [&](absl::Span<const TermId> row) { return Emit(rule, row, phase); });
    }
    if (!status.ok()) status_ = rule.Named(status);
  });
  return status_;
}

absl::Status Materialiser::FireTask(const Task& task, Phase phase) {
  matching::Body& body = *program_.rules[task.rule].body;
  body.SeedFrom(body.triggers()[task.trigger], InferredQuad(task.triple), seed_);
  return FireSeeded(task.rule, phase);
}

absl::Status Materialiser::FireSeeded(uint32_t number, Phase phase) {
  const CompiledRule& rule = program_.rules[number];
  // A check reports its whole row: with a seed, a solution that leaves the column open would report the seed.
  for (size_t i = 0; rule.check && i < seed_.size(); ++i) {
    if (!rule.body->columns()[i].certain) seed_[i] = TermId();
  }
  const bool whole = std::all_of(seed_.begin(), seed_.end(), [](TermId id) { return id.IsNone(); });
  if (whole && !whole_.insert(number).second) return absl::OkStatus();
  const absl::Status status =
      rule.body->Evaluate(Now(), seed_, [&](absl::Span<const TermId> row) { return Emit(rule, row, phase); });
  return status.ok() ? status_ : rule.Named(status);
}

absl::Status Materialiser::FireWhole(RuleProgram& program, uint32_t number, Phase phase) {
  const CompiledRule& rule = program.rules[number];
  const std::vector<TermId> nothing(rule.body->columns().size());
  const absl::Status status = rule.body->Evaluate(
      Now(), nothing, [&](absl::Span<const TermId> row) { return Emit(rule, row, phase); });
  return status.ok() ? status_ : rule.Named(status);
}

// Evaluates a rule with a schema part, for each solution of that part.
absl::Status Materialiser::FireInstances(uint32_t number) {
  const CompiledRule& rule = program_.rules[number];
  const auto filters = rule.filters ? matching::Body::Filters::kAll : matching::Body::Filters::kNone;
  absl::Status status;
  context_.schema.ForEachInstance(number, [&](const SchemaIndex::Instance& instance) {
    if (!status.ok() || !status_.ok()) return;
    status = rule.body->EvaluateRest(
        Now(), instance.row, rule.schema, filters,
        [&](absl::Span<const TermId> found) { return Emit(rule, found, Phase::kAdd); });
  });
  return status.ok() ? status_ : rule.Named(status);
}

bool Materialiser::Emit(const CompiledRule& rule, absl::Span<const TermId> row, Phase phase) {
  if (context_.cancellation != nullptr && !rule.body->flat()) {  // what the log has was decided
    if (absl::Status fits = context_.computed.Check(); !fits.ok()) {
      status_ = rule.Named(std::move(fits));
      return false;
    }
  }
  if (rule.check) return EmitReport(rule, row, phase);
  for (const HeadTriple& head : rule.head) {
    Triple triple;
    if (!head.Make(row, triple) || context_.inconsistencies.IsOfReport(triple)) continue;
    if (!MayEmit(rule, triple, phase)) continue;
    if (!Collect(rule, triple, phase)) return false;
  }
  return true;
}

bool Materialiser::EmitReport(const CompiledRule& check, absl::Span<const TermId> row, Phase phase) {
  std::vector<Triple> facts;
  context_.inconsistencies.Make(check, row, facts);
  const auto number = static_cast<uint32_t>(&check - program_.rules.data());
  if (phase == Phase::kTakeAway && !check.positive && number < program_.rules.size()) {
    check_rows_.push_back({number, {row.begin(), row.end()}});
  }
  absl::flat_hash_set<Triple>& these = phase == Phase::kAdd ? new_reports_ : lost_reports_;
  absl::flat_hash_set<Triple>& opposite = phase == Phase::kAdd ? lost_reports_ : new_reports_;
  for (const Triple& fact : facts) {
    if (!Count(check)) return false;
    Spend(kStepsOfLookup);
    const bool changes = opposite.erase(fact) == 0 && IsInferred(fact) == (phase == Phase::kTakeAway);
    if (changes && these.insert(fact).second) Spend(kStepsOfCandidate + kStepsOfFact);
  }
  if (context_.inferred_so_far + new_reports_.size() <= context_.limits.inferred_per_turn) return true;
  status_ = LimitError(check, "inferred_per_turn", context_.limits.inferred_per_turn);
  return false;
}

void Materialiser::WriteReports() {
  std::vector<Quad> lost, made;
  for (const Triple& t : lost_reports_) lost.push_back(InferredQuad(t));
  for (const Triple& t : new_reports_) made.push_back(InferredQuad(t));
  context_.inferred_so_far += made.size();
  context_.writer.RemoveAll(std::move(lost));
  context_.writer.AddAll(std::move(made));
}

bool Materialiser::MayEmit(const CompiledRule& rule, const Triple& triple, Phase phase) {
  if (MayMake(rule, triple, phase)) return true;
  // Its premises may be as before the turn, so that a later stratum would see no change.
  if (phase == Phase::kAdd && removed_.contains(triple) && postponed_.insert(triple).second)
    rederivable_.push_back(triple);
  return false;
}

// Counts a made fact; false: end the evaluation.
bool Materialiser::Count(const CompiledRule& rule) {
  ++context_.counters.firings;
  Spend(seen_.size() < kMany ? kStepsOfHead : kStepsOfHeadAmongMany);
  status_.Update(CheckSteps(rule));
  return status_.ok();
}

bool Materialiser::Collect(const CompiledRule& rule, const Triple& triple, Phase phase) {
  if (!Count(rule)) return false;
  if (phase == Phase::kTakeAway) {
    made_.push_back(triple);
    return true;
  }
  seen_.prefetch(triple);
  made_in_batch_[made_count_++] = {triple, &rule};
  return made_count_ < made_in_batch_.size() || TakeMade();
}

// Makes candidates of the new ones among the made facts. In batches, since most of the time goes into waiting
// for the memory that tells whether a fact is new.
bool Materialiser::TakeMade() {
  const size_t count = std::exchange(made_count_, 0);
  for (size_t i = 0; i < count; ++i) {
    const auto& [triple, rule] = made_in_batch_[i];
    if (!seen_.insert(triple).second) continue;
    Spend(kStepsOfCandidate);
    candidates_.push_back(triple);
    last_rule_ = static_cast<uint32_t>(rule - program_.rules.data());
    if (candidates_.size() >= compact_at_ && !DropPresent(*rule)) return false;
  }
  return true;
}

// Many candidates may be in the graph already; and beyond the limit none need be collected.
bool Materialiser::DropPresent(const CompiledRule& rule) {
  const size_t room = context_.limits.inferred_per_turn > context_.inferred_so_far
                          ? context_.limits.inferred_per_turn - context_.inferred_so_far
                          : 0;
  if (compact_at_ == 0) {
    compact_at_ = room + 1024;
    if (candidates_.size() < compact_at_) return true;
  }
  std::erase_if(candidates_, [&](const Triple& t) { return IsPresent(t); });
  compact_at_ = std::max(room + 1024, 2 * candidates_.size());
  if (candidates_.size() <= room + removed_.size()) return true;
  status_ = LimitError(rule, "inferred_per_turn", context_.limits.inferred_per_turn);
  return false;
}

}  // namespace docent::rules
