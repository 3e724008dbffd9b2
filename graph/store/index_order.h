// Key layouts of the indexes, and the range of an index that holds a pattern's matches.
#ifndef DOCENT_GRAPH_STORE_INDEX_ORDER_H_
#define DOCENT_GRAPH_STORE_INDEX_ORDER_H_

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "graph/store/quad.h"
#include "graph/store/quad_tree.h"

namespace docent {

enum class IndexOrder : uint8_t { kSpog = 0, kPosg = 1, kOspg = 2, kGspo = 3 };
inline constexpr int kIndexOrders = 4;

// The position of a quad (0 to 3: subject, predicate, object, graph) that each word of a key holds, by order.
inline constexpr std::array<std::array<uint8_t, 4>, kIndexOrders> kPositions = {
    {{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}, {3, 0, 1, 2}}};
// The word of a key that holds each position of a quad.
inline constexpr auto kWords = [] {
  std::array<std::array<uint8_t, 4>, kIndexOrders> words{};
  for (int order = 0; order < kIndexOrders; ++order) {
    for (uint8_t word = 0; word < 4; ++word) words[order][kPositions[order][word]] = word;
  }
  return words;
}();

// Reads one word: a load of two words just stored, as in a copy of the quad, would stall the processor.
inline uint64_t WordAt(const Quad& quad, int position) {
  uint64_t word;
  std::memcpy(&word, reinterpret_cast<const char*>(&quad) + static_cast<size_t>(position) * sizeof(word),
              sizeof(word));
  return word;
}

inline QuadTree::Key KeyOf(const Quad& quad, IndexOrder order) {
  const auto& positions = kPositions[static_cast<size_t>(order)];
  return {WordAt(quad, positions[0]), WordAt(quad, positions[1]), WordAt(quad, positions[2]),
          WordAt(quad, positions[3])};
}

inline Quad QuadOf(const QuadTree::Key& key, IndexOrder order) {
  const auto& words = kWords[static_cast<size_t>(order)];
  return {TermId(key[words[0]]), TermId(key[words[1]]), TermId(key[words[2]]), TermId(key[words[3]])};
}

// The bound positions of a pattern as bits: 1, 2, 4, 8.
inline unsigned BoundIn(const QuadPattern& p) {
  return (p.subject.IsNone() ? 0u : 1u) | (p.predicate.IsNone() ? 0u : 2u) | (p.object.IsNone() ? 0u : 4u) |
         (p.graph.IsNone() ? 0u : 8u);
}

// Number of words of a key before the first unbound one, by order and bound positions.
inline constexpr auto kPrefixes = [] {
  std::array<std::array<uint8_t, 16>, kIndexOrders> prefixes{};
  for (int order = 0; order < kIndexOrders; ++order) {
    for (unsigned bound = 0; bound < 16; ++bound) {
      while (prefixes[order][bound] < 4 && (bound >> kPositions[order][prefixes[order][bound]] & 1) != 0)
        ++prefixes[order][bound];
    }
  }
  return prefixes;
}();

// The same if all bound words come first.
inline constexpr auto kWholePrefixes = [] {
  std::array<uint8_t, 16> prefixes{};
  for (unsigned bound = 0; bound < 16; ++bound) prefixes[bound] = static_cast<uint8_t>(std::popcount(bound));
  return prefixes;
}();

// True if the matches of a pattern with these bound positions are exactly one run in `order`.
inline bool IsExact(unsigned bound, IndexOrder order) {
  return kWholePrefixes[bound] == kPrefixes[static_cast<size_t>(order)][bound];
}

// The index run of all patterns that bind the same positions (BoundIn): their matches and no others.
struct AccessPath {
  IndexOrder order = IndexOrder::kSpog;
  int prefix = 0;  // bound words of a key; the others are free
};

// The keys of `order` that agree with the pattern's bound words (BoundIn) up to the first unbound one.
struct KeyRange {
  QuadTree::Key first;
  QuadTree::Key last;
  bool exact;  // no word after the first unbound one is bound
};

inline KeyRange RangeOf(const QuadPattern& p, unsigned bound, IndexOrder order) {
  const int prefix = kPrefixes[static_cast<size_t>(order)][bound];
  const QuadTree::Key key = KeyOf(Quad{p.subject, p.predicate, p.object, p.graph}, order);
  KeyRange range;
  for (int i = 0; i < 4; ++i) {
    const uint64_t free = i < prefix ? 0 : ~uint64_t{0};
    range.first[i] = key[i] & ~free;
    range.last[i] = key[i] | free;
  }
  range.exact = IsExact(bound, order);
  return range;
}

inline KeyRange RangeOf(const QuadPattern& p, const AccessPath& path) {
  static constexpr auto kFree = [] {
    std::array<QuadTree::Key, 5> free{};
    for (int prefix = 0; prefix < 4; ++prefix) {
      for (int word = prefix; word < 4; ++word) free[prefix][word] = ~uint64_t{0};
    }
    return free;
  }();
  const QuadTree::Key& free = kFree[path.prefix];
  KeyRange range;
  range.first =
      KeyOf(Quad{p.subject, p.predicate, p.object, p.graph}, path.order);  // free words are none, that is 0
  for (int i = 0; i < 4; ++i) range.last[i] = range.first[i] | free[i];
  range.exact = true;
  return range;
}

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_INDEX_ORDER_H_
