#include "reasoner/constraints/constraint_set.h"

#include <algorithm>
#include <string>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "kb_server/sparql/algebra_printer.h"
#include "kb_server/sparql/evaluator.h"
#include "reasoner/constraints/condition.h"

namespace docent {
namespace {

int CompareBindings(const std::vector<Term>& a, const std::vector<Term>& b) {
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (const int order = sparql::CompareTerms(a[i], b[i]); order != 0) return order;
  }
  return a.size() < b.size() ? -1 : a.size() > b.size() ? 1 : 0;
}

// Sorts by the values, first column first.
void SortBindings(std::vector<Binding>& bindings, const Dictionary& dictionary) {
  if (bindings.size() < 2) return;
  std::vector<std::pair<std::vector<Term>, Binding>> keyed;
  for (Binding& binding : bindings) {
    std::vector<Term> terms;
    for (const auto& [name, id] : binding) terms.push_back(dictionary.Decode(id));
    keyed.emplace_back(std::move(terms), std::move(binding));
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return CompareBindings(a.first, b.first) < 0; });
  for (size_t i = 0; i < keyed.size(); ++i) bindings[i] = std::move(keyed[i].second);
}

// Two queries with the same fingerprint have the same answers.
std::string Fingerprint(const sparql::Query& query, const std::vector<std::string>& keys) {
  std::string text = sparql::PrintAlgebra(WithoutModifiers(*query.algebra));
  for (const Term& term : query.from) absl::StrAppend(&text, "\nFROM ", term.lexical);
  for (const Term& term : query.from_named) absl::StrAppend(&text, "\nNAMED ", term.lexical);
  for (const std::string& key : keys) absl::StrAppend(&text, "\n?", key);
  return text;
}

}  // namespace

struct ConstraintSet::Impl {
  struct Shared {  // a condition and who follows it
    std::unique_ptr<Condition> condition;
    std::string fingerprint;
    std::vector<ConstraintId> followers;
  };
  struct Follower {
    uint32_t condition = 0;
    bool removed = false;  // since the last Commit
  };
  struct JournalEntry {
    enum class Kind : uint8_t { kEdit, kArmed, kRegistered, kRemoved } kind;
    uint32_t condition = 0;
    ConstraintId id;
    Condition::Edit edit;
  };
  // What one Update finds to do with a condition.
  struct Touched {
    Condition::Edits edits;
    bool full_done = false;
    bool held = false;
    bool probed = false;
  };

  Impl(Dictionary& d, const sparql::FunctionRegistry* f) : dictionary(d), functions(f) {}

  Binding BindingOf(const Condition& condition, const Condition::Key& key,
                    const std::vector<Body::Column>& columns) const;
  ConstraintChange ChangeOf(ConstraintId id, uint32_t number, const Touched& touched) const;
  absl::StatusOr<uint32_t> MakeCondition(const sparql::Query& query, const GraphVersion& now,
                                         const RegisterOptions& options, std::string fingerprint);
  void Unfollow(ConstraintId id);
  Touched& Touch(uint32_t number);
  absl::Status RecheckBroken(const sparql::RunOptions& run, const Delta& delta);
  absl::Status ProbeRises(const sparql::RunOptions& run);
  void GatherRises(const Delta& delta);
  absl::Status RefreshVolatile(const sparql::RunOptions& run);
  void Settle(const GraphVersion& version);

  struct Rise {
    uint32_t condition;
    uint32_t trigger;
    const Quad* quad;
  };

  Dictionary& dictionary;
  const sparql::FunctionRegistry* functions;
  WatchIndexes indexes;
  std::vector<Shared> conditions;  // by number
  std::vector<uint32_t> free_numbers;
  absl::flat_hash_map<std::string, uint32_t> by_fingerprint;
  absl::flat_hash_map<ConstraintId, Follower> followers;
  std::vector<uint32_t> volatile_conditions;
  std::vector<JournalEntry> journal;
  uint64_t next_id = 1;
  Counters counters;

  // of the running Update
  absl::flat_hash_map<uint32_t, Touched> touched;
  std::vector<Rise> rises;
};

ConstraintSet::ConstraintSet(Dictionary& dictionary, const sparql::FunctionRegistry* functions)
    : impl_(std::make_unique<Impl>(dictionary, functions)) {}
ConstraintSet::~ConstraintSet() = default;

absl::StatusOr<uint32_t> ConstraintSet::Impl::MakeCondition(const sparql::Query& query, const GraphVersion& now,
                                                            const RegisterOptions& options, std::string fingerprint) {
  auto body = Body::Compile(query, dictionary, functions);
  if (!body.ok()) return body.status();
  std::vector<int16_t> keys;
  for (const std::string& name : options.key_variables) {
    const int column = (*body)->ColumnOf(name);
    if (column < 0) {
      return absl::InvalidArgumentError(absl::StrCat("key variable ?", name, " is not bound by the constraint"));
    }
    keys.push_back(static_cast<int16_t>(column));
  }
  uint32_t number = static_cast<uint32_t>(conditions.size());
  if (!free_numbers.empty()) number = free_numbers.back();
  auto condition = std::make_unique<Condition>(number, *std::move(body), std::move(keys), indexes);
  Condition::Edits first;
  const sparql::RunOptions run{.version = &now, .now_us = options.now_us};
  if (absl::Status status = condition->Refresh(run, first); !status.ok()) return status;
  condition->Arm(&now);
  if (number == conditions.size()) {
    conditions.emplace_back();
  } else {
    free_numbers.pop_back();
  }
  if (condition->body().is_volatile()) volatile_conditions.push_back(number);
  by_fingerprint.emplace(fingerprint, number);
  conditions[number].condition = std::move(condition);
  conditions[number].fingerprint = std::move(fingerprint);
  return number;
}

absl::StatusOr<ConstraintId> ConstraintSet::Register(const sparql::Query& ask, const GraphVersion& now,
                                                     const RegisterOptions& options) {
  if (ask.form != sparql::Query::Form::kAsk && ask.form != sparql::Query::Form::kSelect) {
    return absl::InvalidArgumentError("a standing constraint is an ASK or SELECT query");
  }
  std::string fingerprint = Fingerprint(ask, options.key_variables);
  uint32_t number;
  if (const auto found = impl_->by_fingerprint.find(fingerprint); found != impl_->by_fingerprint.end()) {
    number = found->second;
  } else {
    const auto made = impl_->MakeCondition(ask, now, options, std::move(fingerprint));
    if (!made.ok()) return made.status();
    number = *made;
  }
  const ConstraintId id(impl_->next_id++);
  impl_->followers[id] = {number, false};
  impl_->conditions[number].followers.push_back(id);
  impl_->journal.push_back({Impl::JournalEntry::Kind::kRegistered, number, id, {}});
  return id;
}

void ConstraintSet::Remove(ConstraintId id) {
  const auto found = impl_->followers.find(id);
  if (found == impl_->followers.end() || found->second.removed) return;
  found->second.removed = true;
  impl_->journal.push_back({Impl::JournalEntry::Kind::kRemoved, found->second.condition, id, {}});
}

void ConstraintSet::Impl::Unfollow(ConstraintId id) {
  const auto found = followers.find(id);
  const uint32_t number = found->second.condition;
  followers.erase(found);
  Shared& shared = conditions[number];
  std::erase(shared.followers, id);
  if (!shared.followers.empty()) return;
  std::erase(volatile_conditions, number);
  by_fingerprint.erase(shared.fingerprint);
  shared = Shared{};
  free_numbers.push_back(number);
}

ConstraintSet::Impl::Touched& ConstraintSet::Impl::Touch(uint32_t number) {
  const auto [place, fresh] = touched.try_emplace(number);
  if (fresh) place->second.held = conditions[number].condition->holds();
  return place->second;
}

// Witnesses that a change may have broken.
absl::Status ConstraintSet::Impl::RecheckBroken(const sparql::RunOptions& run, const Delta& delta) {
  std::vector<PatternIndex::Reference> broken;
  const auto gather = [&](PatternIndex::Reference reference) { broken.push_back(reference); };
  for (const Quad& quad : delta.added) indexes.break_on_add.ForEachMatch(quad, gather);
  for (const Quad& quad : delta.removed) indexes.break_on_remove.ForEachMatch(quad, gather);
  counters.candidates += broken.size();
  for (const auto& [number, slot] : broken) {
    Condition& condition = *conditions[number].condition;
    if (condition.stamp(slot) == counters.updates) continue;
    condition.stamp(slot) = counters.updates;
    ++counters.evaluations;
    if (absl::Status status = condition.Recheck(slot, run, Touch(number).edits); !status.ok()) return status;
  }
  return absl::OkStatus();
}

void ConstraintSet::Impl::GatherRises(const Delta& delta) {
  rises.clear();
  const auto gather = [&](const Quad& quad) {
    return [this, &quad](PatternIndex::Reference reference) {
      rises.push_back({reference.owner, reference.pattern, &quad});
    };
  };
  for (const Quad& quad : delta.added) indexes.rise_on_add.ForEachMatch(quad, gather(quad));
  for (const Quad& quad : delta.removed) indexes.rise_on_remove.ForEachMatch(quad, gather(quad));
  counters.candidates += rises.size();
}

absl::Status ConstraintSet::Impl::ProbeRises(const sparql::RunOptions& run) {
  for (const Rise& rise : rises) {
    Condition& condition = *conditions[rise.condition].condition;
    Touched& touch = Touch(rise.condition);
    touch.probed = true;
    if (condition.holds() && !condition.has_keys()) continue;
    ++counters.evaluations;
    const absl::Status status = condition.Probe(rise.trigger, *rise.quad, run, touch.full_done, touch.edits);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status ConstraintSet::Impl::RefreshVolatile(const sparql::RunOptions& run) {
  for (const uint32_t number : volatile_conditions) {
    ++counters.evaluations;
    const absl::Status status = conditions[number].condition->Refresh(run, Touch(number).edits);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

// Watches follow the new state; what changed goes into the journal.
void ConstraintSet::Impl::Settle(const GraphVersion& version) {
  for (auto& [number, touch] : touched) {
    Condition& condition = *conditions[number].condition;
    const bool stale = touch.probed && condition.watches_one();
    if ((!touch.edits.empty() || stale) && condition.Arm(&version)) {
      journal.push_back({JournalEntry::Kind::kArmed, number, {}, {}});
    }
    for (const Condition::Edit& edit : touch.edits) {
      journal.push_back({JournalEntry::Kind::kEdit, number, {}, edit});
    }
  }
}

absl::StatusOr<std::vector<ConstraintChange>> ConstraintSet::Update(const GraphVersion& version, const Delta& delta,
                                                                    TimeMicros now_us) {
  Impl& impl = *impl_;
  ++impl.counters.updates;
  impl.touched.clear();
  const sparql::RunOptions run{.version = &version, .now_us = now_us};
  impl.GatherRises(delta);
  absl::Status status = impl.RecheckBroken(run, delta);
  if (status.ok()) status = impl.ProbeRises(run);
  if (status.ok()) status = impl.RefreshVolatile(run);
  impl.Settle(version);
  if (!status.ok()) return status;

  std::vector<ConstraintChange> changes;
  for (const auto& [number, touch] : impl.touched) {
    if (touch.edits.empty()) continue;
    for (const ConstraintId id : impl.conditions[number].followers) {
      if (impl.followers[id].removed) continue;
      ConstraintChange change = impl.ChangeOf(id, number, touch);
      const bool edge = change.edge != ConstraintChange::Edge::kBindingsChanged;
      if (edge || !change.appeared.empty() || !change.disappeared.empty()) changes.push_back(std::move(change));
    }
  }
  std::sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  impl.counters.changes += changes.size();
  return changes;
}

Binding ConstraintSet::Impl::BindingOf(const Condition& condition, const Condition::Key& key,
                                       const std::vector<Body::Column>& columns) const {
  Binding binding;
  for (size_t i = 0; i < key.size(); ++i) {
    if (!key[i].IsNone()) binding.emplace_back(columns[condition.keys()[i]].name, key[i]);
  }
  return binding;
}

ConstraintChange ConstraintSet::Impl::ChangeOf(ConstraintId id, uint32_t number, const Touched& touch) const {
  Condition& condition = *conditions[number].condition;
  ConstraintChange change;
  change.id = id;
  change.edge = ConstraintChange::Edge::kBindingsChanged;
  if (condition.holds() != touch.held) {
    change.edge = condition.holds() ? ConstraintChange::Edge::kRose : ConstraintChange::Edge::kFell;
  }
  if (!condition.has_keys()) return change;
  // The first edit of a key tells what was before; what is now, the condition knows.
  absl::flat_hash_map<Condition::Key, bool> before;
  std::vector<Condition::Key> order;
  for (const Condition::Edit& edit : touch.edits) {
    if (before.try_emplace(edit.key, edit.was_present).second) order.push_back(edit.key);
  }
  for (const Condition::Key& key : order) {
    const bool now = condition.Has(key);
    if (now == before[key]) continue;
    (now ? change.appeared : change.disappeared).push_back(BindingOf(condition, key, condition.body().columns()));
  }
  SortBindings(change.appeared, dictionary);
  SortBindings(change.disappeared, dictionary);
  return change;
}

bool ConstraintSet::Holds(ConstraintId id) const {
  const auto found = impl_->followers.find(id);
  return found != impl_->followers.end() && impl_->conditions[found->second.condition].condition->holds();
}

std::vector<Binding> ConstraintSet::Keys(ConstraintId id) const {
  std::vector<Binding> bindings;
  const auto found = impl_->followers.find(id);
  if (found == impl_->followers.end()) return bindings;
  Condition& condition = *impl_->conditions[found->second.condition].condition;
  for (const Condition::Key& key : condition.Present()) {
    bindings.push_back(impl_->BindingOf(condition, key, condition.body().columns()));
  }
  SortBindings(bindings, impl_->dictionary);
  return bindings;
}

absl::StatusOr<std::vector<Binding>> ConstraintSet::Solutions(ConstraintId id, const GraphVersion& version,
                                                              size_t limit, TimeMicros now_us) {
  const auto found = impl_->followers.find(id);
  if (found == impl_->followers.end()) return absl::NotFoundError("no such constraint");
  Body& body = impl_->conditions[found->second.condition].condition->body();
  std::vector<Binding> bindings;
  absl::flat_hash_map<Binding, bool> seen;
  const std::vector<TermId> seed(body.columns().size());
  const sparql::RunOptions run{.version = &version, .now_us = now_us};
  const absl::Status status = body.Evaluate(run, seed, [&](absl::Span<const TermId> row) {
    Binding binding;
    for (size_t i = 0; i < row.size(); ++i) {
      if (body.columns()[i].visible && !row[i].IsNone()) binding.emplace_back(body.columns()[i].name, row[i]);
    }
    if (seen.try_emplace(binding, true).second) bindings.push_back(std::move(binding));
    return true;
  });
  if (!status.ok()) return status;
  SortBindings(bindings, impl_->dictionary);
  if (bindings.size() > limit) bindings.resize(limit);
  return bindings;
}

void ConstraintSet::Commit() {
  std::vector<Impl::JournalEntry> journal = std::move(impl_->journal);
  impl_->journal.clear();
  for (const Impl::JournalEntry& entry : journal) {
    if (entry.kind == Impl::JournalEntry::Kind::kRemoved) impl_->Unfollow(entry.id);
  }
}

void ConstraintSet::Rollback() {
  std::vector<Impl::JournalEntry> journal = std::move(impl_->journal);
  impl_->journal.clear();
  std::vector<uint32_t> changed;
  for (auto entry = journal.rbegin(); entry != journal.rend(); ++entry) {
    switch (entry->kind) {
      case Impl::JournalEntry::Kind::kEdit:
        impl_->conditions[entry->condition].condition->Undo(entry->edit);
        changed.push_back(entry->condition);
        break;
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
  // What a single watched pattern relied on is not known of the version that it goes back to.
  for (const uint32_t number : changed) {
    if (impl_->conditions[number].condition) impl_->conditions[number].condition->Arm(nullptr);
  }
}

size_t ConstraintSet::size() const {
  return static_cast<size_t>(std::count_if(impl_->followers.begin(), impl_->followers.end(),
                                           [](const auto& entry) { return !entry.second.removed; }));
}

const ConstraintSet::Counters& ConstraintSet::counters() const { return impl_->counters; }

}  // namespace docent
