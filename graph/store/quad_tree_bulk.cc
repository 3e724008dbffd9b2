// Insertion of many sorted keys into a tree at once.
#include <algorithm>
#include <cstdlib>
#include <utility>

#include "graph/store/quad_tree_edit.h"

namespace docent {
namespace {

// Nodes an eighth empty, so that the first insert into each does not split it.
constexpr size_t kLeafFill = QuadTree::Leaf::kMaxKeys * 7 / 8;
constexpr size_t kInnerFill = QuadTree::Inner::kMaxChildren * 7 / 8;

// Up to this many keys are put into a leaf one by one, without repacking it.
constexpr size_t kFew = 4;

// Divides `all` into parts of at most `fill`, of equal size or one apart, and calls `visit` for each.
template <typename T, typename Visit>
void ForEachPart(std::span<const T> all, size_t fill, Visit visit) {
  const size_t parts = (all.size() + fill - 1) / fill;
  for (size_t i = 0; i < parts; ++i) {
    const size_t from = all.size() * i / parts;
    visit(all.subspan(from, all.size() * (i + 1) / parts - from));
  }
}

// The keys of a leaf and `keys`, without repeats.
std::vector<QuadTree::Key> Merged(const QuadTree::Leaf& leaf, std::span<const QuadTree::Key> keys) {
  std::vector<QuadTree::Key> all;
  all.reserve(leaf.count + keys.size());
  auto next = keys.begin();
  for (int i = 0; i < leaf.count; ++i) {
    const QuadTree::Key key = leaf.KeyAt(i);
    while (next != keys.end() && *next < key) all.push_back(*next++);
    if (next != keys.end() && *next == key) ++next;
    all.push_back(key);
  }
  all.insert(all.end(), next, keys.end());
  return all;
}

}  // namespace

void QuadTree::Edit::InsertSorted(QuadTree* tree, std::span<const Key> keys, uint64_t epoch) {
  if (keys.empty()) return;
  tree->last_edit_ = {};
  Edit edit(epoch);
  std::vector<Right> level;
  if (tree->root_ == nullptr) {
    edit.MakeLeaves(keys, &level);
  } else {
    edit.InsertRun(tree->root_, tree->height_, keys[0], keys, &level);
  }
  for (; level.size() > 1; ++tree->height_) {
    std::vector<Right> above;
    edit.MakeInners(level, &above);
    level = std::move(above);
  }
  if (tree->height_ >= kMaxHeight) std::abort();  // 16^15 leaves do not fit into memory
  tree->root_ = level[0].node;
  tree->size_ = level[0].size;
  tree->bytes_ = static_cast<size_t>(static_cast<int64_t>(tree->bytes_) + edit.bytes_change());
  tree->replaced_bytes_ += edit.replaced_bytes();
}

void QuadTree::Edit::MakeLeaves(std::span<const Key> keys, std::vector<Right>* out) {
  ForEachPart(keys, kLeafFill, [&](std::span<const Key> run) {
    out->push_back({NewLeaf(run, 0), run[0], run.size()});
  });
}

QuadTree::Edit::Right QuadTree::Edit::Fill(Inner* inner, std::span<const Right> children) {
  inner->count = static_cast<uint16_t>(children.size());
  uint64_t size = 0;
  for (size_t i = 0; i < children.size(); ++i) {
    inner->keys[i] = children[i].first;
    inner->counts[i] = children[i].size;
    inner->children[i] = children[i].node;
    size += children[i].size;
  }
  return {inner, children[0].first, size};
}

void QuadTree::Edit::MakeInners(std::span<const Right> children, std::vector<Right>* out) {
  ForEachPart(children, kInnerFill,
              [&](std::span<const Right> some) { out->push_back(Fill(NewInner(), some)); });
}

void QuadTree::Edit::InsertRunIntoLeaf(Leaf* leaf, const Key& first, std::span<const Key> keys,
                                       std::vector<Right>* out) {
  Unlock();  // of the nodes above or the leaf before: a long run must not block other threads
  size_t next = 0;
  for (; keys.size() <= kFew && next < keys.size() && leaf->count < Leaf::kMaxKeys; ++next) {
    const int position = leaf->LowerBound(keys[next], 0, leaf->count);
    Right none;  // a leaf that is not full is not split
    if (position == leaf->count || leaf->KeyAt(position) != keys[next]) {
      leaf = InsertIntoLeaf(leaf, position, keys[next], &none);
    }
  }
  const Key low = std::min(first, leaf->KeyAt(0));
  std::vector<Key> all;
  if (next < keys.size()) all = Merged(*leaf, keys.subspan(next));
  if (all.size() <= leaf->count) {  // the leaf already has all of them
    out->push_back({leaf, low, leaf->count});
    return;
  }
  Drop(leaf);
  Unlock();
  const size_t before = out->size();
  if (all.size() <= Leaf::kMaxKeys) {
    out->push_back({NewLeaf(all, 0), all[0], all.size()});
  } else {
    MakeLeaves(all, out);
  }
  (*out)[before].first = std::min(low, all[0]);
}

void QuadTree::Edit::InsertRun(Node* node, int levels, const Key& first, std::span<const Key> keys,
                               std::vector<Right>* out) {
  if (levels == 0) return InsertRunIntoLeaf(static_cast<Leaf*>(node), first, keys, out);
  Inner* inner = Writable(static_cast<Inner*>(node));
  std::vector<Right> children;
  for (int i = 0; i < inner->count; ++i) {
    const Key& low = i == 0 ? first : inner->keys[i];
    const auto end =
        i + 1 == inner->count ? keys.end() : std::lower_bound(keys.begin(), keys.end(), inner->keys[i + 1]);
    const std::span<const Key> here(keys.begin(), end);
    keys = std::span<const Key>(end, keys.end());
    if (here.empty()) {
      children.push_back({inner->children[i], low, inner->counts[i]});
    } else {
      InsertRun(inner->children[i], levels - 1, low, here, &children);
    }
  }
  if (children.size() <= Inner::kMaxChildren) {
    out->push_back(Fill(inner, children));
    return;
  }
  inner->count = 0;  // its children were moved
  Drop(inner);
  MakeInners(children, out);
}

}  // namespace docent
