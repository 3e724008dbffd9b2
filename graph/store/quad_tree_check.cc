#include <cstdio>
#include <cstdlib>

#include "graph/store/quad_tree_edit.h"

namespace docent {
namespace {

void Require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "quad tree: %s\n", what);
  std::abort();
}

struct Totals {
  uint64_t keys = 0;
  size_t bytes = 0;
};

// Checks the subtree of `node`, whose keys k must satisfy low <= k < high if given.
Totals CheckNode(const QuadTree::Node* node, int levels, const QuadTree::Key* low,
                 const QuadTree::Key* high) {
  Require(node->count > 0, "an empty node");
  Require(node->is_leaf == (levels == 0), "a leaf at the wrong height");
  Totals totals{0, QuadTree::Edit::BytesOf(node)};
  if (node->is_leaf) {
    const auto* leaf = static_cast<const QuadTree::Leaf*>(node);
    Require(leaf->count <= leaf->capacity, "a leaf beyond its capacity");
    for (int i = 0; i < leaf->count; ++i) {
      Require(i == 0 || leaf->KeyAt(i - 1) < leaf->KeyAt(i), "keys out of order");
      Require(low == nullptr || *low <= leaf->KeyAt(i), "a key below its separator");
      Require(high == nullptr || leaf->KeyAt(i) < *high, "a key above its separator");
    }
    totals.keys = leaf->count;
    return totals;
  }
  const auto* inner = static_cast<const QuadTree::Inner*>(node);
  for (int i = 0; i < inner->count; ++i) {
    const QuadTree::Key* child_low = i == 0 ? low : &inner->keys[i];
    const QuadTree::Key* child_high = i + 1 == inner->count ? high : &inner->keys[i + 1];
    Totals child = CheckNode(inner->children[i], levels - 1, child_low, child_high);
    Require(child.keys == inner->counts[i], "a wrong subtree count");
    totals.keys += child.keys;
    totals.bytes += child.bytes;
  }
  return totals;
}

}  // namespace

void QuadTree::CheckInvariants() const {
  Totals totals;
  if (root_ != nullptr) totals = CheckNode(root_, height_, nullptr, nullptr);
  Require(totals.keys == size_, "a wrong size");
  Require(totals.bytes == bytes_, "a wrong byte count");
}

}  // namespace docent
