// Retraction of facts that have lost their support. See materialiser.h.
#include <algorithm>
#include <utility>

#include "absl/container/inlined_vector.h"
#include "absl/strings/str_cat.h"
#include "graph/base/step_costs.h"
#include "graph/sparql/run/evaluator.h"
#include "reasoner/rules/materialiser.h"

namespace docent::rules {

absl::Status Materialiser::TakeAwayFromLeavingRules() {
  if (leaving_.empty()) return absl::OkStatus();
  ToOldState();
  absl::Status status;
  for (const uint32_t rule : leaving_) {
    if (before_.rules[rule].of_equality) continue;
    status = FireWhole(before_, rule, Phase::kTakeAway);
    if (!status.ok()) break;
  }
  ToNewState();
  if (before_.equality.by_classes && !program_.equality.by_classes) CollectFactsWithOtherNames();
  check_rows_.clear();
  const std::vector<Triple> made = std::exchange(made_, {});
  for (size_t i = 0; i < made.size() && status.ok(); ++i) status = Consider(made[i]);
  if (status.ok()) RemoveMarked();
  return status;
}

// Facts that were derived within the limit must also be retractable, which may cost more steps: additional
// steps are lent for it, and the rest of the loan is taken back afterwards.
absl::Status Materialiser::TakeAway(int stratum) {
  const uint64_t loan = 2 * context_.limits.steps_per_turn;
  Cancellation* const cancellation = context_.cancellation;
  if (cancellation == nullptr) return TakeAwayLost(stratum);
  const int64_t left = cancellation->steps_left();
  cancellation->Lend(loan);
  absl::Status status = TakeAwayLost(stratum);
  const int64_t spent = static_cast<int64_t>(loan) + (left - cancellation->steps_left());
  cancellation->Spend(loan - std::min(loan, static_cast<uint64_t>(std::max<int64_t>(spent, 0))));
  return status;
}

absl::Status Materialiser::TakeAwayLost(int stratum) {
  made_.clear();
  whole_.clear();
  check_rows_.clear();
  proofs_.Forget();  // because facts were added
  lost_names_.clear();
  if (absl::Status status = EvaluateBefore(stratum); !status.ok()) return status;
  whole_.clear();
  queue_ = lost_;
  ghosts_ = queue_.size();
  marked_.insert(queue_.begin(), queue_.end());
  for (const Triple& triple : std::exchange(made_, {})) {
    if (absl::Status status = Consider(triple); !status.ok()) return status;
  }
  if (absl::Status status = Propagate(stratum); !status.ok()) return status;
  RemoveMarked();
  return absl::OkStatus();
}

// Facts that rules with negation and aggregation made of changed triples of lower strata.
absl::Status Materialiser::EvaluateBefore(int stratum) {
  std::vector<Task> tasks;
  const auto collect = [&](const std::vector<Triple>& triples, matching::Polarity unconcerned) {
    for (const Triple& t : triples) {
      program_.triggers.ForEachMatch(InferredQuad(t), [&](matching::PatternIndex::Reference reference) {
        const CompiledRule& rule = program_.rules[reference.owner];
        if (rule.positive || !program_.Runs(reference.owner, stratum) || is_entering_[reference.owner])
          return;
        if (rule.body->triggers()[reference.pattern].polarity == unconcerned) return;
        tasks.push_back({reference.owner, reference.pattern, t});
      });
    }
  };
  collect(lost_, matching::Polarity::kNegative);
  collect(gained_, matching::Polarity::kPositive);
  if (tasks.empty()) return absl::OkStatus();
  ToOldState();
  absl::Status status;
  for (size_t i = 0; i < tasks.size() && status.ok(); ++i) status = FireTask(tasks[i], Phase::kTakeAway);
  ToNewState();
  return status;
}

// If a body may match two lost triples, or one twice, the others must be present while one is evaluated.
void Materialiser::AddGhosts(int stratum) {
  ghosts_in_graph_ = false;
  if (ghosts_ == 0) return;
  bool needed = ghosts_ > 1;
  for (const uint32_t rule : program_.rules_of_stratum[stratum])
    needed = needed || !program_.rules[rule].positive;
  if (!needed) {
    const Quad quad = InferredQuad(queue_[0]);
    const auto matches_twice = [&](const CompiledRule& rule) {
      const std::vector<matching::Trigger>& triggers = rule.body->triggers();
      return std::count_if(triggers.begin(), triggers.end(),
                           [&](const matching::Trigger& t) { return t.match.Matches(quad); }) > 1;
    };
    program_.triggers.ForEachMatch(quad, [&](matching::PatternIndex::Reference r) {
      needed = needed || matches_twice(program_.rules[r.owner]);
    });
    context_.schema.triggers().ForEachMatch(quad, [&](matching::PatternIndex::Reference r) {
      needed = needed || matches_twice(program_.rules[context_.schema.instance(r.owner).rule]);
    });
  }
  if (!needed) return;
  ghosts_in_graph_ = true;
  std::vector<Quad> quads;
  for (size_t i = 0; i < ghosts_; ++i) quads.push_back(InferredQuad(queue_[i]));
  context_.writer.AddAll(std::move(quads));
}

absl::Status Materialiser::Propagate(int stratum) {
  AddGhosts(stratum);
  for (size_t i = 0; i < queue_.size(); ++i) {
    const Triple triple = queue_[i];
    made_.clear();
    const Quad quad = InferredQuad(triple);
    absl::Status status = DispatchInstances(quad, stratum, Phase::kTakeAway);
    if (status.ok()) status = DispatchRules(quad, stratum, Phase::kTakeAway, /*also_negative=*/i >= ghosts_);
    if (status.ok()) status = LoseEquals(triple);
    if (!status.ok()) return status;
    scratch_ = made_;
    for (const Triple& made : scratch_) {
      status = Consider(made);
      if (!status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

absl::Status Materialiser::Consider(const Triple& triple) {
  Spend(kStepsOfLookup);
  if (context_.cancellation != nullptr) {
    if (absl::Status status = context_.cancellation->Check(); !status.ok()) {
      return absl::Status(status.code(),
                          absl::StrCat("retracting the consequences of withdrawn facts: ", status.message()));
    }
  }
  if (marked_.contains(triple) || !IsInferred(triple)) return absl::OkStatus();
  // Facts added by lower strata are proved by those strata. (Exception: a new axiom at once derives from all
  // facts, also from those of higher strata.)
  if (added_set_.contains(triple) && program_.ordered.empty()) return absl::OkStatus();
  const absl::StatusOr<ProofSearch::Answer> answer = proofs_.Prove(triple);
  if (!answer.ok()) return answer.status();
  if (*answer == ProofSearch::Answer::kProven) return absl::OkStatus();
  marked_.insert(triple);
  queue_.push_back(triple);
  if (*answer == ProofSearch::Answer::kUnproven) {
    if (std::max(stratum_, 0) + 1 < program_.stratum_count) unproven_.push_back(triple);
    return absl::OkStatus();
  }
  // A pair is derived again through its terms, together with all others of its class.
  if (program_.ClosesEquality(stratum_) && triple.predicate == program_.equality.same_as &&
      triple.subject != triple.object && context_.classes.AreEqual(triple.subject, triple.object))
    return absl::OkStatus();
  // Rules of lower strata may make it too, but are done already; rules of higher strata follow later.
  rederivable_.push_back(triple);
  return absl::OkStatus();
}

void Materialiser::RemoveMarked() {
  std::vector<Quad> quads;
  for (size_t i = ghosts_in_graph_ ? 0 : ghosts_; i < queue_.size(); ++i)
    quads.push_back(InferredQuad(queue_[i]));
  Spend(quads.size() * kStepsOfFact);
  context_.writer.RemoveAll(quads);
  absl::flat_hash_set<Triple> not_added;
  for (size_t i = ghosts_; i < queue_.size(); ++i) {
    context_.schema.Lost(queue_[i]);
    (added_set_.contains(queue_[i]) ? not_added : removed_).insert(queue_[i]);
  }
  if (!not_added.empty()) {
    for (std::vector<Triple>* added : {&added_, &gained_}) {
      std::erase_if(*added, [&](const Triple& t) { return not_added.contains(t); });
    }
  }
  SplitShrunk();
  queue_.clear();
  marked_.clear();
  ghosts_ = 0;
  ghosts_in_graph_ = false;
}

absl::StatusOr<bool> Materialiser::IsDerivable(const Triple& triple, int stratum) {
  if (IsWrittenOut(triple)) return true;
  struct Maker {
    uint32_t rule, head;
    const std::vector<TermId>* row;  // of an instance
  };
  absl::InlinedVector<Maker, 8> makers;
  const Quad quad = InferredQuad(triple);
  context_.schema.heads().ForEachMatch(quad, [&](matching::PatternIndex::Reference r) {
    const SchemaIndex::Instance& instance = context_.schema.instance(r.owner);
    makers.push_back({instance.rule, r.pattern, &instance.row});
  });
  program_.heads.ForEachMatch(quad, [&](matching::PatternIndex::Reference r) {
    makers.push_back({r.owner, r.pattern, nullptr});
  });
  const sparql::RunOptions run = Now();
  for (const Maker& maker : makers) {
    const CompiledRule& rule = program_.rules[maker.rule];
    const HeadTriple& head = rule.head[maker.head];
    if (maker.row != nullptr) {
      seed_ = *maker.row;
    } else {
      seed_.assign(rule.body->columns().size(), TermId());
    }
    if (rule.stratum > stratum || (program_.IsEntangled(maker.rule) && program_.StratumOf(triple) > stratum))
      continue;
    if (!head.SeedFrom(triple, absl::MakeSpan(seed_))) continue;
    bool derivable = false;
    const auto visit = [&](absl::Span<const TermId> row) {
      Triple made;
      derivable = head.Make(row, made) && made == triple;
      return !derivable;
    };
    const absl::Status status =
        maker.row != nullptr
            ? rule.body->EvaluateRest(run, seed_, rule.schema, matching::Body::Filters::kAll, visit)
            : rule.body->Evaluate(run, seed_, visit);
    if (!status.ok()) return rule.Named(status);
    if (derivable) return true;
  }
  return false;
}

absl::Status Materialiser::Rederive(int stratum) {
  is_written_out_.clear();
  // A fact without proof may get one when undecided facts return, which rules of higher strata would not
  // notice.
  if (!rederivable_.empty()) {
    rederivable_.insert(rederivable_.end(), unproven_.begin(), unproven_.end());
    unproven_.clear();
  }
  for (const Triple& triple : rederivable_) {
    if (IsPresent(triple)) continue;
    const absl::StatusOr<bool> derivable = IsDerivable(triple, stratum);
    if (!derivable.ok()) return derivable.status();
    if (*derivable && seen_.insert(triple).second) candidates_.push_back(triple);
  }
  return RederivePairs(stratum);
}

// Tests the solutions of checks with negation that may no longer hold.
absl::Status Materialiser::RepeatChecks(int stratum) {
  for (const CheckRow& check : check_rows_) {
    if (program_.rules[check.rule].stratum != stratum) continue;
    seed_ = check.row;
    if (absl::Status status = FireSeeded(check.rule, Phase::kAdd); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace docent::rules
