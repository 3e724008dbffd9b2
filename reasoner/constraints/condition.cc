#include "reasoner/constraints/condition.h"

#include <algorithm>
#include <array>
#include <utility>

namespace docent {
namespace {

int ConstantCount(const QuadPattern& pattern) {
  return !pattern.subject.IsNone() + !pattern.predicate.IsNone() + !pattern.object.IsNone();
}

}  // namespace

Condition::Condition(uint32_t number, std::unique_ptr<Body> body, Keys keys, WatchIndexes& indexes)
    : keys_(std::move(keys)),
      own_(std::move(body)),
      number_(number),
      has_keys_(!keys_.empty()),
      borrows_(false),
      body_(own_.get()),
      indexes_(indexes) {
  Begin();
}

Condition::Condition(uint32_t number, Shape* shape, Shape::Constants constants, Keys keys, WatchIndexes& indexes)
    : keys_(std::move(keys)),
      number_(number),
      has_keys_(!keys_.empty()),
      borrows_(true),
      body_(&shape->body()),
      indexes_(indexes),
      shape_(shape),
      constants_(std::move(constants)) {
  Begin();
}

void Condition::Begin() {
  for (uint32_t i = 0; i < body_->triggers().size(); ++i) {
    if (!Narrows(i)) whole_ |= 1u << std::min(i, 31u);
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
  for (const Witness& witness : witnesses_) {
    if (!witness.row.empty()) keys.push_back(KeyOf(witness.row));
  }
  return keys;
}

std::vector<TermId> Condition::Seed() const {
  return BeginSeed();
}

std::vector<TermId>& Condition::BeginSeed() const {
  if (borrows_) {
    shape_->Seed(constants_, indexes_.seed);
  } else {
    ClearSeed(columns().size(), indexes_.seed);
  }
  return indexes_.seed;
}

Condition::Key Condition::KeyOf(absl::Span<const TermId> row) const {
  Key key;
  if (!has_keys()) return key;
  for (const int16_t column : keys_) key.push_back(row[column]);
  return key;
}

bool Condition::HasKey(absl::Span<const TermId> row, const Key& key) const {
  for (size_t i = 0; i < key.size(); ++i) {
    if (row[keys_[i]] != key[i]) return false;
  }
  return true;
}

int Condition::SlotOf(const Key& key) const {
  if (!has_keys()) return holds() ? 0 : -1;
  if (slots_ != nullptr) {
    const auto found = slots_->taken.find(key);
    return found == slots_->taken.end() ? -1 : static_cast<int>(found->second);
  }
  for (size_t i = 0; i < witnesses_.size(); ++i) {
    if (!witnesses_[i].row.empty() && HasKey(witnesses_[i].row, key)) return static_cast<int>(i);
  }
  return -1;
}

int Condition::NewSlot(const Key& key) {
  uint32_t slot = 0;
  if (slots_ != nullptr) {
    const auto [taken, is_new] = slots_->taken.try_emplace(key);
    if (!is_new) return -1;
    if (slots_->free.empty()) {
      slot = static_cast<uint32_t>(witnesses_.size());
    } else {
      slot = slots_->free.back();
      slots_->free.pop_back();
    }
    taken->second = slot;
  } else {
    if (Has(key)) return -1;
    if (has_keys()) {
      while (slot < witnesses_.size() && !witnesses_[slot].row.empty()) ++slot;
    }
  }
  ++present_;
  if (slot == witnesses_.size()) witnesses_.emplace_back();
  if (slots_ == nullptr && slot == kFewWitnesses) {
    slots_ = std::make_unique<Slots>();
    for (uint32_t i = 0; i < slot; ++i) slots_->taken.emplace(KeyOf(witnesses_[i].row), i);
    slots_->taken.emplace(key, slot);
  }
  return static_cast<int>(slot);
}

void Condition::SetRow(uint32_t slot, absl::Span<const TermId> row) {
  Witness& witness = witnesses_[slot];
  if (!witness.watches.empty() && row == absl::MakeConstSpan(witness.row)) return;  // it was kept
  indexes_.RemoveAll(witness.watches);
  witness.row.assign(row.begin(), row.end());
  Watch(slot);
}

void Condition::DropSlot(uint32_t slot, const Key& key) {
  Witness& witness = witnesses_[slot];
  indexes_.RemoveAll(witness.watches);
  witness.row.clear();
  --present_;
  if (!has_keys() || slots_ == nullptr) return;
  slots_->free.push_back(slot);
  slots_->taken.erase(key);
}

void Condition::ForgetKept() {
  indexes_.RemoveAll(witnesses_[0].watches);
  witnesses_[0].row.clear();
}

void Condition::Watch(uint32_t slot) {
  Witness& witness = witnesses_[slot];
  PatternIndex::Reference reference{number_, slot | WatchIndexes::kIsWitness, 0};
  for (const Trigger& trigger : body_->triggers()) {
    const QuadPattern constants = Body::ConstantsOf(trigger, witness.row);
    if (RisesOnAdd(trigger.polarity)) witness.watches.push_back(indexes_.Goes(trigger.match, constants, reference));
    if (RisesOnRemove(trigger.polarity)) witness.watches.push_back(indexes_.Comes(trigger.match, constants, reference));
    if (reference.detail != WatchIndexes::kSomeTrigger) ++reference.detail;
  }
}

bool Condition::Take(absl::Span<const TermId> row, Edits& edits) {
  Key key = KeyOf(row);
  const int slot = NewSlot(key);
  if (slot < 0) return false;
  SetRow(static_cast<uint32_t>(slot), row);
  Edit& edit = edits.emplace_back();
  edit.condition = number_;
  edit.is_present = true;
  edit.key = std::move(key);
  return true;
}

void Condition::Offer(absl::Span<const TermId> row, Edits& edits) {
  if (IgnoresRise()) return;
  if (borrows_) {
    Take(row, edits);
    return;
  }
  Row own;
  for (const int16_t column : shape_->columns()) own.push_back(row[column]);
  Take(own, edits);
}

absl::Status Condition::Recheck(uint32_t slot, uint16_t trigger, const sparql::RunOptions& run, Edits& edits) {
  Key key = KeyOf(witnesses_[slot].row);
  const auto note = [&](bool is_present) -> Edit& {
    Edit& edit = edits.emplace_back();
    edit.condition = number_;
    edit.was_present = true;
    edit.is_present = is_present;
    edit.key = std::move(key);
    return edit;
  };
  std::vector<TermId>& seed = BeginSeed();
  for (size_t i = 0; i < key.size(); ++i) {
    if (body_->columns()[keys_[i]].certain) seed[keys_[i]] = key[i];
  }
  // What lost a match has most often no other.
  bool found = false;
  const bool known = trigger != WatchIndexes::kSomeTrigger;
  if (known && Body::RejectsAll(body_->triggers()[trigger], seed)) {
    // what must not be is there
  } else if (known && HasNoMatch(trigger, seed, *run.version)) {
    blocked_ = !has_keys() && watches_one() && armed_trigger_ == trigger;
  } else {
    Row after;
    const absl::Status status = body_->Evaluate(run, seed, [&](absl::Span<const TermId> row) {
      if (!HasKey(row, key)) return true;
      found = true;
      after.assign(row.begin(), row.end());
      return false;
    });
    if (!status.ok()) return status;
    if (found && after == witnesses_[slot].row) return status;
    if (found) {
      note(true).before = std::move(witnesses_[slot].row);
      SetRow(slot, after);
      return status;
    }
  }
  Edit& edit = note(false);
  if (KeepsWitness(trigger)) {
    edit.before = witnesses_[slot].row;
    present_ = 0;
  } else {
    edit.before = std::move(witnesses_[slot].row);
    DropSlot(slot, edit.key);
  }
  return absl::OkStatus();
}

bool Condition::KeepsWitness(uint16_t trigger) const {
  return !has_keys() && trigger != WatchIndexes::kSomeTrigger &&
         body_->triggers()[trigger].polarity == Polarity::kNegative;
}

bool Condition::Narrows(uint32_t trigger) const {
  const Trigger& matched = body_->triggers()[trigger];
  const bool constant = std::any_of(body_->triggers().begin(), body_->triggers().end(), [this](const Trigger& t) {
    const QuadPattern constants = ConstantsOf(t);
    return t.required && (!constants.subject.IsNone() || !constants.object.IsNone());
  });
  const std::vector<TermId>& seed = BeginSeed();
  return constant || std::any_of(matched.columns.begin(), matched.columns.end(), [&](int16_t column) {
    return column != Trigger::kNoColumn && seed[column].IsNone() && MayBind(body_->columns()[column]);
  });
}

absl::Status Condition::Probe(uint32_t trigger, const Quad& quad, bool added, const sparql::RunOptions& run,
                              bool& full_done, Edits& edits) {
  if (full_done) return absl::OkStatus();
  std::vector<TermId>& seed = BeginSeed();
  const std::array<TermId, 4> terms = {quad.subject, quad.predicate, quad.object, quad.graph};
  const Trigger& matched = body_->triggers()[trigger];
  bool seeded = false;
  for (size_t i = 0; i < terms.size(); ++i) {
    const int16_t column = matched.columns[i];
    if (column == Trigger::kNoColumn || !seed[column].IsNone() || !MayBind(body_->columns()[column])) continue;
    seed[column] = terms[i];
    seeded = true;
  }
  full_done = !seeded;
  const auto take = [&](absl::Span<const TermId> row) {
    Take(row, edits);
    return has_keys();
  };
  if (!added) return body_->Evaluate(run, seed, take);
  return body_->EvaluateFrom(matched, run, seed, take);
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
    SetRow(static_cast<uint32_t>(slot < 0 ? NewSlot(edit.key) : slot), edit.before);
  } else {
    DropSlot(static_cast<uint32_t>(slot), edit.key);
  }
}

QuadPattern Condition::ConstantsOf(const Trigger& trigger) const {
  return borrows_ ? Body::ConstantsOf(trigger, BeginSeed()) : trigger.match.constants;
}

bool Condition::HasNoMatch(uint16_t trigger, absl::Span<const TermId> seed, const GraphVersion& version) const {
  const Trigger& lost = body_->triggers()[trigger];
  return lost.required && lost.polarity == Polarity::kPositive &&
         !version.ContainsMatch(Body::ConstantsOf(lost, seed));
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
    const QuadPattern constants = ConstantsOf(trigger);
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
  const QuadPattern constants = ConstantsOf(watched);
  const PatternIndex::Reference reference{number_, trigger, 0};
  if (RisesOnAdd(watched.polarity)) armed_watches_.push_back(indexes_.Comes(watched.match, constants, reference));
  if (RisesOnRemove(watched.polarity)) armed_watches_.push_back(indexes_.Goes(watched.match, constants, reference));
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
