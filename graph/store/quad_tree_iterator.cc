#include "graph/store/quad_tree_node.h"

namespace docent {
namespace {

// Prefetches the header of the next leaf, and its first keys.
void PrefetchLeaf(const QuadTree::Node* leaf) {
  constexpr int kLine = 64, kLines = 4;
  for (int i = 0; i < kLines; ++i) __builtin_prefetch(reinterpret_cast<const char*>(leaf) + i * kLine);
}

}  // namespace

QuadTree::Iterator QuadTree::Range(const Key& first, const Key& last) const {
  Iterator iterator;
  Range(first, last, &iterator);
  return iterator;
}

void QuadTree::Range(const Key& first, const Key& last, Iterator* iterator) const {
  iterator->descents_ = 0;
  iterator->height_ = height_;
  iterator->last_ = last;
  if (root_ != nullptr && !(last < first)) {
    iterator->DescendFrom(0, root_, first);
    return;
  }
  iterator->leaf_ = nullptr;
  iterator->position_ = iterator->limit_ = 0;
  iterator->last_leaf_ = true;
}

QuadTree::Key QuadTree::Iterator::key() const {
  return leaf_->KeyAt(position_);
}

// Descends from `node` at `level` to the leaf where `target` belongs.
void QuadTree::Iterator::DescendFrom(int level, const Node* node, const Key& target) {
  for (; level < height_; ++level) {
    const Inner* inner = static_cast<const Inner*>(node);
    int index = inner->ChildFor(target);
    path_[level] = {inner, index};
    node = inner->children[index];
  }
  EnterLeaf(static_cast<const Leaf*>(node), target);
}

// True if `target` certainly belongs beneath path_[level], by its parent's separators; the first and the last
// child have only one of them. Requires level > 0.
bool QuadTree::Iterator::IsBeneath(int level, const Key& target) const {
  const auto& [parent, index] = path_[level - 1];
  return index > 0 && index + 1 < parent->count && !Inner::IsGreater(parent->keys[index], target) &&
         Inner::IsGreater(parent->keys[index + 1], target);
}

void QuadTree::Iterator::EnterLeaf(const Leaf* leaf, const Key& from) {
  leaf_ = leaf;
  position_ = leaf->LowerBound(from, 0, leaf->count);
  SetLimit();
  if (position_ >= limit_ && !last_leaf_) NextLeaf();
}

void QuadTree::Iterator::Restart(const Key& first, const Key& last) {
  if (leaf_ == nullptr) return;  // the tree is empty
  last_ = last;
  if (last < first) {
    position_ = limit_;
    last_leaf_ = true;
    return;
  }
  const bool here = height_ == 0 || (!leaf_->GreaterAt(0, first) && !leaf_->LessAt(leaf_->count - 1, first));
  if (!here) {
    ++descents_;
    int level = height_ - 1;
    while (level > 0 && !IsBeneath(level, first)) --level;
    DescendFrom(level, path_[level].node, first);
    return;
  }
  // Lookups with slowly rising keys find their place near the last one.
  constexpr int kClose = 8;
  int from = 0, to = leaf_->count;
  if (position_ < to && !leaf_->LessAt(position_, first)) {
    to = position_;
  } else if (position_ < to) {
    from = position_ + 1;
    if (from + kClose < to && !leaf_->LessAt(from + kClose, first)) to = from + kClose;
  }
  position_ = leaf_->LowerBound(first, from, to);
  SetLimit();
  if (position_ >= limit_ && !last_leaf_) NextLeaf();
}

void QuadTree::Iterator::SetLimit() {
  limit_ = leaf_->UpperBoundNear(last_, position_);
  last_leaf_ = limit_ < leaf_->count;
}

void QuadTree::Iterator::NextLeaf() {
  int level = height_ - 1;
  while (level >= 0 && path_[level].index + 1 == path_[level].node->count) --level;
  if (level < 0) {
    last_leaf_ = true;
    return;
  }
  const Node* node = path_[level].node->children[++path_[level].index];
  while (++level < height_) {
    path_[level] = {static_cast<const Inner*>(node), 0};
    node = path_[level].node->children[0];
  }
  leaf_ = static_cast<const Leaf*>(node);
  position_ = 0;
  SetLimit();
  if (last_leaf_) return;
  const Step& parent = path_[height_ - 1];
  if (parent.index + 1 < parent.node->count) PrefetchLeaf(parent.node->children[parent.index + 1]);
}

void QuadTree::Iterator::Seek(const Key& target) {
  if (!Valid() || !leaf_->LessAt(position_, target)) return;
  if (last_ < target) {
    position_ = limit_;
    last_leaf_ = true;
    return;
  }
  if (last_leaf_ || !leaf_->LessAt(limit_ - 1, target)) {
    position_ = leaf_->LowerBoundNear(target, position_ + 1, limit_);  // near more often than far
    return;
  }
  // Up to the lowest node that can contain the target, and down again.
  int level = height_ - 1;
  while (level > 0) {
    const Step& step = path_[level];
    if (step.index + 1 < step.node->count && target < step.node->keys[step.node->count - 1]) break;
    --level;
  }
  if (level < 0) {
    position_ = limit_;
    last_leaf_ = true;
    return;
  }
  DescendFrom(level, path_[level].node, target);
}

}  // namespace docent
