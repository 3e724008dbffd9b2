// An immutable version of the whole graph: persistent B+-trees over quads with subtree counts.
//
// A version is held by shared_ptr<const GraphVersion>; any number of threads read it. It never changes; the
// next version copies only the paths to the changes.
//
// Four index orders: SPOG, POSG, OSPG and GSPO. Each scan walks the order in which the pattern's bound
// positions are a prefix, so the matches are one contiguous run. If no order has them all as a prefix (a
// graph bound together with a predicate or an object), the scan filters.
#ifndef DOCENT_GRAPH_STORE_GRAPH_VERSION_H_
#define DOCENT_GRAPH_STORE_GRAPH_VERSION_H_

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "graph/base/ids.h"
#include "graph/store/hidden_triples.h"
#include "graph/store/quad.h"
#include "graph/store/quad_cursor.h"
#include "graph/store/quad_tree.h"

namespace docent {

class GraphVersion {
 public:
  GraphVersion() = default;  // the empty graph, revision 0
  GraphVersion& operator=(const GraphVersion&) = delete;

  Revision revision() const { return revision_; }
  // Number of quads in all graphs, inferred ones included.
  uint64_t size() const { return trees_[0].size(); }

  // This version without the triples of `hidden`, which must outlive it. All reads of patterns leave them out, except those
  // of one quad with its graph; Count, Sample and the lists of names are as before, so they may be too high. Of a writer's
  // current(): as long as that does not change. O(1).
  std::shared_ptr<const GraphVersion> Without(const HiddenTriples& hidden) const;

  bool Contains(const Quad& quad) const;
  // True if Scan(pattern) finds a match; faster.
  bool ContainsMatch(const QuadPattern& pattern) const;
  // Matches in the order that suits the pattern. A triple in two graphs comes twice. The two are adjacent,
  // because the graph is the last word of the order if no graph is bound.
  QuadCursor Scan(const QuadPattern& pattern) const;
  // *cursor = Scan(pattern), faster if the cursor is of this version and its last matches are near. The
  // version must not change between the calls. A new or forgotten cursor is allowed, too.
  void Rescan(const QuadPattern& pattern, QuadCursor* cursor) const;
  // The same for patterns that bind exactly the positions of `path`.
  void Rescan(const QuadPattern& pattern, const AccessPath& path, QuadCursor* cursor) const;
  // The path for patterns that bind these positions (BoundIn); nullopt if no index has them as one run.
  static std::optional<AccessPath> PathFor(unsigned bound);
  // As Scan, in a given order; positions beyond the order's prefix are filtered (for merge joins). In kGspo
  // the copies of a triple are not adjacent.
  QuadCursor ScanInOrder(const QuadPattern& pattern, IndexOrder order) const;
  // The number of matches, in O(log n). It is an upper bound if a graph is bound together with a predicate or
  // an object, but not all of S, P and O (and not with S, or S and P, alone): the smaller of the count
  // without the graph and the count of the graph. Else it is exact.
  uint64_t Count(const QuadPattern& pattern) const;
  // At most `n` matches, evenly spaced in index order: for estimates. Fewer, or none, if no index has the
  // matches as one run. O(n log size).
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

  // Memory of the index nodes of this version, shared with other versions or not. O(1).
  size_t bytes() const;
  // For two versions of one history: the difference of this number is the extra memory for keeping the
  // earlier one beside the later one. O(1).
  size_t replaced_bytes() const;
  // Aborts if an index is broken or the indexes differ in size. For tests; O(n).
  void CheckInvariants() const;

 private:
  friend class GraphWriter;
  // For the writer: the copy shares all nodes.
  GraphVersion(const GraphVersion&) = default;

  // bound: as from BoundIn.
  IndexOrder OrderFor(const QuadPattern& pattern, unsigned bound) const;
  // The cursor must be of this version, or of none.
  void Place(const QuadPattern& pattern, const KeyRange& range, IndexOrder order, QuadCursor* cursor) const;
  void Open(const QuadPattern& pattern, unsigned bound, IndexOrder order, QuadCursor* cursor) const;
  const QuadTree& tree(IndexOrder order) const { return trees_[static_cast<size_t>(order)]; }

  std::array<QuadTree, kIndexOrders> trees_;  // by IndexOrder
  Revision revision_;
  const HiddenTriples* hidden_ = nullptr;
};

using GraphVersionPtr = std::shared_ptr<const GraphVersion>;

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_GRAPH_VERSION_H_
