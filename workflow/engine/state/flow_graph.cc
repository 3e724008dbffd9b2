#include "workflow/engine/state/flow_graph.h"

#include <string>

namespace docent::engine {
namespace {

void Visit(const cawl::Flow& flow, size_t node, bool follow_while, std::set<size_t>* seen) {
  if (node >= flow.nodes.size() || !seen->insert(node).second) return;
  for (const cawl::Link& link : flow.links) {
    if (link.from.value != flow.nodes[node].name.value) continue;
    if (link.while_constraint && !follow_while) continue;
    Visit(flow, NodeIndex(flow, link.to.value), follow_while, seen);
  }
}

}  // namespace

size_t NodeIndex(const cawl::Flow& flow, std::string_view name) {
  for (size_t i = 0; i < flow.nodes.size(); ++i) {
    if (flow.nodes[i].name.value == name) return i;
  }
  return flow.nodes.size();
}

std::vector<size_t> LinksFrom(const cawl::Flow& flow, std::string_view name) {
  std::vector<size_t> links;
  for (size_t i = 0; i < flow.links.size(); ++i) {
    if (flow.links[i].from.value == name) links.push_back(i);
  }
  return links;
}

bool ClosesCycle(const cawl::Flow& flow, const cawl::Link& link) {
  if (!link.while_constraint) return false;
  std::set<size_t> seen;
  Visit(flow, NodeIndex(flow, link.to.value), false, &seen);
  return seen.count(NodeIndex(flow, link.from.value)) > 0;
}

std::set<std::string> Predecessors(const cawl::Flow& flow, size_t node) {
  std::set<std::string> names;
  for (const cawl::Link& link : flow.links) {
    if (link.to.value == flow.nodes[node].name.value && !ClosesCycle(flow, link))
      names.insert(link.from.value);
  }
  return names;
}

std::set<size_t> Reachable(const cawl::Flow& flow, size_t node) {
  std::set<size_t> seen;
  Visit(flow, node, false, &seen);
  return seen;
}

}  // namespace docent::engine
