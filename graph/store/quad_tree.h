// A persistent B+-tree over keys of four 64-bit words: one index order of a graph version.
//
// Copying a tree costs one reference count; the copies share all nodes. A change copies the nodes on its
// path, except nodes of the same `epoch`: they belong to the only writer of this epoch and are changed in place.
//
// Many changes thus copy each node at most once, and a published tree never changes. Inner nodes store the
// number of keys beneath each child, so counts of ranges are exact.
//
// A leaf holds up to 256 keys. A word is stored as its distance from the leaf's smallest, in as few bytes as
// the leaf needs (0 to 8): neighbours share most of a key, so a key takes about 5 to 12 bytes, not 32.
//
// Threads: any number of readers of trees that no thread changes; one writer per tree object. Node reference
// counts have a lock of their own: trees that share nodes may be copied, changed and dropped on any thread.
#ifndef DOCENT_GRAPH_STORE_QUAD_TREE_H_
#define DOCENT_GRAPH_STORE_QUAD_TREE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace docent {

class QuadTree {
 public:
  using Key = std::array<uint64_t, 4>;
  struct Node;
  struct Leaf;
  struct Inner;
  class Iterator;
  class Edit;

  QuadTree() = default;
  QuadTree(const QuadTree& other);
  QuadTree& operator=(const QuadTree& other);
  QuadTree(QuadTree&& other) noexcept;
  QuadTree& operator=(QuadTree&& other) noexcept;
  ~QuadTree();

  // A unique number: the epoch of a writer's next unpublished changes. Any thread.
  static uint64_t NewEpoch();
  // A tree of these keys, which must be sorted and distinct, in well filled nodes.
  static QuadTree Build(const std::vector<Key>& keys, uint64_t epoch);

  // True if the tree changed. Iterators over this tree become invalid; those over copies of it do not.
  bool Insert(const Key& key, uint64_t epoch);
  bool Erase(const Key& key, uint64_t epoch);

  bool Contains(const Key& key) const;
  // True if a key begins with the first `words` words of `first`, whose other words are 0. O(log n); most
  // often O(1) near the last Insert or Erase of this tree object.
  bool ContainsPrefix(const Key& first, int words) const;
  // Number of keys k with first <= k <= last. O(log n).
  uint64_t CountRange(const Key& first, const Key& last) const;
  // The key at position `rank` of the order; number of keys below `key`. O(log n). Requires rank < size().
  Key KeyAt(uint64_t rank) const;
  uint64_t RankOf(const Key& key) const { return CountBelow(root_, 0, key, false); }
  // The keys k with first <= k <= last, in order. The tree must outlive the iterator.
  Iterator Range(const Key& first, const Key& last) const;
  // *iterator = Range(first, last), without a copy.
  void Range(const Key& first, const Key& last, Iterator* iterator) const;

  uint64_t size() const { return size_; }
  // Memory of all nodes reachable from this tree, shared or not. O(1).
  size_t bytes() const { return bytes_; }
  // Grows with each change by the bytes that only earlier trees still hold: for two trees of one history the
  // difference is the cost of keeping the earlier one.
  size_t replaced_bytes() const { return replaced_bytes_; }
  // Aborts if an invariant is broken (order, counts, separators, byte count). For tests; O(n).
  void CheckInvariants() const;

 private:
  static constexpr int kMaxHeight = 16;
  struct Path;

  // The place of the last Insert or Erase, while no other change can have moved it. Copies do not have it.
  struct LastEdit {
    const Leaf* leaf = nullptr;
    // Of the inserted key, or of the key after the erased one; may be the leaf's count.
    int position = 0;
  };
  // ContainsPrefix by the keys at that place; nullopt: they do not decide.
  std::optional<bool> ContainsPrefixThere(const Key& first, int words) const;

  Path Descend(const Key& key) const;
  void MakeWritable(Edit& edit, Path* path);
  // Number of keys below `key` (or equal, if inclusive) beneath `node`, which is at `level`.
  uint64_t CountBelow(const Node* node, int level, const Key& key, bool inclusive) const;

  Node* root_ = nullptr;  // null: empty
  uint64_t size_ = 0;
  size_t bytes_ = 0;
  size_t replaced_bytes_ = 0;
  int height_ = 0;  // inner levels above the leaves
  LastEdit last_edit_;
};

// A position in a range of a tree. Usage: for (auto i = tree.Range(a, b); i.Valid(); i.Next()) use(i.key());
// One thread.
class QuadTree::Iterator {
 public:
  Iterator() = default;
  bool Valid() const { return position_ < limit_; }
  // Requires Valid(), as all functions up to Next.
  Key key() const;
  // The leaf of key(), for files that include quad_tree_node.h to read it in place.
  const Leaf* leaf() const { return leaf_; }
  int position() const { return position_; }
  // One past the last position of leaf() that is within the range.
  int limit() const { return limit_; }
  // True if the next key, if any, is in another leaf.
  bool NextIsElsewhere() const { return position_ + 1 == limit_ && !last_leaf_; }
  void Next() {
    if (++position_ == limit_ && !last_leaf_) NextLeaf();
  }
  // Moves to the first key of the range beyond leaf().
  void SkipLeaf() {
    position_ = limit_;
    if (!last_leaf_) NextLeaf();
  }
  // Moves forward to the first key >= target of the range; stays if the current key is. O(log distance).
  void Seek(const Key& target);
  // As a new Range(first, last) of this iterator's tree (made by a Range with first <= last), which must not
  // have changed meanwhile. Fast if `first` lies in the current leaf: lookups with rising or repeating keys
  // need no descent.
  void Restart(const Key& first, const Key& last);
  // Number of Restarts that descended.
  uint64_t descents() const { return descents_; }

 private:
  friend class QuadTree;
  void NextLeaf();
  void EnterLeaf(const Leaf* leaf, const Key& from);
  void SetLimit();
  void DescendFrom(int level, const Node* node, const Key& target);
  bool IsBeneath(int level, const Key& target) const;

  struct Step {
    const Inner* node;
    int index;  // the child on the path
  };
  std::array<Step, kMaxHeight> path_;  // from the root down; the first height_ are set
  const Leaf* leaf_ = nullptr;
  int height_ = 0;
  int position_ = 0;
  int limit_ = 0;
  bool last_leaf_ = true;  // the range ends in this leaf
  Key last_ = {};
  uint64_t descents_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_TREE_H_
