#include "reasoner/constraints/condition.h"

#include <algorithm>
#include <utility>

namespace docent {
namespace {

int ConstantCount(const QuadPattern& pattern) {
  return !pattern.subject.IsNone() + !pattern.predicate.IsNone() + !pattern.object.IsNone();
}

}  // namespace

Condition::Condition(uint32_t number, std::unique_ptr<Body> body, Keys keys, WatchIndexes& indexes)
    : number_(number), body_(body.get()), indexes_(indexes), keys_(std::move(keys)), own_(std::move(body)) {
  Begin();
}

Condition::Condition(uint32_t number, Shape* shape, Shape::Constants constants, Keys keys, WatchIndexes& indexes)
    : number_(number),
      body_(&shape->body()),
      indexes_(indexes),
      keys_(std::move(keys)),
      shape_(shape),
      constants_(std::move(constants)) {
  const std::vector<TermId> seed = shape->SeedOf(constants_);
  base_.assign(seed.begin(), seed.end());
  Begin();
}

void Condition::Begin() {
  if (has_keys()) keyed_ = std::make_unique<Keyed>();
  for (uint32_t i = 0; i < body_->triggers().size(); ++i) {
    if (!Narrows(i)) whole_ |= uint64_t{1} << std::min(i, 63u);
  }
}

void Condition::SetShape(Shape* shape, Shape::Constants constants) {
  Disarm();
  shape_ = shape;
  constants_ = std::move(constants);
}

Condition::~Condition() {
  Disarm();
  for (Witness& witness : witnesses_) indexes_.RemoveAll(witness.watches);
}

std::vector<Condition::Key> Condition::Present() const {
  std::vector<Key> keys;
  if (!has_keys()) {
    if (holds()) keys.emplace_back();
    return keys;
  }
  keys.reserve(present_);
  for (const auto& [key, slot] : keyed_->slots) keys.push_back(key);
  return keys;
}

std::vector<TermId> Condition::Seed() const {
  if (base_.empty()) return std::vector<TermId>(columns().size());
  return {base_.begin(), base_.end()};
}

std::vector<TermId>& Condition::BeginSeed() const {
  if (base_.empty()) {
    indexes_.seed.assign(columns().size(), TermId());
  } else {
    indexes_.seed.assign(base_.begin(), base_.end());
  }
  return indexes_.seed;
}

Condition::Key Condition::KeyOf(absl::Span<const TermId> row) const {
  Key key;
  for (const int16_t column : keys_) key.push_back(row[column]);
  return key;
}

int Condition::SlotOf(const Key& key) const {
  if (!has_keys()) return holds() ? 0 : -1;
  const auto found = keyed_->slots.find(key);
  return found == keyed_->slots.end() ? -1 : static_cast<int>(found->second);
}

uint32_t Condition::NewSlot(const Key& key) {
  ++present_;
  if (!has_keys()) {
    if (witnesses_.empty()) witnesses_.emplace_back();
    return 0;
  }
  uint32_t slot = static_cast<uint32_t>(witnesses_.size());
  if (keyed_->free.empty()) {
    witnesses_.emplace_back();
  } else {
    slot = keyed_->free.back();
    keyed_->free.pop_back();
  }
  witnesses_[slot].key = key;
  keyed_->slots.emplace(key, slot);
  return slot;
}

void Condition::SetRow(uint32_t slot, absl::Span<const TermId> row) {
  Witness& witness = witnesses_[slot];
  indexes_.RemoveAll(witness.watches);
  witness.row.assign(row.begin(), row.end());
  Watch(slot);
}

void Condition::DropSlot(uint32_t slot) {
  Witness& witness = witnesses_[slot];
  indexes_.RemoveAll(witness.watches);
  --present_;
  if (!has_keys()) return;
  keyed_->free.push_back(slot);
  keyed_->slots.erase(witness.key);
}

void Condition::Watch(uint32_t slot) {
  Witness& witness = witnesses_[slot];
  PatternIndex::Reference reference{number_, slot | WatchIndexes::kIsWitness};
  for (const Trigger& trigger : body_->triggers()) {
    const auto place = &trigger - body_->triggers().data();
    reference.detail = static_cast<uint16_t>(std::min<ptrdiff_t>(place, WatchIndexes::kSomeTrigger));
    const MatchPattern match = body_->Instantiate(trigger, witness.row);
    if (RisesOnAdd(trigger.polarity)) witness.watches.push_back(indexes_.Goes(match, reference));
    if (RisesOnRemove(trigger.polarity)) witness.watches.push_back(indexes_.Comes(match, reference));
  }
}

bool Condition::Take(absl::Span<const TermId> row, Edits& edits) {
  Key key = KeyOf(row);
  if (Has(key)) return false;
  SetRow(NewSlot(key), row);
  edits.push_back({number_, std::move(key), false, {}});
  return true;
}

void Condition::Offer(absl::Span<const TermId> row, Edits& edits) {
  if (IgnoresRise()) return;
  if (own_ == nullptr) {
    Take(row, edits);
    return;
  }
  Row own;
  for (const int16_t column : shape_->columns()) own.push_back(row[column]);
  Take(own, edits);
}

absl::Status Condition::Recheck(uint32_t slot, uint16_t trigger, const sparql::RunOptions& run, Edits& edits) {
  const auto drop = [&] {
    edits.push_back({number_, witnesses_[slot].key, true, std::move(witnesses_[slot].row)});
    DropSlot(slot);
    return absl::OkStatus();
  };
  const Key& key = witnesses_[slot].key;
  std::vector<TermId>& seed = BeginSeed();
  for (size_t i = 0; i < keys_.size(); ++i) {
    if (body_->columns()[keys_[i]].certain) seed[keys_[i]] = key[i];
  }
  // What lost a match has most often no other.
  if (trigger != WatchIndexes::kSomeTrigger && HasNoMatch(trigger, seed, *run.version)) {
    blocked_ = !has_keys() && watches_one() && armed_trigger_ == trigger;
    return drop();
  }
  bool found = false;
  Row after;
  const absl::Status status = body_->Evaluate(run, seed, [&](absl::Span<const TermId> row) {
    if (KeyOf(row) != key) return true;
    found = true;
    after.assign(row.begin(), row.end());
    return false;
  });
  if (!status.ok()) return status;
  if (!found) return drop();
  if (after == witnesses_[slot].row) return absl::OkStatus();
  edits.push_back({number_, key, true, witnesses_[slot].row});
  SetRow(slot, after);
  return absl::OkStatus();
}

bool Condition::Narrows(uint32_t trigger) const {
  const Trigger& matched = body_->triggers()[trigger];
  const bool constant = std::any_of(body_->triggers().begin(), body_->triggers().end(), [this](const Trigger& t) {
    const QuadPattern constants = MatchOf(t).constants;
    return t.required && (!constants.subject.IsNone() || !constants.object.IsNone());
  });
  return constant || std::any_of(matched.columns.begin(), matched.columns.end(), [this](int16_t column) {
    if (column == Trigger::kNoColumn || (!base_.empty() && !base_[column].IsNone())) return false;
    return has_keys() ? body_->columns()[column].certain : body_->columns()[column].seedable;
  });
}

absl::Status Condition::Probe(uint32_t trigger, const Quad& quad, bool added, const sparql::RunOptions& run,
                              bool& full_done, Edits& edits) {
  if (full_done) return absl::OkStatus();
  std::vector<TermId>& seed = indexes_.seed;
  body_->SeedFrom(body_->triggers()[trigger], quad, seed);
  bool seeded = false;
  for (size_t i = 0; i < seed.size(); ++i) {
    const Body::Column& column = body_->columns()[i];
    if (has_keys() ? !column.certain : !column.seedable) seed[i] = TermId();
    const bool constant = !base_.empty() && !base_[i].IsNone();
    seeded = seeded || (!seed[i].IsNone() && !constant);
    if (constant) seed[i] = base_[i];
  }
  full_done = !seeded;
  const auto take = [&](absl::Span<const TermId> row) {
    Take(row, edits);
    return has_keys();
  };
  if (!added) return body_->Evaluate(run, seed, take);
  return body_->EvaluateFrom(body_->triggers()[trigger], run, seed, take);
}

absl::Status Condition::Refresh(const sparql::RunOptions& run, Edits& edits) {
  std::vector<uint32_t> slots;
  for (const Key& key : Present()) slots.push_back(static_cast<uint32_t>(SlotOf(key)));
  std::sort(slots.begin(), slots.end());
  for (const uint32_t slot : slots) {
    if (absl::Status status = Recheck(slot, WatchIndexes::kSomeTrigger, run, edits); !status.ok()) return status;
  }
  return ProbeAll(run, edits);
}

absl::Status Condition::ProbeAll(const sparql::RunOptions& run, Edits& edits) {
  if (holds() && !has_keys()) return absl::OkStatus();
  return body_->Evaluate(run, BeginSeed(), [&](absl::Span<const TermId> row) {
    Take(row, edits);
    return has_keys();
  });
}

void Condition::Undo(const Edit& edit) {
  const int slot = SlotOf(edit.key);
  if (edit.was_present) {
    SetRow(slot < 0 ? NewSlot(edit.key) : static_cast<uint32_t>(slot), edit.before);
  } else {
    DropSlot(static_cast<uint32_t>(slot));
  }
}

MatchPattern Condition::MatchOf(const Trigger& trigger) const {
  return base_.empty() ? trigger.match : body_->Instantiate(trigger, base_);
}

bool Condition::HasNoMatch(uint16_t trigger, absl::Span<const TermId> seed, const GraphVersion& version) const {
  const Trigger& lost = body_->triggers()[trigger];
  return lost.required && lost.polarity == Polarity::kPositive &&
         !version.ContainsMatch(body_->Instantiate(lost, seed).constants);
}

// A required pattern without any match: nothing can rise before it has one. The most specific of them; the one that is
// watched already where it is as good.
int Condition::BlockingTrigger(const GraphVersion& version) const {
  int best = -1;
  int best_constants = -1;
  const std::vector<Trigger>& triggers = body_->triggers();
  const auto look_at = [&](int i) {
    const Trigger& trigger = triggers[static_cast<size_t>(i)];
    if (!trigger.required || trigger.polarity != Polarity::kPositive) return;
    const QuadPattern constants = MatchOf(trigger).constants;
    if (ConstantCount(constants) <= best_constants || version.ContainsMatch(constants)) return;
    best = i;
    best_constants = ConstantCount(constants);
  };
  if (watches_one()) look_at(armed_trigger_);
  for (size_t i = 0; i < triggers.size(); ++i) look_at(static_cast<int>(i));
  return best;
}

void Condition::WatchTrigger(uint32_t trigger) {
  const Trigger& watched = body_->triggers()[trigger];
  const MatchPattern match = MatchOf(watched);
  if (RisesOnAdd(watched.polarity)) armed_watches_.push_back(indexes_.Comes(match, {number_, trigger}));
  if (RisesOnRemove(watched.polarity)) armed_watches_.push_back(indexes_.Goes(match, {number_, trigger}));
}

void Condition::Disarm() {
  indexes_.RemoveAll(armed_watches_);
  if (joined_) shape_->Leave(number_, constants_);
  joined_ = false;
  armed_ = Armed::kNothing;
}

bool Condition::Arm(const GraphVersion* version, bool probed) {
  const bool blocked = std::exchange(blocked_, false);
  Armed wanted = Armed::kAll;
  int one = -1;
  if (blocked && !holds() && watches_one() && version != nullptr) return false;
  if (holds() && !has_keys()) {
    if (!in_vain_ && version != nullptr) return false;
    wanted = Armed::kNothing;
  } else if (!holds() && version != nullptr && armed_ == Armed::kAll && !(probed && unlooked_)) {
    // it may rise as it fell; whether less would do is looked at when that costs something
    unlooked_ = unlooked_ || !probed;
    return false;
  } else if (!holds() && version != nullptr && body_->triggers().size() > 1 &&
             (one = BlockingTrigger(*version)) >= 0 &&
             (shape_ == nullptr || !shape_->Shares(static_cast<size_t>(one)))) {
    wanted = Armed::kOne;
  }
  in_vain_ = false;
  unlooked_ = false;
  if (wanted == armed_ && (wanted != Armed::kOne || one == armed_trigger_)) return false;
  Disarm();
  armed_ = wanted;
  armed_trigger_ = static_cast<int16_t>(one);
  if (wanted == Armed::kOne) WatchTrigger(static_cast<uint32_t>(one));
  if (wanted == Armed::kAll) {
    for (uint32_t i = 0; i < body_->triggers().size(); ++i) {
      if (shape_ == nullptr || !shape_->Shares(i)) WatchTrigger(i);
    }
    joined_ = shape_ != nullptr && shape_->SharesAny();
    if (joined_) shape_->Join(number_, constants_);
  }
  return true;
}

}  // namespace docent
