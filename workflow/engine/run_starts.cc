// What a run begins with: its document and its number.
#include <utility>

#include "workflow/engine/engine_core.h"

namespace docent::engine {

std::optional<std::pair<cawl::DocumentPtr, size_t>> Engine::Core::FindFlow(const cawl::DocumentPtr& from,
                                                                           const std::string& name) const {
  const auto found = [](const cawl::DocumentPtr& document, const cawl::Flow* flow) {
    return std::make_pair(document, static_cast<size_t>(flow - document->flows.data()));
  };
  if (from != nullptr) {
    if (const cawl::Flow* flow = from->FindFlow(name)) return found(from, flow);
  }
  for (const auto& [workflow, flow_name] : cawl::StartTargets(name)) {
    const auto it = deployments.find(workflow);
    if (it == deployments.end()) continue;
    const bool is_played = played && from == played->played().document && from->name.value == workflow;
    const cawl::DocumentPtr& document = is_played ? from : it->second.document;
    if (const cawl::Flow* flow = document->FlowToStart(flow_name)) return found(document, flow);
  }
  return std::nullopt;
}

void RunNumbers::Begin(uint64_t number, cawl::DocumentPtr* document, size_t* flow,
                       TermBinding* variables) const {
  if (number != played_.number) return;
  const cawl::Flow* begun = played_.document->FindFlow(played_.flow);
  if (begun == nullptr) return;
  *document = played_.document;
  *flow = static_cast<size_t>(begun - played_.document->flows.data());
  if (played_.variables) *variables = *played_.variables;
}

void Engine::PlayInstead(PlayedRun played) {
  core_->played.emplace(std::move(played));
}

uint64_t Engine::Core::TakeNumber(const CommandOwner* parent) {
  if (!played) return next_run++;
  const auto root = parent == nullptr ? runs.end() : runs.find(runs.at(parent->run).root);
  const bool is_nested = root != runs.end() && root->second.number == played->played().number;
  return is_nested ? played->Nested() : played->Other(&next_run);
}

}  // namespace docent::engine
