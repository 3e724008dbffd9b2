#include "workflow/engine/activator_modes.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"

namespace docent::engine {
namespace {

using Mode = cawl::ActivatorMode;
using Firing = Activations::Firing;

void SayOf(Engine::Core* core, const std::string& workflow, std::string_view to, const Firing& firing,
           const std::string& why) {
  core->Say(Concat(kActivatorSubject, "/", IriSegment(workflow)), "", to,
            absl::StrCat(firing.cause, "; ", why));
}

void Ignore(Engine::Core* core, const std::string& workflow, const Firing& firing, const std::string& why) {
  core->activations.Ignored(workflow);
  SayOf(core, workflow, "ignored", firing, why);
}

void StartRun(Engine::Core* core, const Activations::Place& place, Firing firing) {
  const cawl::DocumentPtr document = core->deployments.at(place.first).document;
  const auto flow = core->FindFlow(document, document->activator->flow.value);
  if (!flow) return;
  TermBinding variables;
  for (auto& [name, value] : firing.variables)
    variables.emplace(cawl::NameIn(core->deployments.at(place.first).names, name), std::move(value));
  const RunId run = core->Start(flow->first, flow->second, std::move(variables), firing.cause, nullptr);
  core->activations.Started(place, run);
  core->touched.insert(run);  // also where it has ended already
}

std::string ListOf(const std::vector<RunId>& runs) {
  return absl::StrJoin(runs, ", ",
                       [](std::string* out, const RunId& run) { absl::StrAppend(out, run.value()); });
}

// As the mode says, now that the workflow may start runs.
void Fire(Engine::Core* core, const Activations::Place& place, Firing firing) {
  const std::string& workflow = place.first;
  const cawl::Activator& activator = *core->deployments.at(workflow).document->activator;
  const Activations::Key* known = core->activations.Find(place);
  const size_t waiting = known == nullptr ? 0 : known->waiting.size();
  std::vector<RunId> live;  // without those that have ended in this turn
  // there may be very many of one key
  const bool counts = activator.mode != Mode::kParallel || activator.max;
  if (known != nullptr && counts) {
    std::copy_if(known->live.begin(), known->live.end(), std::back_inserter(live),
                 [core](const RunId& run) { return core->runs.at(run).state == WorkState::kRunning; });
  }
  switch (activator.mode) {
    case Mode::kSingle:
      if (live.empty()) break;
      return Ignore(
          core, workflow, firing,
          absl::StrCat("ignored: ", ListOf(live), " of the same key is live (ext:mode=\"single\")"));
    case Mode::kQueued: {
      if (live.empty() && waiting == 0) break;
      if (activator.max && waiting >= static_cast<size_t>(*activator.max)) {
        return Ignore(core, workflow, firing,
                      absl::StrCat("ignored: ", waiting, " of the same key wait (ext:max)"));
      }
      if (core->activations.Waiting(workflow) >= kWorkflowLimits.firings_waiting) {
        return Ignore(
            core, workflow, firing,
            absl::StrCat("ignored: the limit firings_waiting is ", kWorkflowLimits.firings_waiting));
      }
      SayOf(core, workflow, "queued", firing,
            absl::StrCat("it waits for ", live.empty() ? "those before it" : ListOf(live)));
      core->activations.Wait(place, std::move(firing));
      return;
    }
    case Mode::kRestart:
      for (const RunId& run : live) {
        core->Cancel(run,
                     absl::StrCat("activator ", activator.name.value, " fired again (ext:mode=\"restart\")"));
        core->activations.Ended(run);
      }
      break;
    case Mode::kParallel:
      if (!activator.max || live.size() < static_cast<size_t>(*activator.max)) break;
      return Ignore(core, workflow, firing,
                    absl::StrCat("ignored: ", live.size(), " runs of the same key are live (ext:max)"));
  }
  const auto flow = core->FindFlow(core->deployments.at(workflow).document, activator.flow.value);
  const size_t nodes = flow ? flow->first->flows[flow->second].nodes.size() : 0;
  if (const std::string full = core->WhyNoRoom(nodes); !full.empty()) {
    core->activations.Ignored(workflow);
    return core->bounds.NotStarted(workflow, place.second, full, false);
  }
  core->bounds.Started(workflow);
  StartRun(core, place, std::move(firing));
}

// The firing of a binding that the condition has now; nullopt: the turn has no room for it, and says so.
std::optional<Firing> FiringOf(Engine::Core* core, const std::string& workflow, ConditionHandle handle,
                               const TermBinding& binding) {
  const std::string why = core->bounds.WhyNotFire(workflow, core->limits.engine_rounds_per_turn);
  if (!why.empty()) {
    core->activations.Ignored(workflow);
    core->bounds.NotStarted(workflow, KeyText(binding), why, true);
    return std::nullopt;
  }
  core->bounds.Fired();
  const cawl::DocumentPtr document = core->deployments.at(workflow).document;
  Firing firing{binding, ""};
  auto solutions = core->input->conditions->Solutions(handle, binding, 1);
  if (solutions.ok() && !solutions->empty())
    firing.variables.insert(solutions->front().begin(), solutions->front().end());
  std::string evidence = core->input->conditions->Evidence(handle, firing.variables);
  std::replace(evidence.begin(), evidence.end(), '\n', ' ');
  firing.cause = absl::StrCat("activator ", document->activator->name.value, ": ", evidence);
  return firing;
}

Activations::Place PlaceOf(const std::string& workflow, TermBinding binding) {
  std::erase_if(binding,
                [](const auto& value) { return value.first.starts_with("_"); });  // without the events
  return {workflow, KeyText(binding)};
}

void FireFor(Engine::Core* core, const std::string& workflow, ConditionHandle handle,
             const TermBinding& binding) {
  if (std::optional<Firing> firing = FiringOf(core, workflow, handle, binding))
    Fire(core, PlaceOf(workflow, binding), *std::move(firing));
}

// A time that occurs is told of once it is over, as one that was missed; what it says of that stands in its name.
bool IsOccurrence(const cawl::CompiledAsk& ask) {
  return absl::StrContains(ask.ask, ":occurs ?_");
}
bool LeavesOutMissed(const cawl::CompiledAsk& ask) {
  return absl::StrContains(ask.ask, ";missed=skip");
}

// Why a firing of a paused workflow does not wait for the resume; empty: it does. `live`: a run of the key is live.
std::string WhyNotKept(const Engine::Core& core, const cawl::CompiledAsk& ask,
                       const Activations::Place& place, bool live) {
  const cawl::Activator& activator = *core.deployments.at(place.first).document->activator;
  const Activations::Key* known = core.activations.Find(place);
  const size_t waiting = known == nullptr ? 0 : known->waiting.size();
  if (IsOccurrence(ask) && LeavesOutMissed(ask)) return "missed=\"skip\"";
  if (activator.mode == Mode::kSingle && (live || waiting > 0)) {
    return live ? "a run of the same key is live (ext:mode=\"single\")"
                : "another of the same key waits (ext:mode=\"single\")";
  }
  if (activator.mode == Mode::kQueued && activator.max && waiting >= static_cast<size_t>(*activator.max))
    return absl::StrCat(waiting, " of the same key wait (ext:max)");
  if (core.activations.Waiting(place.first) >= kWorkflowLimits.firings_waiting)
    return absl::StrCat("the limit firings_waiting is ", kWorkflowLimits.firings_waiting);
  return "";
}

// An event fired while the workflow starts no run. It is over at once: it waits here, or is ignored.
void FireLater(Engine::Core* core, const std::string& workflow, const ArmedCondition& by,
               const TermBinding& binding) {
  std::optional<Firing> firing = FiringOf(core, workflow, by.handle, binding);
  if (!firing) return;
  const Deployment& deployment = core->deployments.at(workflow);
  if (deployment.disabled) return Ignore(core, workflow, *firing, "ignored: the workflow is disabled");
  const Activations::Place place = PlaceOf(workflow, binding);
  const Activations::Key* known = core->activations.Find(place);
  const bool live = known != nullptr && !known->live.empty();
  const bool newest = deployment.document->activator->mode == Mode::kRestart || IsOccurrence(by.ask);
  const bool replaces = newest && known != nullptr && !known->waiting.empty() && !LeavesOutMissed(by.ask);
  if (replaces) {  // `known` may be gone afterwards
    Ignore(core, workflow, core->activations.Next(place),
           "ignored: the workflow is paused, and a later one of the same key waits for the resume");
  }
  if (const std::string why = WhyNotKept(*core, by.ask, place, live); !why.empty())
    return Ignore(core, workflow, *firing, absl::StrCat("ignored: the workflow is paused, and ", why));
  SayOf(core, workflow, "queued", *firing, "the workflow is paused: it waits for the resume");
  core->activations.Wait(place, *std::move(firing));
}

bool MayStart(const Engine::Core& core, const std::string& workflow) {
  const auto deployed = core.deployments.find(workflow);
  return deployed != core.deployments.end() && deployed->second.document->activator &&
         !deployed->second.disabled && !core.paused_workflows.contains(workflow);
}

void StartNext(Engine::Core* core, const Activations::Place& place) {
  const Activations::Key* key = core->activations.Find(place);
  if (key == nullptr || !key->live.empty() || key->waiting.empty() || !MayStart(*core, place.first)) return;
  StartRun(core, place, core->activations.Next(place));
}

}  // namespace

void Activate(Engine::Core* core, const std::string& workflow, const ConditionEdge& edge) {
  const bool holds_back = !MayStart(*core, workflow);
  Deployment& deployment = holds_back ? core->MutableDeployment(workflow) : core->deployments.at(workflow);
  const ArmedCondition* by = nullptr;  // if it needs an event
  for (const ArmedCondition& armed : deployment.armed) {
    if (armed.handle == edge.handle && armed.ask.by_event()) by = &armed;
  }
  // a condition without free variables has one binding, the empty one
  std::vector<TermBinding> appeared = edge.appeared, disappeared = edge.disappeared;
  if (edge.rose && appeared.empty()) appeared.emplace_back();
  if (edge.fell && disappeared.empty()) disappeared.emplace_back();
  for (const TermBinding& key : disappeared) {
    const std::string text = KeyText(key);
    if (core->AddActive(workflow, text, -1) <= 1) deployment.held_back.erase(text);
  }
  for (const TermBinding& key : appeared) {
    const std::string text = KeyText(key);
    if (core->AddActive(workflow, text, 1) > 0 || deployment.carried.erase(text) > 0) continue;
    if (holds_back && by != nullptr)
      FireLater(core, workflow, *by, key);
    else if (holds_back)
      deployment.held_back[text] = {edge.handle, key};
    else
      FireFor(core, workflow, edge.handle, key);
  }
}

void ActivatedRunEnded(Engine::Core* core, const RunId& run) {
  if (const auto place = core->activations.Ended(run)) StartNext(core, *place);
}

void StartHeldBack(Engine::Core* core, const std::string& workflow) {
  if (!MayStart(*core, workflow)) return;
  if (!core->deployments.at(workflow).held_back.empty()) {
    const auto held_back = std::exchange(core->MutableDeployment(workflow).held_back, {});
    for (const auto& [text, start] : held_back) FireFor(core, workflow, start.handle, start.key);
  }
  const bool one_by_one = core->deployments.at(workflow).document->activator->mode == Mode::kQueued;
  for (const std::string& key : core->activations.KeysOf(workflow)) {
    const Activations::Place place(workflow, key);
    if (one_by_one) {
      StartNext(core, place);
      continue;
    }
    const Activations::Key* known = core->activations.Find(place);
    for (size_t left = known == nullptr ? 0 : known->waiting.size(); left > 0; --left)
      Fire(core, place, core->activations.Next(place));
  }
}

}  // namespace docent::engine
