// A position in a scan of a graph version.
#ifndef DOCENT_GRAPH_STORE_QUAD_CURSOR_H_
#define DOCENT_GRAPH_STORE_QUAD_CURSOR_H_

#include <cstdint>

#include "graph/store/hidden_triples.h"
#include "graph/store/index_order.h"
#include "graph/store/quad.h"
#include "graph/store/quad_tree.h"
#include "graph/store/quad_tree_node.h"

namespace docent {

// Usage: for (auto c = version.Scan(p); c.Valid(); c.Next()) use(c.quad());
// Holds a pointer into the version, which must outlive it. A change by the writer whose current() it reads
// invalidates it. One thread.
class QuadCursor {
 public:
  QuadCursor() = default;
  bool Valid() const { return iterator_.Valid(); }
  // Requires Valid(), as all functions up to term().
  void Next() {
    iterator_.Next();
    if (filters()) Settle();
  }
  // Moves past this triple and its copies in other graphs. Requires that one run of an index holds the matches, with
  // adjacent copies.
  void NextTriple() {
    const bool alone =
        iterator_.leaf()->mask[3] == 0 && !iterator_.NextIsElsewhere();  // the leaf is within one graph
    alone ? iterator_.Next() : SkipCopies();
    if (hidden_ != nullptr) Settle();
  }
  // Reads from the index at each call.
  Quad quad() const { return {term(0), term(1), term(2), term(3)}; }
  // The term at a position of quad() (0 to 3: subject, predicate, object, graph).
  TermId term(int position) const {
    return TermId(
        iterator_.leaf()->Word(iterator_.position(), kWords[static_cast<size_t>(order_)][position]));
  }
  // Moves forward to the first match whose key in this cursor's order is >= the key of `target`; stays if the
  // current match is. O(log distance).
  void Seek(const Quad& target);
  // Number of remaining matches, with this one. `triples`: copies of a triple in several graphs count once;
  // they must be adjacent. The cursor is then at its end. Much faster than a walk. Requires !filters().
  uint64_t CountRest(bool triples);
  // True if it skips quads that do not match: only a walk can then count the matches.
  bool filters() const { return filter_ || hidden_ != nullptr; }
  IndexOrder order() const { return order_; }
  // Detaches the cursor from its version: only a Rescan may follow.
  void Forget() { tree_ = nullptr; }
  // Number of Rescans with matches away from the last ones, since the order changed.
  uint64_t descents() const { return tree_ == nullptr ? 0 : iterator_.descents(); }

 private:
  friend class GraphVersion;
  void Settle();
  void SkipCopies();

  const QuadTree* tree_ = nullptr;  // the tree of iterator_
  QuadTree::Iterator iterator_;
  QuadPattern pattern_;  // used if filter_
  IndexOrder order_ = IndexOrder::kSpog;
  bool filter_ = false;                    // positions beyond the prefix are bound
  const HiddenTriples* hidden_ = nullptr;  // may hide some matches; null: none
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_CURSOR_H_
