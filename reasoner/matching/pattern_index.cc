#include "reasoner/matching/pattern_index.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace docent {
namespace {

bool EqualPositionsHold(uint8_t equal, const Quad& q) {
  if (equal == 0) return true;
  return (!(equal & MatchPattern::kSubjectPredicate) || q.subject == q.predicate) &&
         (!(equal & MatchPattern::kSubjectObject) || q.subject == q.object) &&
         (!(equal & MatchPattern::kPredicateObject) || q.predicate == q.object) &&
         (!(equal & MatchPattern::kSubjectGraph) || q.subject == q.graph) &&
         (!(equal & MatchPattern::kPredicateGraph) || q.predicate == q.graph) &&
         (!(equal & MatchPattern::kObjectGraph) || q.object == q.graph);
}

// What the terms of a key add to its hash; none adds nothing. Odd numbers from the digits of pi.
uint64_t SubjectPart(TermId subject) { return subject.bits() * 0x243f6a8885a308d3u; }
uint64_t PredicatePart(TermId predicate) { return predicate.bits() * 0x13198a2e03707345u; }
uint64_t ObjectPart(TermId object) { return object.bits() * 0xa4093822299f31d1u; }

uint32_t HashOf(uint64_t parts) {
  const auto product = static_cast<unsigned __int128>(parts) * 0x082efa98ec4e6c89u;
  return static_cast<uint32_t>(product >> 64) ^ static_cast<uint32_t>(product);
}

// Of the bits that say least about its place.
uint8_t TagOf(uint32_t hash) { return static_cast<uint8_t>(hash >> 24 | 1); }

unsigned ShapeOf(const QuadPattern& key) {
  return (key.subject.IsNone() ? 0u : 1u) | (key.predicate.IsNone() ? 0u : 2u) | (key.object.IsNone() ? 0u : 4u);
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

// Of subject, predicate and object.
uint32_t PatternIndex::HashOfKey(const Entry& entry) {
  const QuadPattern& key = entry.constants;
  return HashOf(SubjectPart(key.subject) + PredicatePart(key.predicate) + ObjectPart(key.object));
}

inline size_t PatternIndex::SlotOf(uint32_t hash) const {
  const size_t mask = tags_.size() - 1;
  const uint8_t tag = TagOf(hash);
  size_t at = hash & mask;
  while (tags_[at] != 0 && (tags_[at] != tag || slots_[at].hash != hash)) at = (at + 1) & mask;
  return at;
}

// What stands behind it for want of its own place moves up.
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

PatternIndex::Handle PatternIndex::Add(const MatchPattern& pattern, const QuadPattern& constants, Reference reference) {
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
  const uint32_t hash = HashOfKey(entry);
  if (pattern.object_guard && constants.object.IsNone()) {
    if (guarded_counts_[shape]++ == 0) guarded_shapes_ |= 1u << shape;
    std::unique_ptr<Guarded>& guarded = guarded_[hash];
    if (!guarded) guarded = std::make_unique<Guarded>();
    entry.bound = pattern.object_guard->bound;
    entry.side = IsLowerBound(pattern.object_guard->op) ? 1 : -1;
    (entry.side > 0 ? guarded->at_least : guarded->at_most).insert({entry.bound, handle});
    return handle;
  }
  if (2 * (taken_ + 1) > tags_.size()) Grow();
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
    const auto found = guarded_.find(HashOfKey(entry));
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
  const size_t at = SlotOf(HashOfKey(entry));
  if (!is_first) {
    entries_[slots_[at].first].previous = entry.previous;
  } else if (!is_last) {
    slots_[at].first = entry.next;
  } else {
    FreeSlot(at);
  }
}

// Another key may have the same hash, of another shape, too.
inline void PatternIndex::VisitEntry(const Entry& entry, unsigned shape, const Quad& quad,
                              absl::FunctionRef<void(Reference)> visit) const {
  if (entry.shape == shape && entry.constants.Matches(quad) && EqualPositionsHold(entry.equal, quad)) visit(entry.reference);
}

void PatternIndex::VisitGuarded(const Guarded& guarded, unsigned shape, const Quad& quad,
                                absl::FunctionRef<void(Reference)> visit) const {
  const NumberView view = ViewNumber(quad.object);
  if (view.kind == NumberView::Kind::kOther) return;
  const bool known = view.kind == NumberView::Kind::kNumber;
  for (const Bound& bound : guarded.at_least) {
    if (known && bound.value > view.value) break;
    VisitEntry(entries_[bound.handle], shape, quad, visit);
  }
  for (auto it = guarded.at_most.rbegin(); it != guarded.at_most.rend(); ++it) {
    if (known && it->value < view.value) break;
    VisitEntry(entries_[it->handle], shape, quad, visit);
  }
}

void PatternIndex::ForEachMatch(const Quad& quad, absl::FunctionRef<void(Reference)> visit) const {
  const uint64_t s = SubjectPart(quad.subject), p = PredicatePart(quad.predicate), o = ObjectPart(quad.object);
  const std::array<uint64_t, 8> parts = {0, s, p, s + p, o, s + o, p + o, s + p + o};  // by shape
  for (unsigned rest = shapes_; rest != 0; rest &= rest - 1) {
    const auto shape = static_cast<unsigned>(std::countr_zero(rest));
    const uint32_t hash = HashOf(parts[shape]);
    if (const size_t at = SlotOf(hash); tags_[at] != 0) {
      for (Handle handle = slots_[at].first; handle != kNone; handle = entries_[handle].next) {
        VisitEntry(entries_[handle], shape, quad, visit);
      }
    }
    if ((guarded_shapes_ & (1u << shape)) == 0) continue;
    if (const auto found = guarded_.find(hash); found != guarded_.end()) VisitGuarded(*found->second, shape, quad, visit);
  }
}

}  // namespace docent
