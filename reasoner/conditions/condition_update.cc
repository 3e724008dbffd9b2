#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/base/attributes.h"
#include "graph/sparql/run/evaluator.h"
#include "reasoner/conditions/bindings.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/conditions/standing_conditions_impl.h"

namespace docent::conditions {

// Forced inlining makes Update one function: calls of its parts took 15 of 190 nanoseconds.
ABSL_ATTRIBUTE_ALWAYS_INLINE inline StandingConditions::Impl::Touched& StandingConditions::Impl::Touch(
    uint32_t number) {
  Condition& condition = conditions[number];
  uint32_t& at = condition.touched_at();
  if (at >= touched.size() || touched[at].condition != number) {
    at = static_cast<uint32_t>(touched.size());
    touched.push_back({.condition = number, .held = condition.holds()});
  }
  return touched[at];
}

absl::Status StandingConditions::Impl::Whole(absl::FunctionRef<absl::Status()> evaluate) {
  ++counters.whole_evaluations;
  const uint64_t start = now_ns == nullptr ? 0 : now_ns();
  absl::Status status = evaluate();
  if (now_ns != nullptr) counters.whole_ns += now_ns() - start;
  return status;
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline void StandingConditions::Impl::GatherOf(const Quad& quad, bool added) {
  const auto visit = [&](const matching::PatternIndex::Reference& reference) {
    ++counters.candidates;
    if ((reference.pattern & WatchIndexes::kIsWitness) != 0) {
      broken.push_back(reference);
      return;
    }
    const bool condition_template = (reference.owner & WatchIndexes::kIsTemplate) != 0;
    int& count = condition_template
                     ? templates[reference.owner & ~WatchIndexes::kIsTemplate]->RisesIn(counters.updates)
                     : Touch(reference.owner).rises;
    if (++count > kMaxProbes) return;
    rises.push_back({reference.owner, reference.pattern, &quad, added});
  };
  indexes.ForChange(added).ForEachMatch(quad, visit);
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline void StandingConditions::Impl::Gather(const Delta& delta) {
  touched.clear();
  broken.clear();
  rises.clear();
  for (const Quad& quad : delta.added) GatherOf(quad, true);
  for (const Quad& quad : delta.removed) GatherOf(quad, false);
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline absl::Status StandingConditions::Impl::RecheckBroken(
    const sparql::RunOptions& run) {
  if (broken.size() > 1) {
    std::sort(broken.begin(), broken.end(), [](const auto& a, const auto& b) {
      return std::tie(a.owner, a.pattern, a.detail) < std::tie(b.owner, b.pattern, b.detail);
    });
  }
  const matching::PatternIndex::Reference* last = nullptr;
  for (const matching::PatternIndex::Reference& reference : broken) {
    Condition& condition = conditions[reference.owner];
    const bool again =
        last != nullptr && last->owner == reference.owner && last->pattern == reference.pattern;
    last = &reference;
    if (condition.keeps_witness()) {
      condition.ForgetKept();
      continue;
    }
    if (again) continue;
    ++counters.evaluations;
    Touch(reference.owner);
    absl::Status status =
        condition.Recheck(reference.pattern & ~WatchIndexes::kIsWitness, reference.detail, run, edits);
    if (status.ok()) status = CheckMemory(run);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline absl::Status StandingConditions::Impl::ProbeRises(
    const sparql::RunOptions& run) {
  for (const Rise& rise : rises) {
    if ((rise.owner & WatchIndexes::kIsTemplate) != 0) {
      if (absl::Status status = ProbeTemplate(rise, run); !status.ok()) return status;
      continue;
    }
    Condition& condition = conditions[rise.owner];
    Touched& touch = touched[condition.touched_at()];
    touch.probed = true;
    if (touch.full_done || condition.IgnoresRise()) continue;
    ++counters.evaluations;
    absl::Status status;
    if (touch.rises > kMaxProbes) {
      touch.full_done = true;
      status = Whole([&] { return condition.ProbeAll(run, edits); });
    } else if (const auto probe =
                   [&] {
                     return condition.Probe(rise.trigger, *rise.quad, rise.added, run, touch.full_done,
                                            edits);
                   };
               condition.narrows(rise.trigger)) {
      status = probe();
    } else {
      status = Whole(probe);
    }
    if (status.ok()) status = CheckMemory(run);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status StandingConditions::Impl::ProbeTemplate(const Rise& rise, const sparql::RunOptions& run) {
  ConditionTemplate& condition_template = *templates[rise.owner & ~WatchIndexes::kIsTemplate];
  int& count = condition_template.RisesIn(counters.updates);
  if (count < 0) return absl::OkStatus();  // a whole evaluation was made
  const bool whole = count > kMaxProbes;
  if (whole) count = -1;
  ++counters.evaluations;
  absl::StatusOr<bool> found =
      condition_template.Probe(rise.trigger, whole ? nullptr : rise.quad, rise.added, run,
                               [this, &run](uint32_t number, absl::Span<const TermId> row) {
                                 Touch(number);
                                 conditions[number].Offer(row, run, edits);
                               });
  if (!found.ok() || *found) return found.status();
  for (const uint32_t number : condition_template.Waiting()) {
    Condition& condition = conditions[number];
    Touched& touch = Touch(number);
    if (touch.full_done || condition.IgnoresRise()) continue;
    ++counters.evaluations;
    absl::Status status =
        whole ? condition.ProbeAll(run, edits)
              : condition.Probe(rise.trigger, *rise.quad, rise.added, run, touch.full_done, edits);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status StandingConditions::Impl::RefreshVolatile(const sparql::RunOptions& run) {
  for (const uint32_t number : volatile_conditions) {
    Touch(number);
    ++counters.evaluations;
    const absl::Status status = Whole([&] { return conditions[number].Refresh(run, edits); });
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline void StandingConditions::Impl::LinkEdits(size_t begin) {
  for (size_t i = begin; i < edits.size(); ++i) {
    const auto at = static_cast<uint32_t>(i);
    Touched& touch = touched[conditions[edits[i].condition].touched_at()];  // set when it was evaluated
    edits[i].next = Touched::kNone;
    (touch.edited() ? edits[touch.last].next : touch.first) = at;
    touch.last = at;
  }
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline void StandingConditions::Impl::Settle(const Touched& touch,
                                                                          const GraphVersion& version) {
  Shared& condition = conditions[touch.condition];
  const bool failed = touch.probed && !touch.edited();
  if ((touch.probed || touch.edited() || condition.rise_watch_hit()) && condition.Arm(&version, failed)) {
    journal.push_back({JournalEntry::Kind::kArmed, touch.condition, {}});
  }
  if (!condition.is_grouped()) return;
  for (const auto& group : *condition.groups) {
    if (!group) continue;
    for (uint32_t i = touch.first; i != Touched::kNone; i = edits[i].next) {
      group->SetKey(edits[i].key[0], edits[i].is_present);
    }
  }
}

absl::Status StandingConditions::Impl::RelevelGroups(const Shared& condition,
                                                     absl::FunctionRef<void(ConditionId, bool)> visit) {
  if (!condition.is_grouped()) return absl::OkStatus();
  for (const auto& group : *condition.groups) {
    if (!group) continue;
    if (absl::Status status = group->Relevel({.version = &no_graph}, visit); !status.ok()) return status;
  }
  return absl::OkStatus();
}

void StandingConditions::Impl::Bind(const Condition& condition, const Condition::Key& key,
                                    Binding& binding) const {
  binding.clear();
  binding.reserve(key.size());
  for (size_t i = 0; i < key.size(); ++i) {
    if (!key[i].IsNone()) binding.emplace_back(condition.columns()[condition.keys()[i]].name, key[i]);
  }
}

// The bindings still hold the data of an earlier Update.
inline ConditionChange& StandingConditions::Impl::NextChange(ConditionId id, ConditionChange::Edge edge) {
  if (reported == changes.size()) changes.emplace_back();
  ConditionChange& change = changes[reported++];
  change.id = id;
  change.edge = edge;
  change.overflowed = false;
  return change;
}

void StandingConditions::Impl::TellBindings(const Touched& touch, ConditionChange& change) const {
  const Condition& condition = conditions[touch.condition];
  if (touch.first == touch.last) {
    const Condition::Edit& edit = edits[touch.first];
    if (edit.is_present == change.appeared.empty())
      change.appeared.swap(change.disappeared);  // reuses the memory of one of them
    std::vector<Binding>& now = edit.is_present ? change.appeared : change.disappeared;
    (edit.is_present ? change.disappeared : change.appeared).clear();
    now.resize(edit.is_present == edit.was_present ? 0 : 1);
    if (!now.empty()) Bind(condition, edit.key, now[0]);
    return;
  }
  change.appeared.clear();
  change.disappeared.clear();
  // The first edit of a key gives the state before; the condition has the current state.
  absl::flat_hash_map<Condition::Key, bool> before;
  std::vector<Condition::Key> order;
  for (uint32_t i = touch.first; i != Touched::kNone; i = edits[i].next) {
    const Condition::Edit& edit = edits[i];
    if (before.try_emplace(edit.key, edit.was_present).second) order.push_back(edit.key);
  }
  for (const Condition::Key& key : order) {
    const bool now = condition.Has(key);
    if (now == before[key]) continue;
    (now ? change.appeared : change.disappeared).push_back(BindingOf(condition, key));
  }
  SortBindings(change.appeared, dictionary);
  SortBindings(change.disappeared, dictionary);
}

void StandingConditions::Impl::TellOverflow(const Shared& condition) {
  for (const ConditionId id : condition.followers) {
    if (IsRemoved(id)) continue;
    ConditionChange& change = NextChange(id, ConditionChange::Edge::kBindingsChanged);
    change.appeared.clear();
    change.disappeared.clear();
    change.overflowed = true;
  }
}

ABSL_ATTRIBUTE_ALWAYS_INLINE inline absl::Status StandingConditions::Impl::CollectChanges(
    const Touched& touch) {
  using Edge = ConditionChange::Edge;
  if (conditions[touch.condition].overflowed()) {
    TellOverflow(conditions[touch.condition]);
    return absl::OkStatus();
  }
  if (!touch.edited()) return absl::OkStatus();
  const Shared& condition = conditions[touch.condition];
  const bool holds = condition.holds(), edge = holds != touch.held, has_keys = condition.has_keys();
  if (edge || has_keys) {
    for (const ConditionId id : condition.followers) {
      if (IsRemoved(id)) continue;
      ConditionChange& change = NextChange(id, !edge   ? Edge::kBindingsChanged
                                               : holds ? Edge::kRose
                                                       : Edge::kFell);
      if (has_keys) {
        TellBindings(touch, change);
        if (!edge && change.appeared.empty() && change.disappeared.empty()) --reported;
      } else {
        change.appeared.clear();
        change.disappeared.clear();
      }
    }
  }
  if (!condition.is_grouped()) return absl::OkStatus();
  return RelevelGroups(condition, [&](ConditionId id, bool level) {
    if (IsRemoved(id)) return;
    ConditionChange& change = NextChange(id, level ? Edge::kRose : Edge::kFell);
    change.appeared.clear();
    change.disappeared.clear();
  });
}

absl::StatusOr<absl::Span<const ConditionChange>> StandingConditions::Update(const GraphVersion& version,
                                                                             const Delta& delta,
                                                                             TimeMicros now_us,
                                                                             Cancellation* cancellation) {
  Impl& impl = *impl_;
  ++impl.counters.updates;
  impl.indexes.SetGraphSize(version.size());
  const sparql::RunOptions run{.version = &version, .cancellation = cancellation, .now_us = now_us};
  const size_t begin = impl.edits.size();
  impl.computed.Begin();
  impl.Gather(delta);
  absl::Status status = impl.RecheckBroken(run);
  if (status.ok()) status = impl.ProbeRises(run);
  if (status.ok() && !impl.volatile_conditions.empty()) status = impl.RefreshVolatile(run);
  if (status.ok()) status = impl.CheckMemory(run);
  impl.LinkEdits(begin);
  impl.reported = 0;
  if (impl.changes.size() > Impl::kMostKept) impl.changes.clear();
  for (const Impl::Touched& touch : impl.touched) {
    impl.Settle(touch, version);
    if (impl.conditions[touch.condition].overflowed()) impl.overflowed.push_back(touch.condition);
    if (status.ok()) status = impl.CollectChanges(touch);
  }
  if (!status.ok()) return status;
  const absl::Span<ConditionChange> reported(impl.changes.data(), impl.reported);
  if (reported.size() > 1)
    std::sort(reported.begin(), reported.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  impl.counters.changes += reported.size();
  return absl::Span<const ConditionChange>(reported);
}

void StandingConditions::Commit() {
  if (impl_->removals > 0) {
    for (const Impl::JournalEntry& entry : impl_->journal) {
      if (entry.kind == Impl::JournalEntry::Kind::kRemoved) impl_->Unfollow(entry.id);
    }
    impl_->removals = 0;
  }
  impl_->edits.clear();
  impl_->journal.clear();
  impl_->overflowed.clear();
  impl_->computed.Reset();
}

void StandingConditions::Rollback() {
  const Condition::Edits edits = std::exchange(impl_->edits, {});
  const std::vector<Impl::JournalEntry> journal = std::exchange(impl_->journal, {});
  impl_->removals = 0;
  impl_->indexes.live_exceeded = false;
  impl_->computed.Reset();
  for (const uint32_t number : std::exchange(impl_->overflowed, {}))
    impl_->conditions[number].TakeBackOverflow();
  std::vector<uint32_t> changed;
  for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit) {
    Impl::Shared& shared = impl_->conditions[edit->condition];
    shared.Undo(*edit);
    changed.push_back(edit->condition);
    if (!shared.is_grouped()) continue;
    for (const auto& group : *shared.groups) {
      if (group) group->SetKey(edit->key[0], shared.Has(edit->key));
    }
  }
  for (auto entry = journal.rbegin(); entry != journal.rend(); ++entry) {
    switch (entry->kind) {
      case Impl::JournalEntry::Kind::kArmed:
        changed.push_back(entry->condition);
        break;
      case Impl::JournalEntry::Kind::kRegistered:
        impl_->Unfollow(entry->id);
        break;
      case Impl::JournalEntry::Kind::kRemoved:
        impl_->followers[entry->id].removed = false;
        break;
    }
  }
  for (const uint32_t number : changed) {
    if (!impl_->conditions.Has(number)) continue;
    // The reason for watching a single pattern may not hold in the restored version.
    impl_->conditions[number].Arm(nullptr);
    // It cannot fail: it succeeded before with these keys.
    impl_->RelevelGroups(impl_->conditions[number], [](ConditionId, bool) {}).IgnoreError();
  }
}

}  // namespace docent::conditions
