// Values that runs of the flow have which the activator starts: at their start, and at each node. Points into the document, which
// must outlive it. One thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_FLOW_VALUES_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_FLOW_VALUES_H_

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "workflow/cawl/ast.h"
#include "workflow/cawl/check/environment.h"
#include "workflow/cawl/check/node_reach.h"

namespace docent::cawl {

using Keys = std::set<std::string>;

// What a match of the condition may give a value: ?x, and $x, which is like it until it has one.
Keys MatchedBy(const Condition& condition);

class FlowValues {
 public:
  // `environment` null: what an invoked operation gives is not known. `flow`: of at most kMaxPairedNodes nodes.
  FlowValues(const Document& document, const Flow& flow, const Environment* environment);

  const Keys& at_start() const { return start_; }

  // Whether `key` may have a value while the node waits for its condition; also not the first time, where a loop leads back to it.
  bool MayHaveBefore(const std::string& key, const Node& node) const;
  // In an action of the node, `action`, or in its invokes (null), the first time that they need it: without it the node fails,
  // so that no loop leads back to it but by a link with onFailure or onInterrupt.
  bool MayHaveIn(const std::string& key, const Node& node, const Action* action) const;
  // When the node is done.
  bool MayHaveAfter(const std::string& key, const Node& node) const;

 private:
  // What a node gives values to: by its condition when it opens, by its actions, by its invocations when they are done.
  struct NodeValues {
    Keys matched, assigned, given;
    bool gives_anything = false;  // an operation or sub-flow of which the results are not known
  };

  static NodeValues ValuesOf(const Node& node, const Environment* environment);
  size_t PlaceOf(const Node& node) const { return static_cast<size_t>(&node - flow_.nodes.data()); }
  // The nodes that may give the key a value.
  NodeSet GiversOf(const std::string& key) const;
  // What a run reaches before the node is done for the first time.
  const NodeSet& ReachedWithout(size_t node) const;

  const Flow& flow_;
  const NodeReach links_, exceptional_;  // all; those with onFailure and onInterrupt
  std::vector<NodeValues> nodes_;        // in the order of the flow's
  std::map<std::string, NodeSet> givers_;
  NodeSet give_anything_;
  Keys start_;
  mutable std::vector<std::optional<NodeSet>> without_;
};

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_FLOW_VALUES_H_
