#include "reasoner/rules/materialiser.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/sparql/run/evaluator.h"

namespace docent::rules {
namespace {

constexpr int kMostPasses = 16;   // the axioms exist after one pass
constexpr int kAskingPasses = 8;  // after these the order ignores the answers of the graph

}  // namespace

Materialiser::Materialiser(RuleProgram& program, RuleProgram& before, const Delta& told,
                           const Context& context)
    : program_(program),
      before_(before),
      asserted_delta_(told),
      context_(context),
      proofs_(program, context.schema, context.classes, context.writer, context.inferred_graph, marked_,
              context.cancellation),
      is_entering_(program.rules.size()) {}

// Sorted, so that the lookups walk along the index. Without told facts of reports, which no rule sees either.
void Materialiser::ReadAsserted() {
  struct Change {
    Triple triple;
    int by;
  };
  std::vector<Change> changes;
  changes.reserve(asserted_delta_.size());
  for (const auto& [quads, by] : {std::pair(&asserted_delta_.added, 1), {&asserted_delta_.removed, -1}}) {
    for (const Quad& q : *quads) {
      const Triple triple = {q.subject, q.predicate, q.object};
      if (!context_.inconsistencies.IsOfReport(triple)) changes.push_back({triple, by});
    }
  }
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.triple < b.triple; });
  QuadCursor cursor;
  for (size_t i = 0; i < changes.size();) {
    AssertedEntry entry{changes[i].triple};
    int net = 0;
    for (; i < changes.size() && changes[i].triple == entry.triple; ++i) net += changes[i].by;
    int graphs = 0;
    const QuadPattern pattern = {entry.triple.subject, entry.triple.predicate, entry.triple.object, TermId()};
    for (graph().Rescan(pattern, &cursor); cursor.Valid(); cursor.Next()) {
      if (cursor.quad().graph == context_.inferred_graph) {
        entry.inferred_before = true;
      } else {
        ++graphs;
      }
    }
    entry.now = graphs > 0;
    entry.before = graphs - net > 0;
    if (entry.now != entry.before) asserted_.push_back(entry);
  }
}

// If an inferred triple is now asserted, the inferred copy is removed: no net change. If a triple is no
// longer asserted but still follows from others, it becomes inferred: no net change either.
absl::Status Materialiser::SettleAsserted() {
  std::vector<Quad> now_told;
  for (const AssertedEntry& entry : asserted_) {
    if (entry.now && entry.inferred_before) {
      now_told.push_back(InferredQuad(entry.triple));
      removed_.insert(entry.triple);
    }
    if (entry.now != (entry.before || entry.inferred_before)) {
      if (!entry.now) {
        context_.schema.Lost(entry.triple);
      } else if (absl::Status status = context_.schema.Gained(entry.triple, graph(), context_.cancellation);
                 !status.ok()) {
        return status;
      }
    }
  }
  context_.writer.RemoveAll(now_told);
  std::vector<Triple> unproven;
  bool any_proven = false;
  for (const AssertedEntry& entry : asserted_) {
    if (entry.now || entry.inferred_before) continue;
    const absl::StatusOr<ProofSearch::Answer> answer = proofs_.Prove(entry.triple);
    if (!answer.ok()) return answer.status();
    if (*answer == ProofSearch::Answer::kProven) {
      any_proven = true;
      context_.writer.Add(InferredQuad(entry.triple));
      NowInferred(entry.triple);
      proofs_.Forget();
      if (absl::Status status = context_.schema.Gained(entry.triple, graph(), context_.cancellation);
          !status.ok())
        return status;
    } else if (*answer == ProofSearch::Answer::kUndecided) {
      any_proven = true;  // it may hold again
      rederivable_.push_back(entry.triple);
    } else {
      unproven.push_back(entry.triple);
    }
  }
  // A triple tested before another became inferred may follow from that one.
  for (const Triple& triple : unproven) {
    if (!any_proven) break;
    rederivable_.push_back(triple);
  }
  return absl::OkStatus();
}

// Checks of one name may make the same report, so all of them are evaluated again if one leaves.
void Materialiser::CompareRules() {
  if (&program_ == &before_) return;
  absl::flat_hash_set<std::string> known, wanted, reports;
  const auto key = [](const CompiledRule& rule) {
    const bool named = !rule.check || !rule.name.empty();  // else its reports have its label, and so its line
    return absl::StrCat(rule.set, "\n", named ? "" : rule.label, "\n", rule.text);
  };
  const auto name = [](const CompiledRule& rule) { return absl::StrCat(rule.set, "\n", rule.name); };
  for (const CompiledRule& rule : before_.rules) known.insert(key(rule));
  for (const CompiledRule& rule : program_.rules) wanted.insert(key(rule));
  for (const CompiledRule& rule : before_.rules) {
    if (rule.check && !wanted.contains(key(rule))) reports.insert(name(rule));
  }
  const auto again = [&](const CompiledRule& rule) { return rule.check && reports.contains(name(rule)); };
  for (uint32_t r = 0; r < program_.rules.size(); ++r) {
    const CompiledRule& rule = program_.rules[r];
    if (known.contains(key(rule)) && !again(rule)) continue;
    entering_.push_back(r);
    is_entering_[r] = true;
  }
  for (uint32_t r = 0; r < before_.rules.size(); ++r) {
    const CompiledRule& rule = before_.rules[r];
    if (!wanted.contains(key(rule)) || again(rule)) leaving_.push_back(r);
  }
}

void Materialiser::ToOldState() {
  if (old_state_) return;
  old_state_ = true;
  GraphWriter& writer = context_.writer;
  writer.RemoveAll(asserted_delta_.added);
  writer.AddAll(asserted_delta_.removed);
  for (const Triple& t : added_) writer.Remove(InferredQuad(t));
  for (const Triple& t : removed_) writer.Add(InferredQuad(t));
}

void Materialiser::ToNewState() {
  if (!old_state_) return;
  old_state_ = false;
  GraphWriter& writer = context_.writer;
  writer.RemoveAll(asserted_delta_.removed);
  writer.AddAll(asserted_delta_.added);
  for (const Triple& t : removed_) writer.Remove(InferredQuad(t));
  for (const Triple& t : added_) writer.Add(InferredQuad(t));
}

void Materialiser::CollectChanges(int stratum) {
  lost_.clear();
  gained_.clear();
  const auto note = [&](const Triple& t, bool before, bool now) {
    if (before && !now) lost_.push_back(t);
    if (!before && now) gained_.push_back(t);
  };
  if (stratum == 0 && added_.empty() && removed_.empty()) {
    for (const AssertedEntry& entry : asserted_)
      note(entry.triple, entry.before || entry.inferred_before, entry.now);
    return;
  }
  const auto told = [&](const Triple& t) -> const AssertedEntry* {
    const auto place = std::lower_bound(asserted_.begin(), asserted_.end(), t,
                                        [](const AssertedEntry& e, const Triple& x) { return e.triple < x; });
    return place != asserted_.end() && place->triple == t ? &*place : nullptr;
  };
  for (const AssertedEntry& entry : asserted_) {
    note(entry.triple, entry.before || entry.inferred_before, IsPresent(entry.triple));
  }
  for (const Triple& t : added_) {
    if (told(t) == nullptr) note(t, false, true);
  }
  std::vector<Triple> removed(removed_.begin(), removed_.end());
  std::sort(removed.begin(), removed.end());
  for (const Triple& t : removed) {
    if (told(t) == nullptr) note(t, true, IsPresent(t));
  }
  added_set_.clear();
  added_set_.insert(added_.begin(), added_.end());
}

void Materialiser::NowInferred(const Triple& t) {
  if (removed_.erase(t) == 0) added_.push_back(t);
}

absl::Status Materialiser::LimitError(const CompiledRule& rule, const char* limit, size_t value) const {
  return absl::ResourceExhaustedError(
      absl::StrCat(rule.label, " goes beyond the limit ", limit, " = ", value,
                   "; the batch was not applied. Does the rule feed itself?"));
}

absl::Status Materialiser::Maintain() {
  CompareRules();
  ReadAsserted();
  if (absl::Status status = SettleAsserted(); !status.ok()) return status;
  PlaceNegation(AskAxioms::kGraph)
      .status()
      .IgnoreError();  // by the current axioms; below by the remaining ones
  if (absl::Status status = TakeAwayFromLeavingRules(); !status.ok()) return status;
  for (stratum_ = 0; stratum_ < program_.stratum_count; ++stratum_) {
    if (absl::Status status = MaintainStratum(); !status.ok()) return status;
    if (stratum_ != program_.first_entangled || program_.ordered.empty()) continue;
    // Axioms were added or removed: with the new ones the facts of this stratum may differ.
    absl::StatusOr<bool> moved = PlaceNegation(AskAxioms::kGraph);
    for (int passes = 0; moved.ok() && *moved;
         moved = PlaceNegation(passes < kAskingPasses ? AskAxioms::kGraph : AskAxioms::kNothing)) {
      if (++passes > kMostPasses)
        return absl::InternalError("rules with negation find no order; the batch was not applied");
      TakeBackEarly();
      if (absl::Status status = MaintainStratum(); !status.ok()) return status;
    }
    if (!moved.ok()) return moved.status();
  }
  WriteReports();
  return absl::OkStatus();
}

absl::Status Materialiser::MaintainStratum() {
  CollectChanges(stratum_);
  absl::Status status = TakeAway(stratum_);
  return status.ok() ? Add(stratum_) : status;
}

absl::StatusOr<bool> Materialiser::PlaceNegation(AskAxioms ask) {
  if (program_.ordered.empty()) return false;
  const uint64_t changes = context_.schema.changes() + context_.classes.changes();
  if (program_.placed_for == changes && KnowsAnswers(program_.order(), graph())) return false;
  absl::StatusOr<NegationOrder> order =
      OrderNegation(program_, context_.schema, context_.classes, graph(), context_.dictionary, asked_, ask);
  if (!order.ok()) return order.status();
  if (stratum_ >= 0) {
    for (const auto& [about, answers] : order->asked) asked_[about] = answers;
  }
  program_.placed_for = changes;
  return program_.Place(*std::move(order));
}

// Removes facts that belong to later strata in the new order; those strata derive them again if they still
// follow.
void Materialiser::TakeBackEarly() {
  absl::flat_hash_set<Triple> early;
  for (const Triple& t : new_facts_) {
    if (program_.StratumOf(t) > stratum_ && IsInferred(t)) early.insert(t);
  }
  std::vector<Quad> quads;
  for (const Triple& t : early) {
    quads.push_back(InferredQuad(t));
    rederivable_.push_back(t);
    context_.schema.Lost(t);
    removed_.insert(t);
  }
  std::erase_if(added_, [&](const Triple& t) {
    if (!early.contains(t)) return false;
    removed_.erase(t);  // it was not there before the turn
    return true;
  });
  context_.writer.RemoveAll(std::move(quads));
}

Delta Materialiser::InferredChange() const {
  Delta delta;
  delta.added.reserve(added_.size());
  for (const Triple& triple : added_) delta.added.push_back(InferredQuad(triple));
  for (const Triple& triple : removed_) delta.removed.push_back(InferredQuad(triple));
  const size_t reports = delta.added.size();
  for (const Triple& triple : new_reports_) delta.added.push_back(InferredQuad(triple));
  std::sort(delta.added.begin() + static_cast<std::ptrdiff_t>(reports), delta.added.end());
  for (const Triple& triple : lost_reports_) delta.removed.push_back(InferredQuad(triple));
  std::sort(delta.removed.begin(), delta.removed.end());
  return delta;
}

}  // namespace docent::rules
