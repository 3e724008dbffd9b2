#include "graph/store/quad_tree.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <utility>

#include "graph/store/quad_tree_edit.h"
#include "graph/store/quad_tree_node.h"

namespace docent {

struct QuadTree::Path {
  struct Step {
    Inner* node;
    int index;
  };
  std::array<Step, kMaxHeight> steps;
  Leaf* leaf = nullptr;
  int position = 0;
  bool found = false;
};

uint64_t QuadTree::NewEpoch() {
  static std::atomic<uint64_t> next{1};
  return next.fetch_add(1, std::memory_order_relaxed);
}

QuadTree::QuadTree(const QuadTree& other)
    : root_(other.root_),
      size_(other.size_),
      bytes_(other.bytes_),
      replaced_bytes_(other.replaced_bytes_),
      height_(other.height_) {
  if (root_ != nullptr) Edit::Acquire(root_);
}

QuadTree::QuadTree(QuadTree&& other) noexcept
    : root_(std::exchange(other.root_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      bytes_(std::exchange(other.bytes_, 0)),
      replaced_bytes_(std::exchange(other.replaced_bytes_, 0)),
      height_(std::exchange(other.height_, 0)),
      last_edit_(std::exchange(other.last_edit_, {})) {}

QuadTree& QuadTree::operator=(const QuadTree& other) {
  QuadTree copy(other);
  return *this = std::move(copy);
}

QuadTree& QuadTree::operator=(QuadTree&& other) noexcept {
  std::swap(root_, other.root_);
  std::swap(size_, other.size_);
  std::swap(bytes_, other.bytes_);
  std::swap(replaced_bytes_, other.replaced_bytes_);
  std::swap(height_, other.height_);
  std::swap(last_edit_, other.last_edit_);
  return *this;
}

QuadTree::~QuadTree() {
  if (root_ != nullptr) Edit::Release(root_);
}

QuadTree QuadTree::Build(const std::vector<Key>& keys, uint64_t epoch) {
  QuadTree tree;
  Edit::InsertSorted(&tree, keys, epoch);
  return tree;
}

QuadTree::Path QuadTree::Descend(const Key& key) const {
  Path path;
  Node* node = root_;
  for (int level = 0; level < height_; ++level) {
    Inner* inner = static_cast<Inner*>(node);
    int index = inner->ChildFor(key);
    path.steps[level] = {inner, index};
    node = inner->children[index];
  }
  path.leaf = static_cast<Leaf*>(node);
  path.position = path.leaf->LowerBound(key, 0, path.leaf->count);
  path.found = path.position < path.leaf->count && path.leaf->KeyAt(path.position) == key;
  return path;
}

void QuadTree::MakeWritable(Edit& edit, Path* path) {
  Node** slot = &root_;
  for (int level = 0; level < height_; ++level) {
    auto& [node, index] = path->steps[level];
    node = edit.Writable(node);
    *slot = node;
    slot = &node->children[index];
  }
}

bool QuadTree::Insert(const Key& key, uint64_t epoch) {
  Edit edit(epoch);
  if (root_ == nullptr) {
    root_ = edit.NewLeaf(std::span<const Key>(&key, 1), 3);
    size_ = 1;
    bytes_ = static_cast<size_t>(edit.bytes_change());
    return true;
  }
  Path path = Descend(key);
  if (path.found) return false;
  MakeWritable(edit, &path);
  Edit::Right right;
  Leaf* const leaf = edit.InsertIntoLeaf(path.leaf, path.position, key, &right);
  last_edit_ = right.node == nullptr ? LastEdit{leaf, path.position} : LastEdit{};
  Node* changed = leaf;
  for (int level = height_ - 1; level >= 0; --level) {
    auto [inner, index] = path.steps[level];
    inner->children[index] = changed;
    inner->counts[index] += 1;
    changed = inner;
    if (right.node == nullptr) continue;
    inner->counts[index] -= right.size;
    Edit::Right above;
    edit.InsertChild(inner, index, right, &above);
    right = above;
  }
  root_ = changed;
  if (right.node != nullptr) {
    if (height_ + 1 == kMaxHeight) std::abort();  // 16^15 leaves do not fit into memory
    Inner* top = edit.NewInner();
    top->count = 1;
    top->keys[0] = right.first;  // not read
    top->counts[0] = Edit::SizeOf(changed);
    top->children[0] = changed;
    Edit::Right none;
    edit.InsertChild(top, 0, right, &none);
    root_ = top;
    ++height_;
  }
  ++size_;
  bytes_ = static_cast<size_t>(static_cast<int64_t>(bytes_) + edit.bytes_change());
  replaced_bytes_ += edit.replaced_bytes();
  return true;
}

bool QuadTree::Erase(const Key& key, uint64_t epoch) {
  if (root_ == nullptr) return false;
  Path path = Descend(key);
  if (!path.found) return false;
  Edit edit(epoch);
  MakeWritable(edit, &path);
  Leaf* const leaf = edit.EraseFromLeaf(path.leaf, path.position);
  const bool stays =
      leaf != nullptr && (height_ == 0 || leaf->count >= Leaf::kMinKeys);  // certainly not merged
  last_edit_ = stays ? LastEdit{leaf, path.position} : LastEdit{};
  Node* changed = leaf;
  for (int level = height_ - 1; level >= 0; --level) {
    auto [inner, index] = path.steps[level];
    inner->children[index] = changed;
    inner->counts[index] -= 1;
    changed = inner;
    if (inner->children[index] == nullptr) {
      edit.RemoveChild(inner, index);
      if (inner->count == 0) changed = edit.DropEmpty(inner);
    } else {
      edit.MergeChild(inner, index);
    }
  }
  root_ = changed;
  while (height_ > 0 && root_ != nullptr && root_->count == 1) {
    root_ = edit.TakeOnlyChild(static_cast<Inner*>(root_));
    --height_;
  }
  if (root_ == nullptr) height_ = 0;
  --size_;
  bytes_ = static_cast<size_t>(static_cast<int64_t>(bytes_) + edit.bytes_change());
  replaced_bytes_ += edit.replaced_bytes();
  return true;
}

bool QuadTree::Contains(const Key& key) const {
  return root_ != nullptr && Descend(key).found;
}

std::optional<bool> QuadTree::ContainsPrefixThere(const Key& first, int words) const {
  const auto& [leaf, position] = last_edit_;
  if (leaf == nullptr) return std::nullopt;
  bool between = true;  // a key with this prefix would lie between the two
  for (int i = position - 1; i <= position; ++i) {
    if (i < 0 || i >= leaf->count) {
      between = false;
      continue;
    }
    int word = 0;
    while (word < words && leaf->Word(i, word) == first[static_cast<size_t>(word)]) ++word;
    if (word == words) return true;
    const bool below = leaf->Word(i, word) < first[static_cast<size_t>(word)];
    between = between && below == (i < position);
  }
  return between ? std::optional<bool>(false) : std::nullopt;
}

bool QuadTree::ContainsPrefix(const Key& first, int words) const {
  if (root_ == nullptr) return false;
  if (const std::optional<bool> known = ContainsPrefixThere(first, words)) return *known;
  const Node* node = root_;
  const Key* next = nullptr;  // begin of the nodes that follow those on the way down
  for (int level = 0; level < height_; ++level) {
    const Inner* inner = static_cast<const Inner*>(node);
    const int index = inner->ChildFor(first);
    if (index + 1 < inner->count) next = &inner->keys[static_cast<size_t>(index) + 1];
    node = inner->children[static_cast<size_t>(index)];
  }
  const Leaf* leaf = static_cast<const Leaf*>(node);
  const int position = leaf->LowerBound(first, 0, leaf->count);
  if (position < leaf->count) {
    int word = 0;
    while (word < words && leaf->Word(position, word) == first[static_cast<size_t>(word)]) ++word;
    return word == words;
  }
  if (next == nullptr) return false;
  for (int word = 0; word < words; ++word) {
    if ((*next)[static_cast<size_t>(word)] != first[static_cast<size_t>(word)]) return false;
  }
  Key last = first;
  std::fill(last.begin() + words, last.end(), ~uint64_t{0});
  return Range(first, last).Valid();
}

QuadTree::Key QuadTree::KeyAt(uint64_t rank) const {
  const Node* node = root_;
  for (int level = 0; level < height_; ++level) {
    const Inner* inner = static_cast<const Inner*>(node);
    int index = 0;
    for (; rank >= inner->counts[index]; ++index) rank -= inner->counts[index];
    node = inner->children[index];
  }
  return static_cast<const Leaf*>(node)->KeyAt(static_cast<int>(rank));
}

uint64_t QuadTree::CountBelow(const Node* node, int level, const Key& key, bool inclusive) const {
  if (node == nullptr) return 0;
  uint64_t below = 0;
  for (; level < height_; ++level) {
    const Inner* inner = static_cast<const Inner*>(node);
    int index = inner->ChildFor(key);
    for (int i = 0; i < index; ++i) below += inner->counts[i];
    node = inner->children[index];
  }
  const Leaf* leaf = static_cast<const Leaf*>(node);
  int position = leaf->LowerBound(key, 0, leaf->count);
  bool equal = position < leaf->count && leaf->KeyAt(position) == key;
  return below + static_cast<uint64_t>(position) + (inclusive && equal ? 1 : 0);
}

// One common descent as long as both ends lie beneath the same child.
uint64_t QuadTree::CountRange(const Key& first, const Key& last) const {
  if (root_ == nullptr || last < first) return 0;
  const Node* node = root_;
  for (int level = 0; level < height_; ++level) {
    const Inner* inner = static_cast<const Inner*>(node);
    const int from = inner->ChildFor(first);
    const bool same = from + 1 == inner->count || Inner::IsGreater(inner->keys[from + 1], last);
    if (!same) {
      const int to = inner->ChildFor(last);
      uint64_t count = 0;
      for (int i = from; i < to; ++i) count += inner->counts[i];
      return count - CountBelow(inner->children[from], level + 1, first, false) +
             CountBelow(inner->children[to], level + 1, last, true);
    }
    node = inner->children[from];
  }
  const Leaf* leaf = static_cast<const Leaf*>(node);
  const int begin = leaf->LowerBound(first, 0, leaf->count);
  return static_cast<uint64_t>(leaf->UpperBoundNear(last, begin) - begin);
}

}  // namespace docent
