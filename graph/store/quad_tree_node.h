// Nodes of a QuadTree. Included only by quad_tree*.cc, and by quad_cursor.h: cursors read keys in place.
//
// A node is shared by reference count. Only a writer with the node's epoch may change it; such a node is
// reachable from that writer's tree alone, and its count is the writer's. All other counts are under one
// lock (Edit::Lock), taken once for a whole path: a copy of a node increments the counts of all its
// children, and atomic counts made a version of one fact 1.3 to 1.8 times slower.
#ifndef DOCENT_GRAPH_STORE_QUAD_TREE_NODE_H_
#define DOCENT_GRAPH_STORE_QUAD_TREE_NODE_H_

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "graph/store/quad_tree.h"

namespace docent {

struct QuadTree::Node {
  uint32_t references = 1;
  uint16_t count = 0;  // keys of a leaf, children of an inner node
  bool is_leaf = false;
  uint64_t epoch = 0;
};

// Keys in order, packed: word c of key i is base[c] plus the low bytes (mask[c]) of the 8 bytes at data()[i *
// stride + offset[c]]. A read always takes 8 bytes, so kPadding bytes follow the last key.
struct QuadTree::Leaf : Node {
  static constexpr int kMaxKeys = 256;
  static constexpr int kMinKeys = kMaxKeys / 4;
  static constexpr size_t kPadding = 8;

  Key base = {};
  std::array<uint64_t, 4> mask = {};
  std::array<uint8_t, 4> offset = {};
  uint8_t stride = 0;
  uint16_t capacity = 0;  // keys that fit into the allocation

  uint8_t* data() { return reinterpret_cast<uint8_t*>(this + 1); }
  const uint8_t* data() const { return reinterpret_cast<const uint8_t*>(this + 1); }

  uint64_t Word(int i, int column) const {
    uint64_t raw;
    std::memcpy(&raw, data() + static_cast<size_t>(i) * stride + offset[column], sizeof(raw));
    return base[column] + (raw & mask[column]);
  }
  Key KeyAt(int i) const { return {Word(i, 0), Word(i, 1), Word(i, 2), Word(i, 3)}; }
  // True if `key` fits into this leaf's columns. (For a word below the base the difference wraps and is
  // larger than the mask, since base + mask is at most 2^64 - 1.)
  bool Holds(const Key& key) const {
    for (int c = 0; c < 4; ++c) {
      if (key[c] - base[c] > mask[c]) return false;
    }
    return true;
  }
  void Write(int i, const Key& key);
  // The first position in [from, to) whose key is >= `key`; `to` if none.
  int LowerBound(const Key& key, int from, int to) const;
  // The same, faster if it is near `from`.
  int LowerBoundNear(const Key& key, int from, int to) const;
  // The first position from `from` on whose key is > `key`; `count` if none. Faster if it is near `from`.
  int UpperBoundNear(const Key& key, int from) const;
  // Compares from `column` on.
  bool LessAt(int i, const Key& key, int column = 0) const {
    for (; column < 4; ++column) {
      const uint64_t word = Word(i, column);
      if (word != key[column]) return word < key[column];
    }
    return false;
  }

  bool GreaterAt(int i, const Key& key) const {
    for (int column = 0; column < 4; ++column) {
      const uint64_t word = Word(i, column);
      if (word != key[column]) return word > key[column];
    }
    return false;
  }

  size_t allocated() const { return AllocationFor(capacity, stride); }
  static size_t AllocationFor(size_t capacity, size_t stride) {
    return sizeof(Leaf) + capacity * stride + kPadding;
  }
};
static_assert(std::endian::native == std::endian::little, "packed keys are read as little-endian words");

// Child i holds the keys k with keys[i] <= k < keys[i + 1]; keys[0] counts as minus infinity, never read.
// Few children: a copied node counts a reference to each (16 instead of 32 made versions of one fact 1.1 to
// 1.25 times faster; 128 keys a leaf made scans 1.5 times slower).
struct QuadTree::Inner : Node {
  static constexpr int kMaxChildren = 16;
  static constexpr int kMinChildren = kMaxChildren / 4;

  std::array<Key, kMaxChildren> keys;
  std::array<uint64_t, kMaxChildren> counts;  // keys beneath each child
  std::array<Node*, kMaxChildren> children;

  // The child whose range holds `key`.
  int ChildFor(const Key& key) const {
    int low = 0, size = count;
    while (size > 1) {
      int half = size / 2;
      low = IsGreater(keys[low + half], key) ? low : low + half;
      size -= half;
    }
    return low;
  }
  static bool IsGreater(const Key& a, const Key& b) {  // std::array compares with a loop of its own
    for (int column = 0; column < 3; ++column) {
      if (a[column] != b[column]) return a[column] > b[column];
    }
    return a[3] > b[3];
  }
  uint64_t Total() const {
    uint64_t total = 0;
    for (int i = 0; i < count; ++i) total += counts[i];
    return total;
  }
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_TREE_NODE_H_
