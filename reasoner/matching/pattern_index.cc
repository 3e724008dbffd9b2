#include "reasoner/matching/pattern_index.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace docent::matching {
namespace {

unsigned ShapeOf(const QuadPattern& key) {
  return (key.subject.IsNone() ? 0u : 1u) | (key.predicate.IsNone() ? 0u : 2u) |
         (key.object.IsNone() ? 0u : 4u);
}

constexpr size_t kLeastSlots = 16;

bool IsLowerBound(Comparison op) {
  return op == Comparison::kGreater || op == Comparison::kGreaterOrEqual;
}

}  // namespace

bool MatchPattern::Matches(const Quad& quad) const {
  if (!constants.Matches(quad) || !EqualPositionsHold(equal, quad)) return false;
  if (!object_guard) return true;
  const NumberView view = ViewNumber(quad.object);
  if (view.kind != NumberView::Kind::kNumber) return view.kind == NumberView::Kind::kUnknown;
  return IsLowerBound(object_guard->op) ? view.value >= object_guard->bound
                                        : view.value <= object_guard->bound;
}

// Entries that were displaced from their own place move up.
void PatternIndex::FreeSlot(size_t at) {
  const size_t mask = tags_.size() - 1;
  for (size_t next = (at + 1) & mask; tags_[next] != 0; next = (next + 1) & mask) {
    const size_t from_home = (next - slots_[next].hash) & mask;
    if (from_home < ((next - at) & mask)) continue;
    tags_[at] = tags_[next];
    slots_[at] = slots_[next];
    at = next;
  }
  tags_[at] = 0;
  --taken_;
}

void PatternIndex::Grow() {
  const size_t size = std::max(kLeastSlots, 2 * tags_.size());
  const std::vector<uint8_t> tags = std::exchange(tags_, std::vector<uint8_t>(size));
  const std::vector<Slot> slots = std::exchange(slots_, std::vector<Slot>(size));
  for (size_t i = 0; i < tags.size(); ++i) {
    if (tags[i] == 0) continue;
    const size_t at = SlotOf(slots[i].hash);
    tags_[at] = tags[i];
    slots_[at] = slots[i];
  }
}

PatternIndex::Handle PatternIndex::Add(const MatchPattern& pattern, const QuadPattern& constants,
                                       Reference reference) {
  Handle handle;
  if (free_.empty()) {
    handle = static_cast<Handle>(entries_.size());
    entries_.emplace_back();
  } else {
    handle = free_.back();
    free_.pop_back();
  }
  Entry& entry = entries_[handle];
  const unsigned shape = ShapeOf(constants);
  entry.constants = constants;
  entry.reference = reference;
  entry.next = kNone;
  entry.previous = handle;
  entry.equal = pattern.equal;
  entry.shape = static_cast<uint8_t>(shape);
  entry.side = 0;
  if (shape_counts_[shape]++ == 0) shapes_ |= 1u << shape;
  by_predicate_[BucketOf(PredicatePart(constants.predicate))] |= static_cast<uint8_t>(1u << shape);
  const uint32_t hash = HashOfKey(entry.constants);
  if (pattern.object_guard && constants.object.IsNone()) {
    if (guarded_counts_[shape]++ == 0) guarded_shapes_ |= 1u << shape;
    std::unique_ptr<Guarded>& guarded = guarded_[hash];
    if (!guarded) guarded = std::make_unique<Guarded>();
    entry.bound = pattern.object_guard->bound;
    entry.side = IsLowerBound(pattern.object_guard->op) ? 1 : -1;
    (entry.side > 0 ? guarded->at_least : guarded->at_most).insert({entry.bound, handle});
    return handle;
  }
  if (8 * (taken_ + 1) > 5 * tags_.size()) Grow();
  const size_t at = SlotOf(hash);
  if (tags_[at] == 0) {
    tags_[at] = TagOf(hash);
    slots_[at] = {hash, handle};
    ++taken_;
    return handle;
  }
  Entry& first = entries_[slots_[at].first];
  entry.previous = first.previous;
  entries_[entry.previous].next = handle;
  first.previous = handle;
  return handle;
}

void PatternIndex::Remove(Handle handle) {
  const Entry& entry = entries_[handle];
  const unsigned shape = entry.shape;
  if (--shape_counts_[shape] == 0) shapes_ &= ~(1u << shape);
  free_.push_back(handle);
  if (entry.side != 0) {
    if (--guarded_counts_[shape] == 0) guarded_shapes_ &= ~(1u << shape);
    const auto found = guarded_.find(HashOfKey(entry.constants));
    Guarded& guarded = *found->second;
    (entry.side > 0 ? guarded.at_least : guarded.at_most).erase({entry.bound, handle});
    if (guarded.at_least.empty() && guarded.at_most.empty()) guarded_.erase(found);
    return;
  }
  Entry& previous = entries_[entry.previous];
  const bool is_first = previous.next == kNone, is_last = entry.next == kNone;
  if (!is_first) previous.next = entry.next;
  if (!is_last) entries_[entry.next].previous = entry.previous;
  if (!is_first && !is_last) return;
  const size_t at = SlotOf(HashOfKey(entry.constants));
  if (!is_first) {
    entries_[slots_[at].first].previous = entry.previous;
  } else if (!is_last) {
    slots_[at].first = entry.next;
  } else {
    FreeSlot(at);
  }
}

void PatternIndex::VisitGuarded(const Quad& quad, absl::FunctionRef<void(Reference)> visit) const {
  const NumberView view = ViewNumber(quad.object);
  if (view.kind == NumberView::Kind::kOther) return;
  const bool known = view.kind == NumberView::Kind::kNumber;
  for (unsigned rest = guarded_shapes_; rest != 0; rest &= rest - 1) {
    const auto shape = static_cast<unsigned>(std::countr_zero(rest));
    const QuadPattern key{(shape & 1) != 0 ? quad.subject : TermId(),
                          (shape & 2) != 0 ? quad.predicate : TermId(), TermId(), TermId()};
    const auto found = guarded_.find(HashOfKey(key));
    if (found == guarded_.end()) continue;
    const Guarded& guarded = *found->second;
    const auto look_at = [&](const Bound& bound) {
      const Entry& entry = entries_[bound.handle];
      if (Matches(entry, shape, quad)) visit(entry.reference);
    };
    for (const Bound& bound : guarded.at_least) {
      if (known && bound.value > view.value) break;
      look_at(bound);
    }
    for (auto it = guarded.at_most.rbegin(); it != guarded.at_most.rend(); ++it) {
      if (known && it->value < view.value) break;
      look_at(*it);
    }
  }
}

}  // namespace docent::matching
