#include "graph/store/quad_cursor.h"

namespace docent {
namespace {

// For orders with the graph as the last word of a key.
bool IsOfTriple(const QuadTree::Leaf& leaf, int i, const QuadTree::Key& key) {
  return leaf.Word(i, 0) == key[0] && leaf.Word(i, 1) == key[1] && leaf.Word(i, 2) == key[2];
}

}  // namespace

void QuadCursor::Settle() {
  const auto skips = [this](const Quad& quad) {
    return (filter_ && !pattern_.Matches(quad)) || (hidden_ != nullptr && hidden_->Hides(quad));
  };
  while (iterator_.Valid() && skips(quad())) iterator_.Next();
}

void QuadCursor::SkipCopies() {
  const QuadTree::Key key = iterator_.key();
  do {
    iterator_.Next();
  } while (iterator_.Valid() && IsOfTriple(*iterator_.leaf(), iterator_.position(), key));
}

void QuadCursor::Seek(const Quad& target) {
  iterator_.Seek(KeyOf(target, order_));
  if (filters()) Settle();
}

uint64_t QuadCursor::CountRest(bool triples) {
  uint64_t count = 0;
  triples &= order_ != IndexOrder::kGspo;  // within one graph there are no copies
  QuadTree::Key last = {};                 // differs from every quad
  for (; iterator_.Valid(); iterator_.SkipLeaf()) {
    const QuadTree::Leaf& leaf = *iterator_.leaf();
    const int first = iterator_.position(), limit = iterator_.limit();
    count += static_cast<uint64_t>(limit - first);
    if (!triples) continue;
    // The graph is the last word, and a leaf within one graph has every triple once.
    const int end = leaf.mask[3] == 0 ? first + 1 : limit;
    for (int i = first; i < end; ++i) {
      if (i > first) last = leaf.KeyAt(i - 1);
      if (IsOfTriple(leaf, i, last)) --count;
    }
    last = leaf.KeyAt(limit - 1);
  }
  return count;
}

}  // namespace docent
