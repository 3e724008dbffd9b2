// Documents that are deployed: their activators' conditions are armed, and stay so when a document is loaded again.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "workflow/engine/engine.h"
#include "workflow/engine/engine_core.h"
#include "workflow/engine/run_steering.h"
#include "workflow/engine/service_workflow.h"

namespace docent::engine {

void Engine::Core::DisarmDeployed(ConditionHandle handle) {
  owners.erase(handle);
  event_waits.Disarm(handle);
  const size_t not_yet = std::erase_if(
      deploy_arm, [handle](const ConditionRequest& request) { return request.handle == handle; });
  if (not_yet == 0) deploy_disarm.push_back(handle);
}

namespace {

// Whether a document's activator fires for the same bindings as the deployed one: then what is armed stays, with its times and
// with what it has fired for. `*names`: what its variables are called in the document.
bool FiresForTheSame(const Deployment& deployed, const cawl::Document& document,
                     const std::vector<cawl::CompiledAsk>& asks, cawl::NameMap* names) {
  if (deployed.document == nullptr || !deployed.document->activator || !document.activator) return false;
  const auto& armed = deployed.armed;
  const bool same = std::equal(armed.begin(), armed.end(), asks.begin(), asks.end(),
                               [names](const ArmedCondition& has, const cawl::CompiledAsk& ask) {
                                 return cawl::AskTheSame(has.ask, ask, names);
                               });
  return same && std::all_of(armed.begin(), armed.end(), [&](const ArmedCondition& has) {
           return cawl::KeyVariables(*deployed.document->activator, has.ask, deployed.names) ==
                  cawl::KeyVariables(*document.activator, has.ask, *names);
         });
}

}  // namespace

absl::Status Engine::Deploy(cawl::DocumentPtr document) {
  std::vector<cawl::CompiledAsk> asks;
  if (document->activator) {
    auto compiled = cawl::CompileCondition(
        *document, document->activator->condition, [](const std::string&) { return std::nullopt; },
        core_->limits);
    if (!compiled.ok()) return compiled.status();
    asks = *std::move(compiled);
    for (cawl::CompiledAsk& ask : asks) {
      if (absl::Status status = cawl::ParseAsks(core_->limits, &ask); !status.ok()) return status;
    }
  }
  Deployment& deployment = core_->MutableDeployment(document->name.value);
  cawl::NameMap names;
  if (FiresForTheSame(deployment, *document, asks, &names)) {
    std::erase_if(names, [](const auto& name) { return name.first == name.second; });
    for (size_t i = 0; i < asks.size(); ++i) {
      core_->event_waits.Arm(deployment.armed[i].handle, asks[i]);
      if (names.empty()) deployment.armed[i].ask = Armed(0, std::move(asks[i])).ask;
    }
    deployment.names = std::move(names);
    deployment.document = std::move(document);
    return absl::OkStatus();
  }
  core_->bounds.Deployed(document->name.value);
  for (const ArmedCondition& armed : deployment.armed) core_->DisarmDeployed(armed.handle);
  Deployment fresh;
  fresh.document = document;
  fresh.disabled = deployment.disabled;
  fresh.carried = std::move(deployment.carried);
  for (const auto& [key, count] : deployment.active) {
    if (!deployment.held_back.contains(key)) fresh.carried.insert(key);
  }
  if (!document->activator) core_->activations.Forget(document->name.value);
  for (cawl::CompiledAsk& ask : asks) {
    ConditionHandle handle = core_->next_handle++;
    core_->owners[handle] = {RunId(), 0, document->name.value};
    core_->event_waits.Arm(handle, ask);
    core_->deploy_arm.push_back(RequestOf(handle, ask, cawl::KeyVariables(*document->activator, ask)));
    fresh.armed.push_back(Armed(handle, std::move(ask)));
  }
  deployment = std::move(fresh);
  return absl::OkStatus();
}

bool Engine::Undeploy(const std::string& workflow, bool cancel_runs) {
  if (core_->deployments.count(workflow) == 0) return false;
  for (const ArmedCondition& armed : core_->MutableDeployment(workflow).armed)
    core_->DisarmDeployed(armed.handle);
  core_->deployments.erase(workflow);
  core_->deploy_gone.push_back(workflow);
  core_->activations.Forget(workflow);
  if (const auto pause = core_->paused_workflows.find(workflow); pause != core_->paused_workflows.end()) {
    core_->deploy_remove = PausedWorkflowFacts(workflow, pause->second, &core_->run_terms);
    if (!core_->undo_paused_workflows) core_->undo_paused_workflows = core_->paused_workflows;
    core_->paused_workflows.erase(pause);
  }
  if (!cancel_runs) return true;
  for (const auto& [id, run] : core_->runs) {
    if (run.document->name.value == workflow && ServiceOf(*run.document).empty())
      core_->deploy_cancel.push_back(id);
  }
  return true;
}

bool Engine::SetEnabled(const std::string& workflow, bool enabled) {
  const auto deployed = core_->deployments.find(workflow);
  if (deployed == core_->deployments.end()) return false;
  if (deployed->second.disabled != enabled) return true;
  core_->MutableDeployment(workflow).disabled = !enabled;
  if (enabled) core_->deploy_enabled.push_back(workflow);
  return true;
}

bool Engine::IsEnabled(const std::string& workflow) const {
  const auto deployed = core_->deployments.find(workflow);
  return deployed != core_->deployments.end() && !deployed->second.disabled;
}

std::string Engine::PlaceOf(ConditionHandle handle) const {
  const auto owner = core_->owners.find(handle);
  if (owner == core_->owners.end()) return "";
  if (owner->second.run.empty()) return absl::StrCat("activator of ", owner->second.workflow);
  const auto run = core_->runs.find(owner->second.run);
  if (run == core_->runs.end()) return "";
  return absl::StrCat("run ", run->first.value(), ", node ",
                      run->second.Flow().nodes[owner->second.node].name.value);
}

}  // namespace docent::engine
