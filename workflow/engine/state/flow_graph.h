// Questions about the links of a flow. Pure functions over the syntax tree.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_FLOW_GRAPH_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_FLOW_GRAPH_H_

#include <cstddef>
#include <set>
#include <string_view>
#include <vector>

#include "workflow/cawl/ast.h"

namespace docent::engine {

// Index of the node of that name; flow.nodes.size() for the source, the sink and unknown names.
size_t NodeIndex(const cawl::Flow& flow, std::string_view name);

// Indexes of links out of a node (or the source), in document order.
std::vector<size_t> LinksFrom(const cawl::Flow& flow, std::string_view name);

// Names whose links lead to the node, without those that close a cycle (ext:while): the ones that a join
// waits for.
std::set<std::string> Predecessors(const cawl::Flow& flow, size_t node);

// True if the link leads back to a node from which its own start can be reached.
bool ClosesCycle(const cawl::Flow& flow, const cawl::Link& link);

// Indexes of the nodes that can be reached from `node`, itself included, without going back over cycles.
std::set<size_t> Reachable(const cawl::Flow& flow, size_t node);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_FLOW_GRAPH_H_
