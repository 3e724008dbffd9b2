#include "workflow/cawl/ast.h"

#include <algorithm>

namespace docent::cawl {

const Input* Invoke::FindInput(std::string_view part) const {
  const auto found = std::find_if(inputs.begin(), inputs.end(),
                                  [part](const Input& input) { return input.part.value == part; });
  return found == inputs.end() ? nullptr : &*found;
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

Urgency UrgencyOf(const Document& document, const Flow& flow) {
  if (flow.urgency) return *flow.urgency;
  const std::optional<Activator>& activator = document.activator;
  return activator && activator->flow.value == flow.name.value ? activator->urgency.value_or(Urgency())
                                                               : Urgency();
}

std::vector<std::pair<std::string, std::string>> StartTargets(std::string_view text) {
  std::vector<std::pair<std::string, std::string>> targets = {{std::string(text), ""}};
  for (size_t slash = text.find('/'); slash != std::string_view::npos; slash = text.find('/', slash + 1)) {
    targets.emplace_back(text.substr(0, slash), text.substr(slash + 1));
  }
  return targets;
}

}  // namespace docent::cawl
