// The discrimination index: given a changed quad, the patterns that it matches.
//
// Patterns are kept by hash of their constants. A quad is looked up once for each *shape* in use (which of
// subject, predicate and object are constants: at most eight), so the cost does not depend on how many
// patterns exist that do not match. Patterns that look at the same quads and ask besides that the object be
// above or below a number are kept ordered by that number: those that the quad does not reach are not
// visited.
//
// Writer thread only.
#ifndef DOCENT_REASONER_MATCHING_PATTERN_INDEX_H_
#define DOCENT_REASONER_MATCHING_PATTERN_INDEX_H_

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/container/btree_set.h"
#include "absl/container/flat_hash_map.h"
#include "absl/functional/function_ref.h"
#include "kb_server/store/quad.h"
#include "reasoner/matching/number_range.h"

namespace docent {

// A quad pattern with what else one quad alone can decide.
struct MatchPattern {
  QuadPattern constants;  // none: a variable
  // Positions that hold the same variable, as pairs: ?x ex:knows ?x is kSubjectObject.
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
      object_guard;  // necessary for the object; may let too much through, never too little

  bool Matches(const Quad& quad) const;
};

class PatternIndex {
 public:
  // Names a registered pattern until it is removed; then the number is used again.
  using Handle = uint32_t;
  // What the owner wants back: who it is, which of its patterns, and what else it likes to know.
  struct Reference {
    uint32_t owner = 0;
    uint32_t pattern = 0;
    uint16_t detail = 0;
    friend bool operator==(const Reference&, const Reference&) = default;
  };

  Handle Add(const MatchPattern& pattern, Reference reference) { return Add(pattern, pattern.constants, reference); }
  // `pattern` with these constants instead of its own. It has no guard where the object is one of them.
  Handle Add(const MatchPattern& pattern, const QuadPattern& constants, Reference reference);
  // `handle` came from Add and was not removed since. Constant time (logarithmic with a guard).
  void Remove(Handle handle);

  // Calls `visit` for each pattern that matches `quad`: those with the same constants in the order in which they were
  // added, those with a guard after the others. `visit` must not change the index.
  void ForEachMatch(const Quad& quad, absl::FunctionRef<void(Reference)> visit) const;

  size_t size() const { return entries_.size() - free_.size(); }

 private:
  struct Bound {
    double value;
    Handle handle;
    friend auto operator<=>(const Bound&, const Bound&) = default;
  };
  struct Guarded {
    absl::btree_set<Bound> at_least;  // object >= value (and >): all up to the object's number are visited
    absl::btree_set<Bound> at_most;
  };
  // One line of the cache: what a change touches of ten thousands of patterns is most often not in it.
  struct alignas(64) Entry {
    QuadPattern constants;
    Reference reference;
    Handle next = kNone, previous = kNone;  // without a guard: those with the same hash; before the first comes the last
    uint8_t equal = 0;
    uint8_t shape = 0;  // bit 0 subject, 1 predicate, 2 object: it is a constant
    int8_t side = 0;    // 0: no guard, +1: at_least, -1: at_most
    double bound = 0;
  };
  static constexpr Handle kNone = ~Handle{0};
  static_assert(sizeof(Entry) == 64);
  // Where the patterns without a guard begin whose keys have this hash.
  struct Slot {
    uint32_t hash = 0;
    Handle first = kNone;
  };

  static uint32_t HashOfKey(const Entry& entry);
  // The slot with the hash, or the free one where it belongs.
  size_t SlotOf(uint32_t hash) const;
  void FreeSlot(size_t at);
  void Grow();
  void VisitGuarded(const Guarded& guarded, unsigned shape, const Quad& quad,
                    absl::FunctionRef<void(Reference)> visit) const;
  void VisitEntry(const Entry& entry, unsigned shape, const Quad& quad,
                  absl::FunctionRef<void(Reference)> visit) const;

  std::vector<Entry> entries_;  // by handle
  // By hash of the key, which an entry is compared with when it is visited. Linear probing, at most half of it taken. Most
  // lookups find nothing: that takes one multiplication and a tag, and the tags of ten thousands are in the cache.
  std::vector<uint8_t> tags_ = {0};  // of each slot a part of the hash; 0: free
  std::vector<Slot> slots_ = std::vector<Slot>(1);
  size_t taken_ = 0;  // slots
  absl::flat_hash_map<uint32_t, std::unique_ptr<Guarded>> guarded_;
  unsigned shapes_ = 0;          // bit i: shape i has any
  unsigned guarded_shapes_ = 0;  // bit i: shape i has any with a guard
  std::vector<Handle> free_;
  std::array<size_t, 8> shape_counts_ = {};
  std::array<size_t, 8> guarded_counts_ = {};
};

}  // namespace docent

#endif  // DOCENT_REASONER_MATCHING_PATTERN_INDEX_H_
