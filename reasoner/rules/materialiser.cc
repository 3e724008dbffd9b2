#include "reasoner/rules/materialiser.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "kb_server/sparql/evaluator.h"

namespace docent {

Materialiser::Materialiser(RuleProgram& program, GraphWriter& writer, const Delta& told,
                           TermId inferred_graph, const Limits& limits, size_t& inferred_so_far,
                           RuleEngine::Counters& counters)
    : program_(program),
      writer_(writer),
      told_(told),
      inferred_graph_(inferred_graph),
      limits_(limits),
      inferred_so_far_(inferred_so_far),
      counters_(counters),
      strata_(static_cast<size_t>(program.stratum_count)) {}

size_t Materialiser::ToldGraphs(const Triple& t) const {
  size_t count = 0;
  for (QuadCursor c = writer_.current().Scan({t.subject, t.predicate, t.object, TermId()}); c.Valid();
       c.Next()) {
    if (c.quad().graph != inferred_graph_) ++count;
  }
  return count;
}

// Correct in the old state too: what is told has changed only as told_changes_ says.
bool Materialiser::ToldNow(const Triple& t) const {
  const auto found = told_changes_.find(t);
  return found == told_changes_.end() ? ToldGraphs(t) > 0 : found->second.now;
}

bool Materialiser::ToldBefore(const Triple& t) const {
  const auto found = told_changes_.find(t);
  return found == told_changes_.end() ? ToldGraphs(t) > 0 : found->second.before;
}

bool Materialiser::InferredBefore(const Triple& t) const {
  const auto found = changes_.find(t);
  return found == changes_.end() ? IsInferred(t) : !found->second;
}

void Materialiser::CollectToldChanges() {
  for (const Quad& q : told_.added) ++told_changes_[{q.subject, q.predicate, q.object}].added;
  for (const Quad& q : told_.removed) ++told_changes_[{q.subject, q.predicate, q.object}].removed;
  for (auto& [triple, change] : told_changes_) {
    const auto graphs = static_cast<int>(ToldGraphs(triple));
    change.now = graphs > 0;
    change.before = graphs - change.added + change.removed > 0;
  }
}

void Materialiser::Change(const Triple& t, bool add) {
  if (add) {
    writer_.Add(InferredQuad(t));
  } else {
    writer_.Remove(InferredQuad(t));
  }
  const auto [place, fresh] = changes_.try_emplace(t, add);
  if (!fresh) changes_.erase(place);  // there and back again
  touched_.push_back(t);
}

void Materialiser::ToOldState() {
  for (const Quad& q : told_.added) writer_.Remove(q);
  for (const Quad& q : told_.removed) writer_.Add(q);
  for (const auto& [triple, added] : changes_) {
    if (added) {
      writer_.Remove(InferredQuad(triple));
    } else {
      writer_.Add(InferredQuad(triple));
    }
  }
}

void Materialiser::ToNewState() {
  for (const Quad& q : told_.removed) writer_.Remove(q);
  for (const Quad& q : told_.added) writer_.Add(q);
  for (const auto& [triple, added] : changes_) {
    if (added) {
      writer_.Add(InferredQuad(triple));
    } else {
      writer_.Remove(InferredQuad(triple));
    }
  }
}

void Materialiser::Announce(const Triple& triple, bool gained, int from) {
  program_.triggers.ForEachMatch(InferredQuad(triple), [&](PatternIndex::Reference reference) {
    const CompiledRule& rule = program_.rules[reference.owner];
    if (rule.stratum < from) return;
    const Polarity polarity = rule.body->triggers()[reference.pattern].polarity;
    Stratum& stratum = strata_[rule.stratum];
    const Task task{reference.owner, reference.pattern, triple};
    if (polarity == Polarity::kBoth || (polarity == Polarity::kPositive) == gained)
      stratum.added.push_back(task);
    if (polarity == Polarity::kBoth || (polarity == Polarity::kPositive) != gained)
      stratum.lost.push_back(task);
  });
}

// Within a stratum there is no negation.
void Materialiser::AnnounceWithin(const Triple& triple, int stratum, std::vector<Task>& tasks) {
  program_.triggers.ForEachMatch(InferredQuad(triple), [&](PatternIndex::Reference reference) {
    if (program_.rules[reference.owner].stratum != stratum) return;
    tasks.push_back({reference.owner, reference.pattern, triple});
  });
}

// What this stratum changed in the end is the higher strata's affair.
void Materialiser::AnnounceHigher(int stratum) {
  for (const Triple& t : touched_) {
    const bool before = InferredBefore(t) || ToldBefore(t);
    const bool now = IsInferred(t) || ToldNow(t);
    if (before == now) continue;
    const auto [place, fresh] = announced_.try_emplace(t, now);
    if (!fresh && place->second == now) continue;
    place->second = now;
    Announce(t, now, stratum + 1);
  }
  touched_.clear();
}

absl::Status Materialiser::LimitError(uint32_t rule, const char* limit, size_t value) const {
  return absl::ResourceExhaustedError(
      absl::StrCat(program_.rules[rule].label, " goes beyond the limit ", limit, " = ", value,
                   "; the batch was not applied. Does the rule feed itself?"));
}

absl::Status Materialiser::Fire(uint32_t rule, absl::Span<const TermId> seed, Phase phase) {
  const CompiledRule& compiled = program_.rules[rule];
  const sparql::RunOptions run{.version = &writer_.current()};
  const size_t room =
      limits_.inferred_per_turn > inferred_so_far_ ? limits_.inferred_per_turn - inferred_so_far_ : 0;
  size_t compact_at = 1024;
  made_.clear();
  return compiled.body->Evaluate(run, seed, [&](absl::Span<const TermId> row) {
    for (const HeadTriple& head : compiled.head) {
      Triple triple;
      if (!head.Make(row, triple)) continue;
      ++counters_.firings;
      const bool wanted = phase == Phase::kAdd ? !IsInferred(triple) : IsInferred(triple);
      if (wanted) made_.push_back(triple);
    }
    if (made_.size() < compact_at) return true;
    // Many rows may make the same triple; and what is beyond the limit anyway need not be collected.
    std::sort(made_.begin(), made_.end());
    made_.erase(std::unique(made_.begin(), made_.end()), made_.end());
    compact_at = 2 * made_.size() + 1024;
    return phase != Phase::kAdd || made_.size() <= room;
  });
}

absl::Status Materialiser::Infer(const Triple& triple, uint32_t rule, int stratum) {
  if (IsInferred(triple)) return absl::OkStatus();
  if (++inferred_so_far_ > limits_.inferred_per_turn) {
    return LimitError(rule, "inferred_per_turn", limits_.inferred_per_turn);
  }
  Change(triple, true);
  if (!ToldNow(triple)) AnnounceWithin(triple, stratum, strata_[stratum].added);
  return absl::OkStatus();
}

absl::Status Materialiser::Overdelete(int stratum) {
  std::vector<Task>& tasks = strata_[stratum].lost;
  if (tasks.empty()) return absl::OkStatus();
  std::vector<Triple> marked;
  absl::flat_hash_set<uint32_t> evaluated_whole;
  ToOldState();
  absl::Status status;
  for (size_t i = 0; i < tasks.size() && status.ok(); ++i) {
    const Task task = tasks[i];
    Body& body = *program_.rules[task.rule].body;
    body.SeedFrom(body.triggers()[task.trigger], InferredQuad(task.triple), seed_);
    const bool whole = std::all_of(seed_.begin(), seed_.end(), [](TermId id) { return id.IsNone(); });
    if (whole && !evaluated_whole.insert(task.rule).second) continue;
    status = Fire(task.rule, seed_, Phase::kOverdelete);
    for (const Triple& triple : made_) {
      if (!overdeleted_.insert(triple).second) continue;
      marked.push_back(triple);
      if (!ToldNow(triple)) AnnounceWithin(triple, stratum, tasks);
    }
  }
  ToNewState();
  for (const Triple& triple : marked) {
    Change(triple, false);

    // Rules of lower strata may make it too, and are done already; those of higher ones have their turn
    // later.
    strata_[stratum].rederivable.push_back(triple);
    program_.heads.ForEachMatch(InferredQuad(triple), [&](PatternIndex::Reference reference) {
      const int other = program_.rules[reference.owner].stratum;
      if (other > stratum) strata_[other].rederivable.push_back(triple);
    });
  }
  return status;
}

absl::StatusOr<bool> Materialiser::IsDerivable(const Triple& triple, int stratum) {
  std::vector<PatternIndex::Reference> makers;
  program_.heads.ForEachMatch(InferredQuad(triple),
                              [&](PatternIndex::Reference reference) { makers.push_back(reference); });
  const sparql::RunOptions run{.version = &writer_.current()};
  for (const auto& [rule, head_number] : makers) {
    const CompiledRule& compiled = program_.rules[rule];
    const HeadTriple& head = compiled.head[head_number];
    if (compiled.stratum > stratum || !head.SeedFrom(triple, compiled.body->columns().size(), seed_))
      continue;
    bool derivable = false;
    const absl::Status status = compiled.body->Evaluate(run, seed_, [&](absl::Span<const TermId> row) {
      Triple made;
      derivable = head.Make(row, made) && made == triple;
      return !derivable;
    });
    if (!status.ok()) return status;
    if (derivable) return true;
  }
  return false;
}

absl::Status Materialiser::Rederive(int stratum) {
  for (const Triple& triple : strata_[stratum].rederivable) {
    if (IsInferred(triple)) continue;
    const absl::StatusOr<bool> derivable = IsDerivable(triple, stratum);
    if (!derivable.ok()) return derivable.status();
    if (!*derivable) continue;
    Change(triple, true);
    if (!ToldNow(triple)) AnnounceWithin(triple, stratum, strata_[stratum].added);
  }
  return absl::OkStatus();
}

absl::Status Materialiser::Add(int stratum) {
  std::vector<Task>& tasks = strata_[stratum].added;
  absl::flat_hash_map<uint32_t, size_t>
      whole_at;  // rule → tasks below this are covered by a whole evaluation
  size_t round_end = tasks.size();
  int rounds = 1;
  for (size_t i = 0; i < tasks.size(); ++i) {
    const Task task = tasks[i];
    if (i == round_end) {
      round_end = tasks.size();
      if (++rounds > limits_.rule_rounds) {
        return LimitError(task.rule, "rule_rounds", static_cast<size_t>(limits_.rule_rounds));
      }
    }
    const auto whole = whole_at.find(task.rule);
    if (whole != whole_at.end() && i < whole->second) continue;
    Body& body = *program_.rules[task.rule].body;
    body.SeedFrom(body.triggers()[task.trigger], InferredQuad(task.triple), seed_);
    if (std::all_of(seed_.begin(), seed_.end(), [](TermId id) { return id.IsNone(); })) {
      whole_at[task.rule] = tasks.size();
    }
    if (absl::Status status = Fire(task.rule, seed_, Phase::kAdd); !status.ok()) return status;
    for (const Triple& triple : made_) {
      if (absl::Status status = Infer(triple, task.rule, stratum); !status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

absl::Status Materialiser::Maintain() {
  CollectToldChanges();
  for (const auto* quads : {&told_.added, &told_.removed}) {
    for (const Quad& q : *quads) {
      const Triple triple = {q.subject, q.predicate, q.object};
      const ToldChange& change = told_changes_[triple];
      if (change.before == change.now) continue;
      // Where an inferred triple is told besides, nothing is new; where it is no longer told, it may rest on
      // nothing but itself, so it counts as lost.
      if (change.now && IsInferred(triple)) continue;
      if (announced_.try_emplace(triple, change.now).second) Announce(triple, change.now, 0);
    }
  }
  for (int stratum = 0; stratum < program_.stratum_count; ++stratum) {
    if (absl::Status status = Overdelete(stratum); !status.ok()) return status;
    if (absl::Status status = Rederive(stratum); !status.ok()) return status;
    if (absl::Status status = Add(stratum); !status.ok()) return status;
    AnnounceHigher(stratum);
  }
  return absl::OkStatus();
}

absl::Status Materialiser::Rebuild() {
  CollectToldChanges();
  std::vector<Triple> old;
  writer_.current().ForEach({TermId(), TermId(), TermId(), inferred_graph_}, [&](const Quad& q) {
    old.push_back({q.subject, q.predicate, q.object});
    return true;
  });
  for (const Triple& triple : old) Change(triple, false);
  for (int stratum = 0; stratum < program_.stratum_count; ++stratum) {
    for (const uint32_t rule : program_.rules_of_stratum[stratum]) {
      const std::vector<TermId> nothing(program_.rules[rule].body->columns().size());
      if (absl::Status status = Fire(rule, nothing, Phase::kAdd); !status.ok()) return status;
      const std::vector<Triple> made = made_;
      for (const Triple& triple : made) {
        if (absl::Status status = Infer(triple, rule, stratum); !status.ok()) return status;
      }
    }
    if (absl::Status status = Add(stratum); !status.ok()) return status;
  }
  touched_.clear();
  return absl::OkStatus();
}

Delta Materialiser::InferredChange() const {
  Delta delta;
  for (const auto& [triple, added] : changes_)
    (added ? delta.added : delta.removed).push_back(InferredQuad(triple));
  std::sort(delta.added.begin(), delta.added.end());
  std::sort(delta.removed.begin(), delta.removed.end());
  return delta;
}

}  // namespace docent
