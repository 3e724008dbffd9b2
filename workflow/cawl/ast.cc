#include "workflow/cawl/ast.h"

namespace docent::cawl {

const Node* Flow::FindNode(std::string_view node_name) const {
  for (const Node& node : nodes) {
    if (node.name.value == node_name) return &node;
  }
  return nullptr;
}

const Flow* Document::FindFlow(std::string_view flow_name) const {
  for (const Flow& flow : flows) {
    if (flow.name.value == flow_name) return &flow;
  }
  return nullptr;
}

const Flow* Document::FlowToStart(std::string_view flow_name) const {
  if (flow_name.empty() && activator) flow_name = activator->flow.value;
  if (!flow_name.empty()) return FindFlow(flow_name);
  return flows.empty() ? nullptr : &flows.front();
}

}  // namespace docent::cawl
