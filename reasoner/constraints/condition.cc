#include "reasoner/constraints/condition.h"

#include <algorithm>

namespace docent {
namespace {

int ConstantCount(const QuadPattern& pattern) {
  return !pattern.subject.IsNone() + !pattern.predicate.IsNone() + !pattern.object.IsNone();
}

}  // namespace

Condition::Condition(uint32_t number, std::unique_ptr<Body> body, std::vector<int16_t> keys,
                     WatchIndexes& indexes)
    : number_(number), body_(std::move(body)), keys_(std::move(keys)), indexes_(indexes) {}

void Condition::SetShape(Shape* shape, Shape::Constants constants) {
  shape_ = shape;
  constants_ = std::move(constants);
}

Condition::~Condition() {
  Disarm();
  for (const auto& [key, slot] : by_key_) Unwatch(witnesses_[slot]);
}

std::vector<Condition::Key> Condition::Present() const {
  std::vector<Key> keys;
  keys.reserve(by_key_.size());
  for (const auto& [key, slot] : by_key_) keys.push_back(key);
  return keys;
}

Condition::Key Condition::KeyOf(absl::Span<const TermId> row) const {
  Key key;
  for (const int16_t column : keys_) key.push_back(row[column]);
  return key;
}

void Condition::SetWitness(const Key& key, absl::Span<const TermId> row) {
  uint32_t slot;
  if (const auto found = by_key_.find(key); found != by_key_.end()) {
    slot = found->second;
    Unwatch(witnesses_[slot]);
  } else {
    if (free_.empty()) {
      slot = static_cast<uint32_t>(witnesses_.size());
      witnesses_.emplace_back();
    } else {
      slot = free_.back();
      free_.pop_back();
    }
    by_key_.emplace(key, slot);
  }
  witnesses_[slot].key = key;
  witnesses_[slot].row.assign(row.begin(), row.end());
  Watch(slot);
}

void Condition::DropWitness(const Key& key) {
  const auto found = by_key_.find(key);
  Unwatch(witnesses_[found->second]);
  free_.push_back(found->second);
  by_key_.erase(found);
}

void Condition::Watch(uint32_t slot) {
  Witness& witness = witnesses_[slot];
  for (const Trigger& trigger : body_->triggers()) {
    const MatchPattern match = body_->Instantiate(trigger, witness.row);
    if (RisesOnAdd(trigger.polarity))
      witness.on_remove.push_back(indexes_.break_on_remove.Add(match, {number_, slot}));
    if (RisesOnRemove(trigger.polarity))
      witness.on_add.push_back(indexes_.break_on_add.Add(match, {number_, slot}));
  }
}

void Condition::Unwatch(Witness& witness) {
  for (const PatternIndex::Handle handle : witness.on_add) indexes_.break_on_add.Remove(handle);
  for (const PatternIndex::Handle handle : witness.on_remove) indexes_.break_on_remove.Remove(handle);
  witness.on_add.clear();
  witness.on_remove.clear();
}

bool Condition::Take(absl::Span<const TermId> row, Edits& edits) {
  Key key = KeyOf(row);
  if (by_key_.contains(key)) return false;
  SetWitness(key, row);
  edits.push_back({std::move(key), false, {}});
  return true;
}

absl::Status Condition::Recheck(uint32_t slot, const sparql::RunOptions& run, Edits& edits) {
  const Key key = witnesses_[slot].key;
  const Row before = witnesses_[slot].row;
  seed_.assign(body_->columns().size(), TermId());
  for (size_t i = 0; i < keys_.size(); ++i) {
    if (body_->columns()[keys_[i]].certain) seed_[keys_[i]] = key[i];
  }
  bool found = false;
  Row after;
  const absl::Status status = body_->Evaluate(run, seed_, [&](absl::Span<const TermId> row) {
    if (KeyOf(row) != key) return true;
    found = true;
    after.assign(row.begin(), row.end());
    return false;
  });
  if (!status.ok()) return status;
  if (found && after == before) return absl::OkStatus();
  edits.push_back({key, true, before});
  if (found) {
    SetWitness(key, after);
  } else {
    DropWitness(key);
  }
  return absl::OkStatus();
}

absl::Status Condition::Probe(uint32_t trigger, const Quad& quad, const sparql::RunOptions& run,
                              bool& full_done, Edits& edits) {
  if (full_done) return absl::OkStatus();
  body_->SeedFrom(body_->triggers()[trigger], quad, seed_);
  bool seeded = false;
  for (size_t i = 0; i < seed_.size(); ++i) {
    const Body::Column& column = body_->columns()[i];
    if (has_keys() ? !column.certain : !column.seedable) seed_[i] = TermId();
    seeded = seeded || !seed_[i].IsNone();
  }
  full_done = !seeded;
  return body_->Evaluate(run, seed_, [&](absl::Span<const TermId> row) {
    Take(row, edits);
    return has_keys();
  });
}

absl::Status Condition::Refresh(const sparql::RunOptions& run, Edits& edits) {
  std::vector<uint32_t> slots;
  for (const auto& [key, slot] : by_key_) slots.push_back(slot);
  std::sort(slots.begin(), slots.end());
  for (const uint32_t slot : slots) {
    if (absl::Status status = Recheck(slot, run, edits); !status.ok()) return status;
  }
  return ProbeAll(run, edits);
}

absl::Status Condition::ProbeAll(const sparql::RunOptions& run, Edits& edits) {
  if (holds() && !has_keys()) return absl::OkStatus();
  seed_.assign(body_->columns().size(), TermId());
  return body_->Evaluate(run, seed_, [&](absl::Span<const TermId> row) {
    Take(row, edits);
    return has_keys();
  });
}

void Condition::Undo(const Edit& edit) {
  if (edit.was_present) {
    SetWitness(edit.key, edit.before);
  } else {
    DropWitness(edit.key);
  }
}

// A required pattern without any match: nothing can rise before it has one. The most specific of them.
int Condition::BlockingTrigger(const GraphVersion& version) const {
  int best = -1;
  int best_constants = -1;
  const std::vector<Trigger>& triggers = body_->triggers();
  for (size_t i = 0; i < triggers.size(); ++i) {
    const QuadPattern& constants = triggers[i].match.constants;
    if (!triggers[i].required || triggers[i].polarity != Polarity::kPositive) continue;
    if (ConstantCount(constants) <= best_constants || version.Count(constants) != 0) continue;
    best = static_cast<int>(i);
    best_constants = ConstantCount(constants);
  }
  return best;
}

void Condition::WatchTrigger(uint32_t trigger) {
  const Trigger& watched = body_->triggers()[trigger];
  if (RisesOnAdd(watched.polarity))
    armed_on_add_.push_back(indexes_.rise_on_add.Add(watched.match, {number_, trigger}));
  if (RisesOnRemove(watched.polarity))
    armed_on_remove_.push_back(indexes_.rise_on_remove.Add(watched.match, {number_, trigger}));
}

void Condition::Disarm() {
  for (const PatternIndex::Handle handle : armed_on_add_) indexes_.rise_on_add.Remove(handle);
  for (const PatternIndex::Handle handle : armed_on_remove_) indexes_.rise_on_remove.Remove(handle);
  armed_on_add_.clear();
  armed_on_remove_.clear();
  if (joined_) shape_->Leave(number_, constants_);
  joined_ = false;
  armed_ = Armed::kNothing;
}

bool Condition::Arm(const GraphVersion* version) {
  Armed wanted = Armed::kAll;
  int one = -1;
  if (holds()) {
    if (!has_keys()) wanted = Armed::kNothing;
  } else if (version != nullptr && body_->triggers().size() > 1 && (one = BlockingTrigger(*version)) >= 0 &&
             (shape_ == nullptr || !shape_->Shares(static_cast<size_t>(one)))) {
    wanted = Armed::kOne;
  }
  if (wanted == armed_ && (wanted != Armed::kOne || one == armed_trigger_)) return false;
  Disarm();
  armed_ = wanted;
  armed_trigger_ = static_cast<int16_t>(one);
  if (wanted == Armed::kOne) WatchTrigger(static_cast<uint32_t>(one));
  if (wanted == Armed::kAll) {
    for (uint32_t i = 0; i < body_->triggers().size(); ++i) {
      if (shape_ == nullptr || !shape_->Shares(i)) WatchTrigger(i);
    }
    if (shape_ != nullptr) shape_->Join(number_, constants_);
    joined_ = shape_ != nullptr;
  }
  return true;
}

}  // namespace docent
