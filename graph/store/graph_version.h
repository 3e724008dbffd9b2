// An immutable version of the whole graph: persistent B+-trees over quads with subtree counts.
//
// A version is held by shared_ptr<const GraphVersion>; any number of threads read it, nothing changes it, and
// making the next version copies only the path to what changed.
//
// Four index orders: SPOG, POSG, OSPG and GSPO. Each scan walks the order in which the pattern's bound
// positions are a prefix, so the matches come as one contiguous run; where no order has them all as a prefix
// (a graph bound besides a predicate or an object), the rest filters.
#ifndef DOCENT_GRAPH_STORE_GRAPH_VERSION_H_
#define DOCENT_GRAPH_STORE_GRAPH_VERSION_H_

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "graph/base/ids.h"
#include "graph/store/quad.h"
#include "graph/store/quad_cursor.h"
#include "graph/store/quad_tree.h"

namespace docent {

class GraphVersion {
 public:
  GraphVersion() = default;  // the empty graph, revision 0
  GraphVersion& operator=(const GraphVersion&) = delete;

  Revision revision() const { return revision_; }
  // Quads in all graphs, inferred ones included.
  uint64_t size() const { return trees_[0].size(); }

  bool Contains(const Quad& quad) const;
  // Whether Scan(pattern) finds anything; quicker.
  bool ContainsMatch(const QuadPattern& pattern) const;
  // Matches in the order that suits the pattern. A triple that stands in two graphs comes twice: adjacent,
  // since where no graph is bound the graph is the last word of the order.
  QuadCursor Scan(const QuadPattern& pattern) const;
  // *cursor = Scan(pattern), quicker where the cursor is of this version already and the matches lie near those of its
  // last pattern. The version must not have changed since the cursor was made. A new or forgotten cursor will do, too.
  void Rescan(const QuadPattern& pattern, QuadCursor* cursor) const;
  // The same for patterns that bind just the positions that `path` was made for.
  void Rescan(const QuadPattern& pattern, const AccessPath& path, QuadCursor* cursor) const;
  // Of all patterns that bind these positions (as BoundIn tells); none where no index has all their matches side by side.
  static std::optional<AccessPath> PathFor(unsigned bound);
  // As Scan, in a given order; what the order's prefix does not cover is filtered (for merge joins). In kGspo
  // the copies of a triple are not adjacent.
  QuadCursor ScanInOrder(const QuadPattern& pattern, IndexOrder order) const;
  // The number of matches. Exact, but for a graph bound together with a predicate or an object and not all of
  // S, P and O (and not S, or S and P, alone): then the smaller of the counts without the graph and of the
  // graph, an upper bound. O(log n).
  uint64_t Count(const QuadPattern& pattern) const;
  // At most `n` matches, evenly spaced in index order: for estimates. Fewer, or none, where no index holds the matches as
  // one run. O(n log size).
  std::vector<Quad> Sample(const QuadPattern& pattern, size_t n) const;
  // Calls `visit(quad)` for each match until it returns false.
  template <typename Visit>
  void ForEach(const QuadPattern& pattern, Visit visit) const {
    for (QuadCursor c = Scan(pattern); c.Valid(); c.Next()) {
      if (!visit(c.quad())) return;
    }
  }
  // The distinct graphs that hold at least one quad, ascending. O(graphs * log n).
  std::vector<TermId> graphs() const;
  // The distinct predicates, ascending. O(predicates * log n).
  std::vector<TermId> predicates() const;

  // Memory of the index nodes that this version holds, shared with others or not. O(1).
  size_t bytes() const;
  // Of two versions that came one from the other, the difference of this number is the memory that the earlier
  // one costs while the later one is kept anyway. O(1).
  size_t replaced_bytes() const;
  // Aborts if an index is broken or the indexes differ in size. For tests; O(n).
  void CheckInvariants() const;

 private:
  friend class GraphWriter;
  // For the writer: shares all nodes.
  GraphVersion(const GraphVersion&) = default;

  // bound: as BoundIn tells.
  IndexOrder OrderFor(const QuadPattern& pattern, unsigned bound) const;
  // The cursor is of this version, or of none.
  void Place(const KeyRange& range, IndexOrder order, QuadCursor* cursor) const;
  void Open(const QuadPattern& pattern, unsigned bound, IndexOrder order, QuadCursor* cursor) const;
  const QuadTree& tree(IndexOrder order) const { return trees_[static_cast<size_t>(order)]; }

  std::array<QuadTree, kIndexOrders> trees_;  // by IndexOrder
  Revision revision_;
};

using GraphVersionPtr = std::shared_ptr<const GraphVersion>;

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_GRAPH_VERSION_H_
