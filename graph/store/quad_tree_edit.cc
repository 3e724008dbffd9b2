#include "graph/store/quad_tree_edit.h"

#include <algorithm>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace docent {
namespace {

using Key = QuadTree::Key;

// Guards the reference counts of all nodes except a writer's unpublished ones. A std::mutex: Debian's Abseil,
// built for debugging, takes three to nine times as long, and a version of one fact locks twelve times.
std::mutex references_mutex;

void Free(QuadTree::Node* node) {
  if (!node->is_leaf) return delete static_cast<QuadTree::Inner*>(node);
  static_cast<QuadTree::Leaf*>(node)->~Leaf();
  ::operator delete(node);
}

// After this many freed nodes other threads get the lock, so that freeing a whole graph blocks no writer.
constexpr int kFreedAtOnce = 64;

// Called under the lock, which it may release and take again.
void ReleaseLocked(QuadTree::Node* node, int& freed) {
  if (--node->references != 0) return;
  if (!node->is_leaf) {
    const auto* inner = static_cast<QuadTree::Inner*>(node);
    for (int i = 0; i < inner->count; ++i) __builtin_prefetch(inner->children[i], 1);
    for (int i = 0; i < inner->count; ++i) ReleaseLocked(inner->children[i], freed);
  }
  Free(node);
  if (++freed % kFreedAtOnce != 0) return;
  references_mutex.unlock();
  references_mutex.lock();
}

// Bytes needed for a number.
int WidthOf(uint64_t value) {
  return (std::bit_width(value) + 7) / 8;
}

uint64_t MaskOf(int width) {
  return width == 0 ? 0 : ~uint64_t{0} >> (64 - 8 * width);
}

struct Packing {
  Key base;
  std::array<uint64_t, 4> mask;
  std::array<uint8_t, 4> offset;
  uint8_t stride = 0;
};

// The narrowest columns for these keys. Spare range of a column lies half below, half above the keys, so that
// later keys on either side often fit.
Packing PackingFor(std::span<const Key> keys) {
  Packing packing;
  for (int c = 0; c < 4; ++c) {
    uint64_t low = keys[0][c], high = low;
    for (const Key& key : keys) {
      low = std::min(low, key[c]);
      high = std::max(high, key[c]);
    }
    int width = WidthOf(high - low);
    packing.mask[c] = MaskOf(width);
    uint64_t slack = packing.mask[c] - (high - low);
    // The base is at most the smallest word, and no sum of base and mask exceeds 64 bits.
    packing.base[c] = std::min(low - std::min(low, slack / 2), ~packing.mask[c]);
    packing.offset[c] = packing.stride;
    packing.stride = static_cast<uint8_t>(packing.stride + width);
  }
  return packing;
}

// Capacity for growth by about a fifth, so that a run of inserts seldom copies a leaf and wastes little.
int RoomFor(int keys) {
  return std::min(QuadTree::Leaf::kMaxKeys, keys + keys / 5 + 4);
}

}  // namespace

void QuadTree::Leaf::Write(int i, const Key& key) {
  uint8_t* place = data() + static_cast<size_t>(i) * stride;
  for (int c = 0; c < 4; ++c) {
    uint64_t value = key[c] - base[c];
    std::memcpy(place + offset[c], &value, static_cast<size_t>(std::bit_width(mask[c])) / 8);
  }
}

int QuadTree::Leaf::LowerBound(const Key& key, int from, int to) const {
  // Columns with one value in the whole leaf, most often the first one or two, are compared once.
  int column = 0;
  for (; mask[column] == 0; ++column) {
    if (key[column] != base[column]) return key[column] < base[column] ? from : to;
    if (column == 3) return from;
  }
  if (key[column] < base[column]) return from;
  const uint64_t wanted = key[column] - base[column], bits = mask[column];
  const uint8_t* const words = data() + offset[column];
  const size_t step = stride;
  int low = from, left = to - from;
  while (left > 0) {
    const int half = left / 2, middle = low + half;
    uint64_t word;
    std::memcpy(&word, words + static_cast<size_t>(middle) * step, sizeof(word));
    word &= bits;
    const bool less = word < wanted || (word == wanted && LessAt(middle, key, column + 1));
    low = less ? middle + 1 : low;
    left = less ? left - half - 1 : half;
  }
  return low;
}

int QuadTree::Leaf::LowerBoundNear(const Key& key, int from, int to) const {
  int step = 1;
  while (from + step < to && LessAt(from + step, key)) {
    from += step;
    step *= 2;
  }
  return LowerBound(key, from, std::min(from + step, to));
}

int QuadTree::Leaf::UpperBoundNear(const Key& key, int from) const {
  const int few = std::min<int>(from + 3, count);
  for (; from < few; ++from) {  // most ranges end within a few keys
    if (GreaterAt(from, key)) return from;
  }
  if (from == count || !GreaterAt(count - 1, key)) return count;
  const int at = LowerBoundNear(key, from - 1, count);
  return GreaterAt(at, key) ? at : at + 1;
}

void QuadTree::Edit::Lock() {
  if (!std::exchange(locked_, true)) references_mutex.lock();
}

void QuadTree::Edit::Unlock() {
  if (std::exchange(locked_, false)) references_mutex.unlock();
}

void QuadTree::Edit::Acquire(Node* node) {
  std::lock_guard lock(references_mutex);
  ++node->references;
}

void QuadTree::Edit::Release(Node* node) {
  std::lock_guard lock(references_mutex);
  int freed = 0;
  ReleaseLocked(node, freed);
}

size_t QuadTree::Edit::BytesOf(const Node* node) {
  return node->is_leaf ? static_cast<const Leaf*>(node)->allocated() : sizeof(Inner);
}

uint64_t QuadTree::Edit::SizeOf(const Node* node) {
  return node->is_leaf ? node->count : static_cast<const Inner*>(node)->Total();
}

void QuadTree::Edit::Drop(Node* node) {
  bytes_change_ -= static_cast<int64_t>(BytesOf(node));
  const bool ours = node->epoch == epoch_;
  if (!ours) replaced_bytes_ += BytesOf(node);
  if (ours && (node->is_leaf || node->count == 0)) return Free(node);
  Lock();
  int freed = 0;
  ReleaseLocked(node, freed);
}

QuadTree::Leaf* QuadTree::Edit::Allocate(size_t capacity, size_t stride) {
  size_t bytes = Leaf::AllocationFor(capacity, stride);
  Leaf* leaf = new (::operator new(bytes)) Leaf();
  leaf->is_leaf = true;
  leaf->epoch = epoch_;
  leaf->stride = static_cast<uint8_t>(stride);
  leaf->capacity = static_cast<uint16_t>(capacity);
  bytes_change_ += static_cast<int64_t>(bytes);
  return leaf;
}

QuadTree::Leaf* QuadTree::Edit::NewLeaf(std::span<const Key> keys, int spare) {
  Packing packing = PackingFor(keys);
  int capacity = std::min(static_cast<int>(keys.size()) + spare, Leaf::kMaxKeys);
  Leaf* leaf = Allocate(static_cast<size_t>(capacity), packing.stride);
  leaf->base = packing.base;
  leaf->mask = packing.mask;
  leaf->offset = packing.offset;
  leaf->count = static_cast<uint16_t>(keys.size());
  for (size_t i = 0; i < keys.size(); ++i) leaf->Write(static_cast<int>(i), keys[i]);
  return leaf;
}

QuadTree::Leaf* QuadTree::Edit::CopyLeaf(const Leaf* leaf, int capacity) {
  Leaf* copy = Allocate(static_cast<size_t>(capacity), leaf->stride);
  copy->base = leaf->base;
  copy->mask = leaf->mask;
  copy->offset = leaf->offset;
  copy->count = leaf->count;
  std::memcpy(copy->data(), leaf->data(), static_cast<size_t>(leaf->count) * leaf->stride);
  return copy;
}

QuadTree::Inner* QuadTree::Edit::NewInner() {
  Inner* inner = new Inner;
  inner->epoch = epoch_;
  bytes_change_ += sizeof(Inner);
  return inner;
}

QuadTree::Leaf* QuadTree::Edit::InsertIntoLeaf(Leaf* leaf, int position, const Key& key, Right* right) {
  bool ours = leaf->epoch == epoch_;
  if (leaf->count < Leaf::kMaxKeys && leaf->Holds(key)) {
    if (!ours || leaf->count == leaf->capacity) {
      Leaf* copy =
          CopyLeaf(leaf, ours ? RoomFor(leaf->count + 1) : std::min(leaf->count + 4, Leaf::kMaxKeys));
      Drop(leaf);
      leaf = copy;
    }
    uint8_t* place = leaf->data() + static_cast<size_t>(position) * leaf->stride;
    std::memmove(place + leaf->stride, place, static_cast<size_t>(leaf->count - position) * leaf->stride);
    leaf->Write(position, key);
    ++leaf->count;
    return leaf;
  }
  std::array<Key, Leaf::kMaxKeys + 1> keys;
  int count = leaf->count + 1;
  for (int i = 0; i < leaf->count; ++i) keys[i + (i >= position ? 1 : 0)] = leaf->KeyAt(i);
  keys[position] = key;
  Drop(leaf);
  std::span<const Key> all(keys.data(), static_cast<size_t>(count));
  if (count <= Leaf::kMaxKeys) return NewLeaf(all, RoomFor(count) - count);
  // Keys that come in rising order leave full leaves behind.
  size_t left = position == count - 1 ? all.size() - 1 : all.size() / 2;
  right->first = all[left];
  right->size = all.size() - left;
  right->node =
      NewLeaf(all.subspan(left), RoomFor(static_cast<int>(right->size)) - static_cast<int>(right->size));
  return NewLeaf(all.first(left), 0);
}

QuadTree::Leaf* QuadTree::Edit::EraseFromLeaf(Leaf* leaf, int position) {
  if (leaf->count == 1) {
    Drop(leaf);
    return nullptr;
  }
  if (leaf->epoch != epoch_) {
    Leaf* copy = CopyLeaf(leaf, leaf->count);
    Drop(leaf);
    leaf = copy;
  }
  uint8_t* place = leaf->data() + static_cast<size_t>(position) * leaf->stride;
  std::memmove(place, place + leaf->stride, static_cast<size_t>(leaf->count - position - 1) * leaf->stride);
  --leaf->count;
  return leaf;
}

QuadTree::Inner* QuadTree::Edit::Writable(Inner* inner) {
  if (inner->epoch == epoch_) return inner;
  Inner* copy = NewInner();
  copy->count = inner->count;
  for (int i = 0; i < inner->count; ++i) __builtin_prefetch(inner->children[i], 1);
  std::copy_n(inner->keys.begin(), inner->count, copy->keys.begin());
  std::copy_n(inner->counts.begin(), inner->count, copy->counts.begin());
  std::copy_n(inner->children.begin(), inner->count, copy->children.begin());
  Lock();
  for (int i = 0; i < inner->count; ++i) ++inner->children[i]->references;
  Drop(inner);
  return copy;
}

void QuadTree::Edit::InsertChild(Inner* inner, int index, const Right& child, Right* right) {
  int at = index + 1;
  Inner* target = inner;
  if (inner->count == Inner::kMaxChildren) {
    int left = at == inner->count ? inner->count : inner->count / 2;
    Inner* split = NewInner();
    split->count = static_cast<uint16_t>(inner->count - left);
    std::copy_n(inner->keys.begin() + left, split->count, split->keys.begin());
    std::copy_n(inner->counts.begin() + left, split->count, split->counts.begin());
    std::copy_n(inner->children.begin() + left, split->count, split->children.begin());
    inner->count = static_cast<uint16_t>(left);
    right->node = split;
    right->first = split->count > 0 ? split->keys[0] : child.first;
    if (at > left || split->count == 0) {
      target = split;
      at -= left;
    }
  }
  std::copy_backward(target->keys.begin() + at, target->keys.begin() + target->count,
                     target->keys.begin() + target->count + 1);
  std::copy_backward(target->counts.begin() + at, target->counts.begin() + target->count,
                     target->counts.begin() + target->count + 1);
  std::copy_backward(target->children.begin() + at, target->children.begin() + target->count,
                     target->children.begin() + target->count + 1);
  target->keys[at] = child.first;
  target->counts[at] = child.size;
  target->children[at] = child.node;
  ++target->count;
  if (right->node != nullptr) right->size = SizeOf(right->node);
}

void QuadTree::Edit::RemoveChild(Inner* inner, int index) {
  std::copy(inner->keys.begin() + index + 1, inner->keys.begin() + inner->count, inner->keys.begin() + index);
  std::copy(inner->counts.begin() + index + 1, inner->counts.begin() + inner->count,
            inner->counts.begin() + index);
  std::copy(inner->children.begin() + index + 1, inner->children.begin() + inner->count,
            inner->children.begin() + index);
  --inner->count;
}

QuadTree::Node* QuadTree::Edit::DropEmpty(Inner* inner) {
  Drop(inner);
  return nullptr;
}

QuadTree::Node* QuadTree::Edit::TakeOnlyChild(Inner* inner) {
  Node* child = inner->children[0];
  if (inner->epoch == epoch_) {
    inner->count = 0;
  } else {
    Lock();
    ++child->references;  // an older version also keeps it
  }
  Drop(inner);
  return child;
}

void QuadTree::Edit::Append(Inner* to, const Inner* from, const Key& first) {
  std::copy_n(from->keys.begin(), from->count, to->keys.begin() + to->count);
  std::copy_n(from->counts.begin(), from->count, to->counts.begin() + to->count);
  std::copy_n(from->children.begin(), from->count, to->children.begin() + to->count);
  to->keys[to->count] = first;
  Lock();
  for (int i = 0; i < from->count; ++i) ++from->children[i]->references;
  to->count = static_cast<uint16_t>(to->count + from->count);
}

void QuadTree::Edit::MergeChild(Inner* inner, int index) {
  Node* child = inner->children[index];
  int minimum = child->is_leaf ? Leaf::kMinKeys : Inner::kMinChildren;
  int maximum = child->is_leaf ? Leaf::kMaxKeys : Inner::kMaxChildren;
  if (child->count >= minimum || inner->count < 2) return;
  int left = index > 0 ? index - 1 : index;
  Node* a = inner->children[left];
  Node* b = inner->children[left + 1];
  if (a->count + b->count > maximum * 3 / 4) return;
  Node* merged;
  if (child->is_leaf) {
    std::array<Key, Leaf::kMaxKeys> keys;
    for (int i = 0; i < a->count; ++i) keys[i] = static_cast<Leaf*>(a)->KeyAt(i);
    for (int i = 0; i < b->count; ++i) keys[a->count + i] = static_cast<Leaf*>(b)->KeyAt(i);
    int count = a->count + b->count;
    merged = NewLeaf(std::span<const Key>(keys.data(), static_cast<size_t>(count)), 0);
  } else {
    Inner* both = NewInner();
    Append(both, static_cast<Inner*>(a), inner->keys[left]);
    Append(both, static_cast<Inner*>(b), inner->keys[left + 1]);
    merged = both;
  }
  uint64_t size = inner->counts[left] + inner->counts[left + 1];
  Drop(a);
  Drop(b);
  inner->children[left] = merged;
  inner->counts[left] = size;
  RemoveChild(inner, left + 1);
}

}  // namespace docent
