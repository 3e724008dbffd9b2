// A position in a scan of a graph version.
#ifndef DOCENT_GRAPH_STORE_QUAD_CURSOR_H_
#define DOCENT_GRAPH_STORE_QUAD_CURSOR_H_

#include <cstdint>

#include "graph/store/index_order.h"
#include "graph/store/quad.h"
#include "graph/store/quad_tree.h"
#include "graph/store/quad_tree_node.h"

namespace docent {

// Usage: for (auto c = version.Scan(p); c.Valid(); c.Next()) use(c.quad());
// Holds a pointer into the version, which must outlive it; a change by the writer whose current() it reads
// makes it invalid. One thread.
class QuadCursor {
 public:
  QuadCursor() = default;
  bool Valid() const { return iterator_.Valid(); }
  // Requires Valid(), as do those up to term().
  void Next() {
    iterator_.Next();
    if (filter_) Settle();
  }
  // Past this triple and its copies in other graphs. Requires !filters(), and an order in which copies are adjacent.
  void NextTriple() {
    const bool alone =
        iterator_.leaf()->mask[3] == 0 && !iterator_.NextIsElsewhere();  // the leaf is within one graph
    return alone ? iterator_.Next() : SkipCopies();
  }
  // Read from the index each time.
  Quad quad() const { return {term(0), term(1), term(2), term(3)}; }
  // What stands at a position of quad() (0 to 3: subject, predicate, object, graph).
  TermId term(int position) const {
    return TermId(
        iterator_.leaf()->Word(iterator_.position(), kWords[static_cast<size_t>(order_)][position]));
  }
  // Moves forward to the first match whose key in this cursor's order is >= the key of `target`; stays if the
  // current one is. O(log distance).
  void Seek(const Quad& target);
  // How many matches are left, this one among them; `triples`: copies of a triple in several graphs, which must be adjacent,
  // are one. The cursor is then at its end. Much quicker than going over them. Requires !filters().
  uint64_t CountRest(bool triples);
  // Whether it passes over quads that do not match: then only going over them tells how many do.
  bool filters() const { return filter_; }
  IndexOrder order() const { return order_; }
  // Of no version from now on: nothing but a Rescan may follow.
  void Forget() { tree_ = nullptr; }
  // How many Rescans found their matches elsewhere than beside the last ones, since it changed its order.
  uint64_t descents() const { return tree_ == nullptr ? 0 : iterator_.descents(); }

 private:
  friend class GraphVersion;
  void Settle();
  void SkipCopies();

  const QuadTree* tree_ = nullptr;  // what iterator_ goes over
  QuadTree::Iterator iterator_;
  QuadPattern pattern_;  // where filter_
  IndexOrder order_ = IndexOrder::kSpog;
  bool filter_ = false;  // bound positions beyond the prefix
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_CURSOR_H_
