// Discrimination index: finds the patterns that a changed quad matches.
//
// Patterns are stored by hash of their constants. A quad is looked up once for each *shape* in use
// (which of subject, predicate and object are constants: at most eight), so the cost does not
// depend on the number of patterns that do not match. Patterns with the same constants and a bound
// on the object's number are ordered by that number: those that the quad does not reach are not
// visited.
//
// Writer thread only.
#ifndef DOCENT_REASONER_MATCHING_PATTERN_INDEX_H_
#define DOCENT_REASONER_MATCHING_PATTERN_INDEX_H_

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/container/btree_set.h"
#include "absl/container/flat_hash_map.h"
#include "absl/functional/function_ref.h"
#include "graph/store/quad.h"
#include "reasoner/matching/number_range.h"

namespace docent::matching {

// A quad pattern, with further conditions that one quad alone decides.
struct MatchPattern {
  QuadPattern constants;  // kNone: a variable
  // Positions with the same variable, as pairs: ?x ex:knows ?x is kSubjectObject.
  enum Equal : uint8_t {
    kSubjectPredicate = 1,
    kSubjectObject = 2,
    kPredicateObject = 4,
    kSubjectGraph = 8,
    kPredicateGraph = 16,
    kObjectGraph = 32,
  };
  uint8_t equal = 0;
  std::optional<NumberGuard>
      object_guard;  // a necessary condition on the object; may accept too much, never too little

  bool Matches(const Quad& quad) const;
};

class PatternIndex {
 public:
  // Names a registered pattern until its removal; then the number is reused.
  using Handle = uint32_t;
  // Data that the owner gets back: the owner, its pattern, and a detail.
  struct Reference {
    uint32_t owner = 0;
    uint32_t pattern = 0;
    uint16_t detail = 0;
    friend bool operator==(const Reference&, const Reference&) = default;
  };

  Handle Add(const MatchPattern& pattern, Reference reference) {
    return Add(pattern, pattern.constants, reference);
  }
  // `pattern` with these constants instead of its own. It has no guard if the object is one of them.
  Handle Add(const MatchPattern& pattern, const QuadPattern& constants, Reference reference);
  // `handle` must come from Add and not be removed. Constant time (logarithmic with a guard).
  void Remove(Handle handle);

  // Calls `visit(reference)` for each pattern that matches `quad`: those with the same constants in the order
  // of insertion, those with a guard after the others. `visit` must not change the index.
  template <typename Visit>
  void ForEachMatch(const Quad& quad, const Visit& visit) const;

  size_t size() const { return entries_.size() - free_.size(); }

 private:
  struct Bound {
    double value;
    Handle handle;
    friend auto operator<=>(const Bound&, const Bound&) = default;
  };
  struct Guarded {
    absl::btree_set<Bound> at_least;  // object >= value (and >): visited up to the object's number
    absl::btree_set<Bound> at_most;
  };
  // One cache line: among ten thousands of patterns, the one that a change touches is usually not cached.
  struct alignas(64) Entry {
    QuadPattern constants;
    Reference reference;
    Handle next = kNone,
           previous = kNone;  // without a guard: those with the same hash; before the first comes the last
    uint8_t equal = 0;
    uint8_t shape = 0;  // bit 0 subject, 1 predicate, 2 object: it is a constant
    int8_t side = 0;    // 0: no guard, +1: at_least, -1: at_most
    double bound = 0;
  };
  static constexpr Handle kNone = ~Handle{0};
  static_assert(sizeof(Entry) == 64);
  // Start of the list of patterns without a guard whose keys have this hash.
  struct Slot {
    uint32_t hash = 0;
    Handle first = kNone;
  };

  // Contribution of each term of a key to its hash; kNone contributes 0. Odd numbers from the digits of pi.
  static uint64_t SubjectPart(TermId subject) { return subject.bits() * 0x243f6a8885a308d3u; }
  static uint64_t PredicatePart(TermId predicate) { return predicate.bits() * 0x13198a2e03707345u; }
  static uint64_t ObjectPart(TermId object) { return object.bits() * 0xa4093822299f31d1u; }
  static uint32_t HashOf(uint64_t parts) {
    const auto product = static_cast<unsigned __int128>(parts) * 0x082efa98ec4e6c89u;
    return static_cast<uint32_t>(product >> 64) ^ static_cast<uint32_t>(product);
  }
  static uint32_t HashOfKey(const QuadPattern& key) {
    return HashOf(SubjectPart(key.subject) + PredicatePart(key.predicate) + ObjectPart(key.object));
  }
  // From the bits that are used least for the place.
  static uint8_t TagOf(uint32_t hash) { return static_cast<uint8_t>(hash >> 24 | 1); }
  static size_t BucketOf(uint64_t predicate_part) { return predicate_part >> 56; }
  // The slot with the hash, or the free slot where it belongs.
  size_t SlotOf(uint32_t hash) const {
    const size_t mask = tags_.size() - 1;
    const uint8_t tag = TagOf(hash);
    size_t at = hash & mask;
    while (tags_[at] != 0 && (tags_[at] != tag || slots_[at].hash != hash)) at = (at + 1) & mask;
    return at;
  }
  // Calls `visit(shape, hash)` for each shape that may have a matching pattern.
  template <typename Visit>
  void ForEachHash(const Quad& quad, const Visit& visit) const;
  // Calls `found(shape, slot)` for each shape that has patterns with the quad's hash.
  template <typename Found>
  void ForEachSlot(const Quad& quad, const Found& found) const;
  void FreeSlot(size_t at);
  void Grow();
  // Needed because another key may have the same hash, even of another shape.
  static bool Matches(const Entry& entry, unsigned shape, const Quad& quad);
  void VisitGuarded(const Quad& quad, absl::FunctionRef<void(Reference)> visit) const;

  std::vector<Entry> entries_;  // by handle
  // By hash of the key; the key itself is compared at the visit. Linear probing, at most five eighths full.
  // Most lookups find nothing: that takes one multiplication and a tag, and the tags of ten thousands stay in
  // the cache.
  std::vector<uint8_t> tags_ = {0};  // of each slot a part of the hash; 0: free
  std::vector<Slot> slots_ = std::vector<Slot>(1);
  size_t taken_ = 0;  // used slots
  absl::flat_hash_map<uint32_t, std::unique_ptr<Guarded>> guarded_;
  unsigned shapes_ = 0;  // bit i: shape i has any
  // The same for the patterns with a predicate of this hash; bits are never cleared. Usually a quad then need
  // not be looked up for all shapes in use.
  std::array<uint8_t, 256> by_predicate_ = {};
  static constexpr unsigned kWithoutPredicate = 0b00110011;
  unsigned guarded_shapes_ = 0;  // bit i: shape i has any with a guard
  std::vector<Handle> free_;
  std::array<size_t, 8> shape_counts_ = {};
  std::array<size_t, 8> guarded_counts_ = {};
};

inline bool EqualPositionsHold(uint8_t equal, const Quad& q) {
  if (equal == 0) return true;
  return (!(equal & MatchPattern::kSubjectPredicate) || q.subject == q.predicate) &&
         (!(equal & MatchPattern::kSubjectObject) || q.subject == q.object) &&
         (!(equal & MatchPattern::kPredicateObject) || q.predicate == q.object) &&
         (!(equal & MatchPattern::kSubjectGraph) || q.subject == q.graph) &&
         (!(equal & MatchPattern::kPredicateGraph) || q.predicate == q.graph) &&
         (!(equal & MatchPattern::kObjectGraph) || q.object == q.graph);
}

inline bool PatternIndex::Matches(const Entry& entry, unsigned shape, const Quad& quad) {
  return entry.shape == shape && entry.constants.Matches(quad) && EqualPositionsHold(entry.equal, quad);
}

template <typename Visit>
void PatternIndex::ForEachHash(const Quad& quad, const Visit& visit) const {
  const uint64_t s = SubjectPart(quad.subject), p = PredicatePart(quad.predicate),
                 o = ObjectPart(quad.object);
  const std::array<uint64_t, 8> parts = {0, s, p, s + p, o, s + o, p + o, s + p + o};  // by shape
  for (unsigned rest = shapes_ & (kWithoutPredicate | by_predicate_[BucketOf(p)]); rest != 0;
       rest &= rest - 1) {
    const auto shape = static_cast<unsigned>(std::countr_zero(rest));
    visit(shape, HashOf(parts[shape]));
  }
}

template <typename Found>
void PatternIndex::ForEachSlot(const Quad& quad, const Found& found) const {
  // All tags are prefetched before the first is used.
  struct Lookup {
    unsigned shape;
    uint32_t hash;
    uint8_t tag;
  };
  std::array<Lookup, 8> lookups;
  size_t count = 0;
  const size_t mask = tags_.size() - 1;
  ForEachHash(quad, [&](unsigned shape, uint32_t hash) {
    lookups[count++] = {shape, hash, tags_[hash & mask]};
  });
  for (size_t i = 0; i < count; ++i) {
    if (lookups[i].tag == 0) continue;
    const size_t at = SlotOf(lookups[i].hash);
    if (tags_[at] != 0) found(lookups[i].shape, slots_[at]);
  }
}

template <typename Visit>
void PatternIndex::ForEachMatch(const Quad& quad, const Visit& visit) const {
  ForEachSlot(quad, [&](unsigned shape, const Slot& slot) {
    for (Handle handle = slot.first; handle != kNone; handle = entries_[handle].next) {
      const Entry& entry = entries_[handle];
      if (Matches(entry, shape, quad)) visit(entry.reference);
    }
  });
  if (guarded_shapes_ != 0) VisitGuarded(quad, visit);
}

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_PATTERN_INDEX_H_
