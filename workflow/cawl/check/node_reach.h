// Which nodes of a flow come after which: every pair of them, as sets of bits. Immutable; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_NODE_REACH_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_NODE_REACH_H_

#include <bitset>
#include <cstddef>
#include <functional>
#include <vector>

#include "workflow/cawl/ast.h"
#include "workflow/cawl/check/static_checks.h"

namespace docent::cawl {

// Nodes of one flow, by their places in it.
using NodeSet = std::bitset<kMaxPairedNodes>;

template <typename Use>
void ForEachNode(const NodeSet& nodes, const Use& use) {
  for (size_t i = nodes._Find_first(); i < nodes.size(); i = nodes._Find_next(i)) use(i);
}

class NodeReach {
 public:
  // By the links that `takes`. `flow`: of at most kMaxPairedNodes nodes, no two of one name.
  NodeReach(const Flow& flow, const std::function<bool(const Link&)>& takes);

  // The nodes to which links lead from a node, or from the source.
  const NodeSet& Next(size_t node) const { return next_[node]; }
  const NodeSet& first() const { return first_; }
  // Those that a way of one link or more leads to, or comes from.
  const NodeSet& After(size_t node) const { return after_[node]; }
  const NodeSet& Before(size_t node) const { return before_[node]; }
  // Those that are reached from the source where only links to `onward` lead out of `node`.
  NodeSet ReachedWith(size_t node, const NodeSet& onward) const;

 private:
  std::vector<NodeSet> next_, after_, before_;
  NodeSet first_;
};

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_NODE_REACH_H_
