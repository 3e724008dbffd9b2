// Operations on the nodes of a QuadTree: making, sharing and changing them; the steps of Insert, Erase and
// Build. Included only by quad_tree*.cc and graph_writer.cc. Writer thread of the tree.
#ifndef DOCENT_GRAPH_STORE_QUAD_TREE_EDIT_H_
#define DOCENT_GRAPH_STORE_QUAD_TREE_EDIT_H_

#include <span>
#include <vector>

#include "graph/store/quad_tree_node.h"

namespace docent {

// Changes under one epoch. A node argument is owned by the caller's slot: a function that returns a node has
// taken over the reference to its argument, and the caller stores the returned node in the slot.
class QuadTree::Edit {
 public:
  // A node split off to the right of another, with the smallest key that belongs into it.
  struct Right {
    Node* node = nullptr;
    Key first = {};
    uint64_t size = 0;  // keys beneath it
  };

  explicit Edit(uint64_t epoch) : epoch_(epoch) {}
  Edit(const Edit&) = delete;
  Edit& operator=(const Edit&) = delete;
  ~Edit() { Unlock(); }

  // Adds and removes one reference; the last one frees the node and the nodes that only it holds. Any thread,
  // but not on a thread with an Edit that has changed something: that Edit may hold the lock.
  static void Acquire(Node* node);
  static void Release(Node* node);
  static size_t BytesOf(const Node* node);
  static uint64_t SizeOf(const Node* node);

  // A leaf of these sorted keys with space for `spare` more.
  Leaf* NewLeaf(std::span<const Key> keys, int spare);
  Inner* NewInner();

  // `position` is where `key` belongs. If the leaf is full, its upper part moves into `right`.
  Leaf* InsertIntoLeaf(Leaf* leaf, int position, const Key& key, Right* right);
  Leaf* EraseFromLeaf(Leaf* leaf, int position);  // null when it became empty
  // This inner node, or a copy that may be changed.
  Inner* Writable(Inner* inner);
  // Inserts `child` after child `index` of a writable node, which is split if full.
  void InsertChild(Inner* inner, int index, const Right& child, Right* right);
  void RemoveChild(Inner* inner, int index);
  Node* DropEmpty(Inner* inner);      // frees a writable node without children; null
  Node* TakeOnlyChild(Inner* inner);  // forgets a node with one child, writable or not; the child
  // If child `index` of a writable node is small and fits into one node with a neighbour, merges the two.
  void MergeChild(Inner* inner, int index);

  // Inserts all of these keys, which must be sorted and distinct; keys already in the tree stay. Descends
  // once to each affected leaf, so many keys cost much less than as many Inserts. Iterators as after Insert.
  static void InsertSorted(QuadTree* tree, std::span<const Key> keys, uint64_t epoch);

  // Well filled leaves of these keys, appended to `out`.
  void MakeLeaves(std::span<const Key> keys, std::vector<Right>* out);
  // Well filled inner nodes over these children, appended to `out`.
  void MakeInners(std::span<const Right> children, std::vector<Right>* out);
  // `node`, which has `levels` inner levels (itself included), with the sorted `keys` inserted: one node or
  // several in order. Takes over the reference to `node`; `first` is the smallest key that belongs into it.
  void InsertRun(Node* node, int levels, const Key& first, std::span<const Key> keys,
                 std::vector<Right>* out);

  int64_t bytes_change() const { return bytes_change_; }
  // Bytes of the nodes of other epochs that left the tree; only older versions hold them from now on.
  size_t replaced_bytes() const { return replaced_bytes_; }

 private:
  // Taken when the counts of nodes that others may hold change; held from the first such node until Unlock or
  // the end, so that a path is locked once.
  void Lock();
  void Unlock();
  static Right Fill(Inner* inner, std::span<const Right> children);
  void InsertRunIntoLeaf(Leaf* leaf, const Key& first, std::span<const Key> keys, std::vector<Right>* out);
  // Releases a node that left the tree.
  void Drop(Node* node);
  Leaf* Allocate(size_t capacity, size_t stride);
  // A writable copy with space for `capacity` keys.
  Leaf* CopyLeaf(const Leaf* leaf, int capacity);
  void Append(Inner* to, const Inner* from, const Key& first);

  uint64_t epoch_;
  bool locked_ = false;
  int64_t bytes_change_ = 0;
  size_t replaced_bytes_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_TREE_EDIT_H_
