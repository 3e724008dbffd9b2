#include "graph/sparql/run/pattern_table.h"

#include <algorithm>

namespace docent::sparql {
namespace {

constexpr size_t kMoreMatches = 64;  // tolerated beyond the count

// The slots of a pattern, each once.
std::vector<int> SlotsOf(const PlanPattern& pattern) {
  std::vector<int> slots;
  for (const PlanTerm& term : {pattern.terms[0], pattern.terms[1], pattern.terms[2], pattern.graph.name}) {
    if (term.slot >= 0 && std::find(slots.begin(), slots.end(), term.slot) == slots.end())
      slots.push_back(term.slot);
  }
  return slots;
}

}  // namespace

bool PatternTable::Fits(const TermId* row) const {
  bool fits = ready_;
  for (const int slot : key_slots_) fits &= !row[slot].IsNone();
  for (const int slot : value_slots_) fits &= row[slot].IsNone();
  return fits;
}

bool PatternTable::Build(PlanPattern& pattern, const TermId* row, size_t slots, EvaluationContext& context) {
  kept_.LetGo(context);
  Forget();
  for (const int slot : SlotsOf(pattern)) (row[slot].IsNone() ? value_slots_ : key_slots_).push_back(slot);
  if (key_slots_.empty()) return false;
  keys_ = RowSet(key_slots_.size());
  const size_t bytes =
      value_slots_.size() * sizeof(TermId) + sizeof(uint32_t) + keys_.bytes_a_row() + sizeof(uint32_t);
  const size_t matches = static_cast<size_t>(pattern.matches);
  if (!context.MayKeep(bytes * matches) || !kept_.Add(bytes * matches, context)) return false;
  keys_.Reserve(matches);
  next_.reserve(matches);
  values_.reserve(matches * value_slots_.size());
  std::vector<TermId> match(slots);
  key_.resize(key_slots_.size());
  PatternScan scan;
  scan.Open(pattern, match.data(), context);
  while (scan.Next(match.data())) {
    const auto [number, added] = keys_.Insert(KeyOf(match.data()));
    const uint32_t entry = static_cast<uint32_t>(next_.size());
    if (added) {
      first_.push_back(entry);
      next_.push_back(kEnd);
    } else {
      next_.push_back(first_[number]);
      first_[number] = entry;
    }
    for (const int slot : value_slots_) values_.push_back(match[slot]);
    if (next_.size() <= matches) continue;
    // The matches were counted in an older version.
    if (next_.size() > 2 * matches + kMoreMatches || !context.MayKeep(bytes)) {
      pattern.matches = 2 * static_cast<double>(next_.size());
      kept_.LetGo(context);
      Forget();
      return false;
    }
    kept_.Add(bytes, context);
  }
  ready_ = context.status.ok();
  return ready_;
}

const TermId* PatternTable::KeyOf(const TermId* row) {
  if (key_slots_.size() == 1) return row + key_slots_[0];
  const int* slot = key_slots_.data();
  for (TermId& id : key_) id = row[*slot++];
  return key_.data();
}

void PatternTable::Open(const TermId* row) {
  const uint32_t number = keys_.Find(KeyOf(row));
  at_ = number == RowSet::npos ? kEnd : first_[number];
  given_ = false;
}

bool PatternTable::Next(TermId* row, EvaluationContext& context) {
  if (at_ == kEnd || !context.Poll()) {
    for (const int slot : value_slots_) {
      if (given_) row[slot] = TermId();
    }
    given_ = false;
    return false;
  }
  const TermId* values = values_.data() + at_ * value_slots_.size();
  for (const int slot : value_slots_) row[slot] = *values++;
  at_ = next_[at_];
  given_ = true;
  return true;
}

void PatternTable::Forget() {
  if (!ready_ && key_slots_.empty() && value_slots_.empty()) return;
  *this = PatternTable();
}

}  // namespace docent::sparql
