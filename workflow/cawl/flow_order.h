// The order in which a flow's nodes come, for people. Pure; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_FLOW_ORDER_H_
#define DOCENT_WORKFLOW_CAWL_FLOW_ORDER_H_

#include "workflow/cawl/ast.h"

namespace docent::cawl {

// Sets Node::position of each node, from 1: a node comes after those from which a link without `while` leads to it; of nodes
// that may come at the same time the one that stands first in the document (Kahn, CACM 1962). Nodes of a cycle without
// `while`, which is an error, come last.
void OrderNodes(Flow* flow);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_FLOW_ORDER_H_
