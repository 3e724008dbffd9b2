// Making, sharing and changing the nodes of a QuadTree: the steps of Insert, Erase and Build.
// Included only by quad_tree*.cc and graph_writer.cc. Writer thread of the tree.
#ifndef DOCENT_GRAPH_STORE_QUAD_TREE_EDIT_H_
#define DOCENT_GRAPH_STORE_QUAD_TREE_EDIT_H_

#include <span>
#include <vector>

#include "graph/store/quad_tree_node.h"

namespace docent {

// Changes under one epoch. Node arguments are owned by the caller's slot: a function that returns a node has
// taken over the reference of the one that it was given, and the caller stores what it gets back.
class QuadTree::Edit {
 public:
  // A node split off to the right of another, with the smallest key that belongs there.
  struct Right {
    Node* node = nullptr;
    Key first = {};
    uint64_t size = 0;  // keys beneath it
  };

  explicit Edit(uint64_t epoch) : epoch_(epoch) {}
  Edit(const Edit&) = delete;
  Edit& operator=(const Edit&) = delete;
  ~Edit() { Unlock(); }

  // One reference more, and one less: frees the node and what hangs on it alone. Any thread, but not beside an Edit of its own
  // that has changed something: that one may hold the lock.
  static void Acquire(Node* node);
  static void Release(Node* node);
  static size_t BytesOf(const Node* node);
  static uint64_t SizeOf(const Node* node);

  // A leaf of these sorted keys with room for `spare` more.
  Leaf* NewLeaf(std::span<const Key> keys, int spare);
  Inner* NewInner();

  // `position` is where `key` belongs. If the leaf is full, its upper part moves into `right`.
  Leaf* InsertIntoLeaf(Leaf* leaf, int position, const Key& key, Right* right);
  Leaf* EraseFromLeaf(Leaf* leaf, int position);  // null when it became empty
  // This inner node, or a copy that may be changed.
  Inner* Writable(Inner* inner);
  // Puts `child` behind child `index` of a writable node, which is split if full.
  void InsertChild(Inner* inner, int index, const Right& child, Right* right);
  void RemoveChild(Inner* inner, int index);
  Node* DropEmpty(Inner* inner);      // frees a writable node without children; null
  Node* TakeOnlyChild(Inner* inner);  // forgets a node with one child, writable or not; the child
  // If child `index` of a writable node is small and fits together with a neighbour, makes one of the two.
  void MergeChild(Inner* inner, int index);

  // Inserts all of these keys, which must be sorted and distinct; those that the tree has already stay. Goes down once to
  // each leaf that gets some, so that many keys cost much less than as many Insert. Iterators as after Insert.
  static void InsertSorted(QuadTree* tree, std::span<const Key> keys, uint64_t epoch);

  // Well filled leaves of these keys, appended to `out`.
  void MakeLeaves(std::span<const Key> keys, std::vector<Right>* out);
  // Well filled inner nodes over these children, appended to `out`.
  void MakeInners(std::span<const Right> children, std::vector<Right>* out);
  // `node`, which has `levels` inner levels beneath and including it, with the sorted `keys` put in, as one node or several
  // in order. Takes over the reference of `node`; `first` is the smallest key that belongs there.
  void InsertRun(Node* node, int levels, const Key& first, std::span<const Key> keys,
                 std::vector<Right>* out);

  int64_t bytes_change() const { return bytes_change_; }
  // Bytes of the nodes of other epochs that left the tree: what older versions alone hold from now on.
  size_t replaced_bytes() const { return replaced_bytes_; }

 private:
  // Held where references of nodes that others may hold are counted; from the first such node until Unlock or the end, so as
  // to lock once for a path.
  void Lock();
  void Unlock();
  static Right Fill(Inner* inner, std::span<const Right> children);
  void InsertRunIntoLeaf(Leaf* leaf, const Key& first, std::span<const Key> keys, std::vector<Right>* out);
  // Forgets a node that left the tree.
  void Drop(Node* node);
  Leaf* Allocate(size_t capacity, size_t stride);
  // A copy with room for `capacity` keys, for the writer.
  Leaf* CopyLeaf(const Leaf* leaf, int capacity);
  void Append(Inner* to, const Inner* from, const Key& first);

  uint64_t epoch_;
  bool locked_ = false;
  int64_t bytes_change_ = 0;
  size_t replaced_bytes_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_TREE_EDIT_H_
