// Which runs may start, and what becomes of activators and conditions that go beyond their bounds.
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/run_limits.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/engine_core.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {

size_t SizeOf(const Run& run) {
  return std::accumulate(run.nodes.begin(), run.nodes.end(), run.nodes.size(),
                         [](size_t sum, const NodeState& node) { return sum + node.invocations.size(); });
}

std::string Engine::Core::WhyNoRoom(size_t nodes) const {
  if (runs.size() >= limits.runs_live) {
    return absl::StrCat("there are ", runs.size(), " live runs; the limit runs_live is ", limits.runs_live);
  }
  return WhyNoNodes(nodes);
}

std::string Engine::Core::WhyNoNodes(size_t nodes) const {
  if (nodes_live + nodes > kRunLimits.nodes_live) {
    return absl::StrCat("live runs have ", nodes_live, " nodes and invocations, and this would be ", nodes,
                        " more; the limit nodes_live is ", kRunLimits.nodes_live);
  }
  return "";
}

absl::Status Engine::Core::TellMissed() {
  absl::Status refused;
  for (const auto& [workflow, missed] : bounds.TakeMissed()) {
    const std::string subject = Concat(kActivatorSubject, "/", IriSegment(workflow));
    const std::string more = missed.more == 0 ? "" : absl::StrCat(" and ", missed.more, " more");
    Say(subject, "", "failed", absl::StrCat("no run was started for ", missed.first, more, ": ", missed.why));
    if (!missed.of_turn || !bounds.IsOfThisTurn(workflow)) continue;
    refused.Update(absl::ResourceExhaustedError(absl::StrCat(
        "the activator of ", workflow, " fires too often: ", missed.why,
        ". Narrow its condition: a pattern that any fact matches, or facts of runs, match what its own "
        "runs write")));
  }
  return refused;
}

absl::Status Engine::Core::GiveUp(ConditionHandle handle) {
  const auto found = owners.find(handle);
  if (found == owners.end()) return absl::OkStatus();
  const ConditionOwner owner = found->second;
  const absl::Status why = absl::ResourceExhaustedError(absl::StrCat(
      "its condition has more matches than the limit condition_matches = ", kRunLimits.condition_matches,
      "; name a predicate or a class, or join its patterns"));
  if (!owner.run.empty()) {
    if (Run* run = Mutable(owner.run)) RunStepper(this, run).GiveUp(owner.node, why);
    touched.insert(owner.run);
    return absl::OkStatus();
  }
  if (bounds.IsOfThisTurn(owner.workflow)) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the activator of ", owner.workflow, ": ", why.message()));
  }
  for (const ArmedCondition& armed : std::exchange(MutableDeployment(owner.workflow).armed, {}))
    Disarm(armed.handle);
  Say(Concat(kActivatorSubject, "/", IriSegment(owner.workflow)), "", "failed",
      absl::StrCat("its activator starts no more runs until it is deployed again: ", why.message()));
  return absl::OkStatus();
}

}  // namespace docent::engine
