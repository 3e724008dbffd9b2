// An immutable version of the whole graph: persistent B+-trees over quads with subtree counts.
//
// A version is held by shared_ptr<const GraphVersion>; any number of threads read it, nothing changes it, and
// making the next version copies only the path to what changed.
//
// Three index orders: SPOG, POSG, OSPG. Each scan walks the order in which the pattern's bound positions are a
// prefix, so the matches come as one contiguous run; the graph, if bound, filters where it is not in the prefix.
#ifndef DOCENT_KB_SERVER_STORE_GRAPH_VERSION_H_
#define DOCENT_KB_SERVER_STORE_GRAPH_VERSION_H_

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kb_server/base/ids.h"
#include "kb_server/store/quad.h"
#include "kb_server/store/quad_tree.h"

namespace docent {

enum class IndexOrder : uint8_t { kSpog = 0, kPosg = 1, kOspg = 2 };

// A position in a scan. Usage: for (auto c = version.Scan(p); c.Valid(); c.Next()) use(c.quad());
// Holds a pointer into the version, which must outlive it. One thread.
class QuadCursor {
 public:
  QuadCursor() = default;
  bool Valid() const { return valid_; }
  void Next();
  // Moves forward to the first match whose key in this cursor's order is >= the key of `target` (galloping).
  void Seek(const Quad& target);
  const Quad& quad() const { return quad_; }
  IndexOrder order() const { return order_; }

 private:
  friend class GraphVersion;
  void Settle();

  QuadTree::Iterator iterator_;
  IndexOrder order_ = IndexOrder::kSpog;
  QuadPattern pattern_;
  std::array<uint64_t, 4> last_key_ = {};  // end of the run, inclusive
  Quad quad_;
  bool filter_ = false;
  bool valid_ = false;
};

class GraphVersion {
 public:
  GraphVersion() = default;

  Revision revision() const { return revision_; }
  // Quads in all graphs, inferred ones included.
  uint64_t size() const { return trees_[0].size(); }

  bool Contains(const Quad& quad) const;
  // Matches in index order; a triple that stands in two graphs comes twice (adjacent).
  QuadCursor Scan(const QuadPattern& pattern) const;
  // As Scan, in a given order; what the order's prefix does not cover is filtered (for merge joins).
  QuadCursor ScanInOrder(const QuadPattern& pattern, IndexOrder order) const;
  // Exact number of matches where the bound positions form a prefix of an order (every combination without the
  // graph, and SPO+G); with a graph bound besides fewer positions it is the count without the graph: an upper bound.
  // O(log n).
  uint64_t Count(const QuadPattern& pattern) const;
  // Calls `visit(quad)` for each match until it returns false. Faster than a cursor for full runs.
  template <typename Visit>
  void ForEach(const QuadPattern& pattern, Visit visit) const {
    for (QuadCursor c = Scan(pattern); c.Valid(); c.Next()) {
      if (!visit(c.quad())) return;
    }
  }
  // The distinct graphs that hold at least one quad.
  const std::vector<TermId>& graphs() const;

  // Memory of nodes that this version holds, shared or not; estimated.
  size_t bytes() const;

 private:
  friend class GraphWriter;
  std::array<QuadTree, 3> trees_;  // by IndexOrder
  Revision revision_;
  std::shared_ptr<const std::vector<std::pair<TermId, uint64_t>>> graph_sizes_;  // sorted by graph
  mutable std::vector<TermId> graph_list_;
};

using GraphVersionPtr = std::shared_ptr<const GraphVersion>;

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_GRAPH_VERSION_H_
