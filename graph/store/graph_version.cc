#include "graph/store/graph_version.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "graph/store/index_order.h"
#include "graph/store/read_trace.h"

namespace docent {
namespace {

// The order whose prefix contains the bound positions among S, P and O.
IndexOrder OrderWithoutGraph(unsigned bound) {
  constexpr unsigned kSubject = 1, kPredicate = 2, kObject = 4;
  if ((bound & kPredicate) != 0) return (bound & kSubject) != 0 ? IndexOrder::kSpog : IndexOrder::kPosg;
  return (bound & kObject) != 0 ? IndexOrder::kOspg : IndexOrder::kSpog;
}

// True for a pattern of one quad.
bool IsWhole(const QuadPattern& pattern) {
  return !pattern.subject.IsNone() && !pattern.predicate.IsNone() && !pattern.object.IsNone() &&
         !pattern.graph.IsNone();
}

}  // namespace

std::shared_ptr<const GraphVersion> GraphVersion::Without(const HiddenTriples& hidden) const {
  std::shared_ptr<GraphVersion> without(new GraphVersion(*this));
  without->hidden_ = &hidden;
  return without;
}

bool GraphVersion::Contains(const Quad& quad) const {
  ReadTrace::Note({quad.subject, quad.predicate, quad.object, quad.graph});
  return tree(IndexOrder::kSpog).Contains(KeyOf(quad, IndexOrder::kSpog));
}

bool GraphVersion::ContainsMatch(const QuadPattern& pattern) const {
  const unsigned bound = BoundIn(pattern);
  const bool shown = hidden_ == nullptr || !hidden_->MayHide(pattern);
  if (pattern.graph.IsNone() && shown) {  // then some order has all bound positions first
    ReadTrace::Note(pattern);
    const IndexOrder order = OrderWithoutGraph(bound);
    const QuadTree::Key key =
        KeyOf(Quad{pattern.subject, pattern.predicate, pattern.object, TermId()}, order);
    return tree(order).ContainsPrefix(key, kWholePrefixes[bound]);
  }
  return ScanInOrder(pattern, OrderFor(pattern, bound)).Valid();
}

IndexOrder GraphVersion::OrderFor(const QuadPattern& pattern, unsigned bound) const {
  const IndexOrder order = OrderWithoutGraph(bound);
  if (pattern.graph.IsNone()) return order;
  if (IsExact(bound, IndexOrder::kGspo)) return IndexOrder::kGspo;
  if (IsExact(bound, order)) return order;
  // Neither order covers all bound positions: walk the shorter run.
  const KeyRange without = RangeOf(pattern, bound, order),
                 within = RangeOf(pattern, bound, IndexOrder::kGspo);
  bool graph_first = tree(IndexOrder::kGspo).CountRange(within.first, within.last) <
                     tree(order).CountRange(without.first, without.last);
  return graph_first ? IndexOrder::kGspo : order;
}

QuadCursor GraphVersion::Scan(const QuadPattern& pattern) const {
  QuadCursor cursor;
  Rescan(pattern, &cursor);
  return cursor;
}

QuadCursor GraphVersion::ScanInOrder(const QuadPattern& pattern, IndexOrder order) const {
  QuadCursor cursor;
  Open(pattern, BoundIn(pattern), order, &cursor);
  return cursor;
}

void GraphVersion::Rescan(const QuadPattern& pattern, QuadCursor* cursor) const {
  const unsigned bound = BoundIn(pattern);
  Open(pattern, bound, OrderFor(pattern, bound), cursor);
}

void GraphVersion::Rescan(const QuadPattern& pattern, const AccessPath& path, QuadCursor* cursor) const {
  ReadTrace::Note(pattern);
  Place(pattern, RangeOf(pattern, path), path.order, cursor);
}

std::optional<AccessPath> GraphVersion::PathFor(unsigned bound) {
  for (const IndexOrder order : {OrderWithoutGraph(bound), IndexOrder::kGspo}) {
    if (IsExact(bound, order)) return AccessPath{order, std::popcount(bound)};
  }
  return std::nullopt;
}

void GraphVersion::Open(const QuadPattern& pattern, unsigned bound, IndexOrder order,
                        QuadCursor* cursor) const {
  ReadTrace::Note(pattern);
  const KeyRange range = RangeOf(pattern, bound, order);
  Place(pattern, range, order, cursor);
}

void GraphVersion::Place(const QuadPattern& pattern, const KeyRange& range, IndexOrder order,
                         QuadCursor* cursor) const {
  const QuadTree& over = tree(order);
  if (cursor->tree_ == &over) {
    cursor->iterator_.Restart(range.first, range.last);
  } else {
    cursor->tree_ = &over;
    cursor->order_ = order;
    over.Range(range.first, range.last, &cursor->iterator_);
  }
  cursor->filter_ = !range.exact;
  cursor->hidden_ = hidden_ != nullptr && !IsWhole(pattern) && hidden_->MayHide(pattern) ? hidden_ : nullptr;
  if (!cursor->filters()) return;
  cursor->pattern_ = pattern;
  cursor->Settle();
}

// Of an estimate, both parts count.
uint64_t GraphVersion::Count(const QuadPattern& pattern) const {
  ReadTrace::Note(pattern);
  const unsigned bound = BoundIn(pattern);
  const IndexOrder order = OrderWithoutGraph(bound);
  KeyRange without = RangeOf(pattern, bound, order);
  if (without.exact && pattern.graph.IsNone()) {
    if (pattern.subject.IsNone() && pattern.predicate.IsNone() && pattern.object.IsNone()) return size();
    return tree(order).CountRange(without.first, without.last);
  }
  KeyRange within = RangeOf(pattern, bound, IndexOrder::kGspo);
  uint64_t in_graph = tree(IndexOrder::kGspo).CountRange(within.first, within.last);
  if (within.exact) return in_graph;
  ReadTrace::Note({pattern.subject, pattern.predicate, pattern.object, TermId()});
  ReadTrace::Note({TermId(), TermId(), TermId(), pattern.graph});
  return std::min(in_graph, tree(order).CountRange(without.first, without.last));
}

std::vector<Quad> GraphVersion::Sample(const QuadPattern& pattern, size_t n) const {
  ReadTrace::Note(pattern);
  const unsigned bound = BoundIn(pattern);
  const IndexOrder order = OrderFor(pattern, bound);
  const KeyRange range = RangeOf(pattern, bound, order);
  std::vector<Quad> sample;
  if (!range.exact || size() == 0) return sample;
  const QuadTree& over = tree(order);
  const uint64_t count = over.CountRange(range.first, range.last), first = over.RankOf(range.first);
  for (size_t i = 0; i < n && count > 0; ++i) {
    if (count <= n && i >= count) break;
    const uint64_t at = count <= n ? i : count * (2 * i + 1) / (2 * n);
    sample.push_back(QuadOf(over.KeyAt(first + at), order));
  }
  return sample;
}

namespace {

// The distinct first words of an index.
std::vector<TermId> FirstWords(const QuadTree& tree) {
  std::vector<TermId> words;
  constexpr uint64_t kMax = ~uint64_t{0};
  QuadTree::Iterator i = tree.Range({}, {kMax, kMax, kMax, kMax});
  while (i.Valid()) {
    const uint64_t word = i.key()[0];
    words.push_back(TermId(word));
    i.Seek({word, kMax, kMax, kMax});  // no quad is all ones, so this is past the word
  }
  return words;
}

}  // namespace

std::vector<TermId> GraphVersion::graphs() const {
  ReadTrace::NoteNames();
  return FirstWords(tree(IndexOrder::kGspo));
}

std::vector<TermId> GraphVersion::predicates() const {
  ReadTrace::NoteNames();
  return FirstWords(tree(IndexOrder::kPosg));
}

size_t GraphVersion::bytes() const {
  size_t bytes = 0;
  for (const QuadTree& tree : trees_) bytes += tree.bytes();
  return bytes;
}

size_t GraphVersion::replaced_bytes() const {
  size_t bytes = 0;
  for (const QuadTree& tree : trees_) bytes += tree.replaced_bytes();
  return bytes;
}

void GraphVersion::CheckInvariants() const {
  for (const QuadTree& tree : trees_) {
    tree.CheckInvariants();
    if (tree.size() != size()) std::abort();
  }
}

}  // namespace docent
