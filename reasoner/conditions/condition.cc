#include "reasoner/conditions/condition.h"

#include <algorithm>
#include <utility>

#include "graph/store/index_order.h"

namespace docent::conditions {
namespace {

int ConstantCount(const QuadPattern& pattern) {
  return !pattern.subject.IsNone() + !pattern.predicate.IsNone() + !pattern.object.IsNone();
}

}  // namespace

Condition::Condition(uint32_t number, std::unique_ptr<matching::Body> body, Keys keys, WatchIndexes& indexes)
    : own_body_(std::move(body)),
      own_kind_(
          std::make_unique<ConditionKind>(*own_body_, std::move(keys), std::vector<int16_t>(), indexes)),
      kind_(own_kind_.get()),
      number_(number) {}

Condition::Condition(uint32_t number, ConditionTemplate* condition_template,
                     ConditionTemplate::Constants constants, const Keys& keys)
    : kind_(&condition_template->KindWith(keys)), number_(number), constants_(std::move(constants)) {}

void Condition::SetTemplate(ConditionTemplate* condition_template, ConditionTemplate::Constants constants) {
  Disarm();
  kind_->condition_template = condition_template;
  constants_ = std::move(constants);
}

Condition::~Condition() {
  Disarm();
  for (Witness& witness : witnesses_) kind_->indexes.RemoveAll(witness.watches);
  if (has_keys()) kind_->indexes.live -= present_;
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

Condition::Key Condition::KeyOf(absl::Span<const TermId> row) const {
  Key key;
  if (!has_keys()) return key;
  for (const int16_t column : keys()) key.push_back(row[column]);
  return key;
}

bool Condition::HasKey(absl::Span<const TermId> row, const Key& key) const {
  for (size_t i = 0; i < key.size(); ++i) {
    if (row[keys()[i]] != key[i]) return false;
  }
  return true;
}

int Condition::SlotOf(const Key& key) const {
  if (!has_keys()) return holds() ? 0 : -1;
  if (has_slots_) {
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
  if (has_slots_) {
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
    slot = static_cast<uint32_t>(witnesses_.size());
    for (uint32_t i = slot; i-- > 0;) {
      const Row& row = witnesses_[i].row;
      if (row.empty()) {
        slot = i;
      } else if (HasKey(row, key)) {
        return -1;
      }
    }
  }
  ++present_;
  ++kind_->indexes.live;
  if (slot == witnesses_.size()) witnesses_.emplace_back();
  if (!has_slots_ && slot == kFewWitnesses) {
    slots_ = std::make_unique<Slots>();
    has_slots_ = true;
    for (uint32_t i = 0; i < slot; ++i) slots_->taken.emplace(KeyOf(witnesses_[i].row), i);
    slots_->taken.emplace(key, slot);
  }
  return static_cast<int>(slot);
}

void Condition::SetRow(Witness& witness, uint32_t slot, absl::Span<const TermId> row) {
  if (!witness.watches.empty()) {
    if (row == absl::MakeConstSpan(witness.row)) return;  // it is the kept witness
    kind_->indexes.RemoveAll(witness.watches);
  }
  if (witness.row.size() == row.size()) {
    std::copy(row.begin(), row.end(), witness.row.begin());
  } else {
    witness.row.assign(row.begin(), row.end());
  }
  Watch(witness, slot);
}

void Condition::DropSlot(uint32_t slot, const Key& key) {
  Witness& witness = witnesses_[slot];
  kind_->indexes.RemoveAll(witness.watches);
  --present_;
  if (!has_keys()) return;
  --kind_->indexes.live;
  witness.row.clear();
  if (!has_slots_) return;
  slots_->free.push_back(slot);
  slots_->taken.erase(key);
}

void Condition::ForgetKept() {
  kind_->indexes.RemoveAll(witnesses_[0].watches);
  witnesses_[0].row.clear();
}

void Condition::Watch(Witness& witness, uint32_t slot) {
  for (const ConditionKind::Breaker& breaker : kind_->breakers) {
    const QuadPattern constants = matching::Body::ConstantsOf(*breaker.trigger, witness.row);
    const matching::PatternIndex::Reference reference{number_, slot | WatchIndexes::kIsWitness,
                                                      breaker.detail};
    const matching::MatchPattern& match = breaker.trigger->match;
    witness.watches.push_back(breaker.comes ? kind_->indexes.Comes(match, constants, reference)
                                            : kind_->indexes.Goes(match, constants, reference));
  }
}

bool Condition::MayKeepMore(const sparql::RunOptions& run) {
  WatchIndexes& indexes = kind_->indexes;
  overflowed_ = overflowed_ || (present_ >= indexes.most_matches && !grouped_);
  // what the log has was decided
  if (run.cancellation != nullptr && indexes.live >= indexes.most_live) indexes.live_exceeded = true;
  return !overflowed_ && !indexes.live_exceeded;
}

bool Condition::Take(absl::Span<const TermId> row, const sparql::RunOptions& run, Edits& edits) {
  Key key;
  uint32_t slot = 0;
  if (has_keys()) {
    key = KeyOf(row);
    const WatchIndexes& indexes = kind_->indexes;
    const bool full = present_ >= indexes.most_matches || indexes.live >= indexes.most_live;
    if (overflowed_ || (full && SlotOf(key) < 0 && !MayKeepMore(run))) return false;
    const int found = NewSlot(key);
    if (found < 0) return true;
    slot = static_cast<uint32_t>(found);
    if (run.cancellation != nullptr) run.cancellation->Spend(kStepsOfMatch);
  } else {
    if (holds()) return false;
    present_ = 1;
    if (witnesses_.empty()) witnesses_.emplace_back();
  }
  SetRow(witnesses_[slot], slot, row);
  Edit& edit = edits.emplace_back();
  edit.condition = number_;
  edit.is_present = true;
  edit.key = std::move(key);
  return has_keys();
}

void Condition::Offer(absl::Span<const TermId> row, const sparql::RunOptions& run, Edits& edits) {
  if (IgnoresRise()) return;
  if (kind_->borrows) {
    Take(row, run, edits);
    return;
  }
  Row own;
  for (const int16_t column : kind_->condition_template->columns()) own.push_back(row[column]);
  Take(own, run, edits);
}

absl::Status Condition::Recheck(uint32_t slot, uint16_t trigger, const sparql::RunOptions& run,
                                Edits& edits) {
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
    if (kind_->body.columns()[keys()[i]].certain) seed[keys()[i]] = key[i];
  }
  // A pattern that lost a match usually has no other match.
  bool found = false;
  const bool known = trigger != WatchIndexes::kSomeTrigger;
  if (known && matching::Body::RejectsAll(kind_->body.triggers()[trigger], seed)) {
    // a match of a forbidden pattern
  } else if (known && HasNoMatch(trigger, seed, *run.version)) {
    blocked_ = !has_keys() && watches_one() && armed_trigger_ == trigger;
  } else {
    Row after;
    const absl::Status status = kind_->body.Evaluate(run, seed, [&](absl::Span<const TermId> row) {
      if (!HasKey(row, key)) return true;
      found = true;
      after.assign(row.begin(), row.end());
      return false;
    });
    if (!status.ok()) return status;
    if (found && after == witnesses_[slot].row) return status;
    if (found) {
      note(true).before = std::move(witnesses_[slot].row);
      SetRow(witnesses_[slot], slot, after);
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
         kind_->body.triggers()[trigger].polarity == matching::Polarity::kNegative;
}

absl::Status Condition::Probe(uint32_t trigger, const Quad& quad, bool added, const sparql::RunOptions& run,
                              bool& full_done, Edits& edits) {
  if (full_done) return absl::OkStatus();
  const matching::Trigger& matched = kind_->body.triggers()[trigger];
  if (matched.polarity == matching::Polarity::kNegative && keeps_witness()) {
    if (absl::Status status = TakeKept(run, edits); !status.ok() || holds()) return status;
  }
  std::vector<TermId>& seed = BeginSeed();
  const ConditionKind::Gifts& gifts = kind_->gifts[trigger];
  for (const auto [word, column] : gifts) seed[static_cast<size_t>(column)] = TermId(WordAt(quad, word));
  full_done = gifts.empty();
  if (added) {
    if (const std::optional<bool> decided = kind_->body.DecideFrom(matched, run, seed)) {
      if (*decided) Take(seed, run, edits);
      return run.cancellation == nullptr ? absl::OkStatus() : run.cancellation->Check();
    }
  }
  const auto take = [&](absl::Span<const TermId> row) { return Take(row, run, edits); };
  if (!added) return kind_->body.Evaluate(run, seed, take);
  return kind_->body.EvaluateFrom(matched, run, seed, take);
}

absl::Status Condition::TakeKept(const sparql::RunOptions& run, Edits& edits) {
  if (witnesses_.empty() || witnesses_[0].watches.empty() || !kind_->body.flat()) return absl::OkStatus();
  constexpr uint32_t kAllPatterns = ~0u;
  return kind_->body.EvaluateRest(run, witnesses_[0].row, kAllPatterns, matching::Body::Filters::kAll,
                                  [&](absl::Span<const TermId> row) {
                                    Take(row, run, edits);
                                    return false;
                                  });
}

absl::Status Condition::Refresh(const sparql::RunOptions& run, Edits& edits) {
  std::vector<uint32_t> slots;
  for (const Key& key : Present()) slots.push_back(static_cast<uint32_t>(SlotOf(key)));
  std::sort(slots.begin(), slots.end());
  for (const uint32_t slot : slots) {
    if (absl::Status status = Recheck(slot, WatchIndexes::kSomeTrigger, run, edits); !status.ok())
      return status;
  }
  return ProbeAll(run, edits);
}

absl::Status Condition::ProbeAll(const sparql::RunOptions& run, Edits& edits) {
  if (holds() && !has_keys()) return absl::OkStatus();
  return kind_->body.Evaluate(run, BeginSeed(),
                              [&](absl::Span<const TermId> row) { return Take(row, run, edits); });
}

void Condition::Undo(const Edit& edit) {
  int slot = SlotOf(edit.key);
  if (!edit.was_present) return DropSlot(static_cast<uint32_t>(slot), edit.key);
  if (slot < 0 && has_keys()) slot = NewSlot(edit.key);
  if (slot < 0) {
    present_ = 1;
    slot = 0;
  }
  SetRow(witnesses_[static_cast<size_t>(slot)], static_cast<uint32_t>(slot), edit.before);
}

QuadPattern Condition::ConstantsOf(const matching::Trigger& trigger) const {
  return kind_->borrows ? matching::Body::ConstantsOf(trigger, BeginSeed()) : trigger.match.constants;
}

bool Condition::MayChange(const Quad& quad, std::optional<TermId> type) const {
  if (kind_->body.is_volatile()) return true;
  const std::vector<matching::Trigger>& triggers = kind_->body.triggers();
  return std::any_of(triggers.begin(), triggers.end(), [&](const matching::Trigger& trigger) {
    QuadPattern pattern = ConstantsOf(trigger);
    if (quad.predicate != type) pattern.object = TermId();
    pattern.graph = TermId();
    return pattern.Matches(quad);
  });
}

bool Condition::HasNoMatch(uint16_t trigger, absl::Span<const TermId> seed,
                           const GraphVersion& version) const {
  const matching::Trigger& lost = kind_->body.triggers()[trigger];
  return lost.required && lost.polarity == matching::Polarity::kPositive &&
         !version.ContainsMatch(matching::Body::ConstantsOf(lost, seed));
}

// A required pattern without any match: the condition cannot rise before it has one. The most specific of
// them; the one already watched if it is equally good.
int Condition::BlockingTrigger(const GraphVersion& version) const {
  int best = -1;
  int best_constants = -1;
  const std::vector<matching::Trigger>& triggers = kind_->body.triggers();
  const auto look_at = [&](int i) {
    const matching::Trigger& trigger = triggers[static_cast<size_t>(i)];
    if (!trigger.required || trigger.polarity != matching::Polarity::kPositive) return;
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
  const matching::Trigger& watched = kind_->body.triggers()[trigger];
  const QuadPattern constants = ConstantsOf(watched);
  const matching::PatternIndex::Reference reference{number_, trigger, 0};
  if (RisesOnAdd(watched.polarity))
    armed_watches_.push_back(kind_->indexes.Comes(watched.match, constants, reference));
  if (RisesOnRemove(watched.polarity))
    armed_watches_.push_back(kind_->indexes.Goes(watched.match, constants, reference));
}

void Condition::Disarm() {
  kind_->indexes.RemoveAll(armed_watches_);
  if (joined_) kind_->condition_template->Leave(number_, constants_);
  joined_ = false;
  armed_ = Armed::kNothing;
}

bool Condition::Arm(const GraphVersion* version, bool probed) {
  const bool blocked = blocked_;
  blocked_ = false;
  Armed wanted = Armed::kAll;
  int one = -1;
  if (blocked && !holds() && watches_one() && version != nullptr) return false;
  if (holds() && !has_keys()) {
    if (!rise_watch_hit_ && version != nullptr) return false;
    wanted = Armed::kNothing;
  } else if (!holds() && version != nullptr && armed_ == Armed::kAll && !(probed && single_watch_untried_)) {
    // keep all watches, since it may rise as it fell; a single watch is tried once these watches cost
    // something
    single_watch_untried_ = single_watch_untried_ || !probed;
    return false;
  } else if (!holds() && version != nullptr && kind_->body.triggers().size() > 1 &&
             (one = BlockingTrigger(*version)) >= 0 &&
             (kind_->condition_template == nullptr ||
              !kind_->condition_template->Shares(static_cast<size_t>(one)))) {
    wanted = Armed::kOne;
  }
  rise_watch_hit_ = false;
  single_watch_untried_ = false;
  if (wanted == armed_ && (wanted != Armed::kOne || one == armed_trigger_)) return false;
  Disarm();
  armed_ = wanted;
  armed_trigger_ = static_cast<int16_t>(one);
  if (wanted == Armed::kOne) WatchTrigger(static_cast<uint32_t>(one));
  if (wanted == Armed::kAll) {
    for (uint32_t i = 0; i < kind_->body.triggers().size(); ++i) {
      if (kind_->condition_template == nullptr || !kind_->condition_template->Shares(i)) WatchTrigger(i);
    }
    joined_ = kind_->condition_template != nullptr && kind_->condition_template->SharesAny();
    if (joined_) kind_->condition_template->Join(number_, constants_);
  }
  return true;
}

}  // namespace docent::conditions
