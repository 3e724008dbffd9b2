#include "workflow/engine/run_steering.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/run_values.h"
#include "workflow/engine/start_values.h"
#include "workflow/engine/state/flow_graph.h"

namespace docent::engine {
namespace {

using Kind = RunRequest::Kind;

// The runs of a tree, outer ones before those that are nested in them.
std::vector<RunId> ByAge(const Engine::Core& core, const RunId& root) {
  std::map<uint64_t, RunId> ordered;
  if (const auto tree = core.trees.find(root); tree != core.trees.end()) {
    for (const RunId& id : tree->second) ordered.emplace(core.runs.at(id).number, id);
  }
  std::vector<RunId> runs;
  for (auto& [number, id] : ordered) runs.push_back(std::move(id));
  return runs;
}

bool IsNestedIn(const Engine::Core& core, const RunId& id, const RunId& outer) {
  for (auto run = core.runs.find(id); run != core.runs.end(); run = core.runs.find(run->second.parent)) {
    if (run->first == outer) return true;
  }
  return false;
}

void MoveOn(std::optional<TimeMicros>* deadline, TimeMicros by_us) {
  if (*deadline) **deadline += by_us;
}

// Its times of waiting go on from where they stood.
void Thaw(Run* run, TimeMicros now_us) {
  const TimeMicros since_us = std::exchange(run->paused_since_us, 0);
  for (NodeState& node : run->nodes) {
    if (!IsLive(node.state)) continue;
    MoveOn(&node.deadline_us, now_us - std::max(since_us, node.since_us));
    for (InvocationState& invocation : node.invocations) {
      if (IsFinal(invocation.state)) continue;
      MoveOn(&invocation.deadline_us, now_us - since_us);
      MoveOn(&invocation.not_before_us, now_us - since_us);
    }
  }
}

// Brings the runs of a tree in line with the pauses that were asked for.
void RefreshPauses(Engine::Core* core, const RunId& root) {
  for (const RunId& id : ByAge(*core, root)) {
    const Run& run = core->runs.at(id);
    const auto outer = core->runs.find(run.parent);
    const bool with_outer = outer != core->runs.end() && outer->second.paused();
    const bool paused = run.pause || with_outer;
    if (run.state != WorkState::kRunning || paused == run.paused()) continue;
    Run* changing = core->Mutable(id);
    if (paused) {
      changing->paused_since_us = core->input->now_us;
      core->Say(id.value(), "running", "paused",
                run.pause ? *run.pause : absl::StrCat("with ", run.parent.value()));
      RunStepper(core, changing).RecallCommands(Stopped::kByPause, nullptr);
    } else {
      Thaw(changing, core->input->now_us);
      core->Say(id.value(), "paused", "running", "resumed");
    }
    core->touched.insert(id);
  }
}

void StopCommandsOf(Engine::Core* core, const RunId& outer) {
  for (const RunId& id : ByAge(*core, core->RootOf(core->runs.at(outer)))) {
    if (IsNestedIn(*core, id, outer))
      RunStepper(core, core->Mutable(id)).StopCommands(Stopped::kByPause, nullptr);
  }
}

void Pause(Engine::Core* core, const RunId& id, const RunRequest& request) {
  Run* run = core->Mutable(id);
  if (run == nullptr || run->state != WorkState::kRunning) return;
  if (!run->pause) {
    run->pause = request.reason;
    core->output->steered.push_back(id);
    RefreshPauses(core, core->RootOf(*run));
  }
  if (request.cancels_commands) StopCommandsOf(core, id);
}

// A run that is to undo what it did goes on with that, also where it was paused.
void Cancel(Engine::Core* core, const RunId& id, const RunRequest& request) {
  const std::string reason =
      absl::StrCat("cancelled on request", request.reason.empty() ? "" : ": ", request.reason);
  Run* run = core->Mutable(id);
  if (run == nullptr) return;
  if (!request.compensates) return core->Cancel(id, reason);
  RunStepper(core, run).EndAndUndo(WorkState::kCancelled, reason);
  run->pause.reset();
  RefreshPauses(core, core->RootOf(*run));
}

void Resume(Engine::Core* core, const RunId& id) {
  Run* run = core->Mutable(id);
  if (run == nullptr || !run->pause) return;
  run->pause.reset();
  core->output->steered.push_back(id);
  RefreshPauses(core, core->RootOf(*run));
}

std::vector<RunId> RunsOf(const Engine::Core& core, const std::string& workflow) {
  std::map<uint64_t, RunId> ordered;
  for (const auto& [id, run] : core.runs) {
    if (run.document->name.value == workflow && run.state == WorkState::kRunning)
      ordered.emplace(run.number, id);
  }
  std::vector<RunId> runs;
  for (auto& [number, id] : ordered) runs.push_back(std::move(id));
  return runs;
}

std::map<std::string, PausedWorkflow>& MutablePauses(Engine::Core* core) {
  if (!core->undo_paused_workflows) core->undo_paused_workflows = core->paused_workflows;
  return core->paused_workflows;
}

void PauseWorkflow(Engine::Core* core, const RunRequest& request) {
  const std::string& name = request.target;
  if (core->deployments.contains(name) && !core->paused_workflows.contains(name)) {
    const PausedWorkflow& pause = MutablePauses(core)[name] = {core->input->now_us, request.reason};
    for (const Quad& fact : PausedWorkflowFacts(name, pause, &core->run_terms))
      core->output->add.push_back(fact);
  }
  for (const RunId& id : RunsOf(*core, name)) {
    const Run& run = core->runs.at(id);
    const auto outer = core->runs.find(run.parent);
    const bool with_outer = outer != core->runs.end() && outer->second.document->name.value == name;
    if (!with_outer) Pause(core, id, request);
  }
}

void ResumeWorkflow(Engine::Core* core, const std::string& name) {
  if (const auto pause = core->paused_workflows.find(name); pause != core->paused_workflows.end()) {
    for (const Quad& fact : PausedWorkflowFacts(name, pause->second, &core->run_terms))
      core->output->remove.push_back(fact);
    MutablePauses(core).erase(name);
  }
  for (const RunId& id : RunsOf(*core, name)) Resume(core, id);
  StartHeldBack(core, name);
  for (const auto& [id, run] : core->runs) {
    for (const NodeState& node : run.nodes) {
      const bool waits = std::any_of(
          node.invocations.begin(), node.invocations.end(), [](const InvocationState& invocation) {
            return invocation.state == WorkState::kPending && invocation.reason == kWorkflowPaused;
          });
      if (waits) core->touched.insert(id);
    }
  }
}

// What an operator can do about a node that runs.
constexpr char kEndRunning[] =
    ". To end what it does: docent runs cancel RUN; or docent robots out ROBOT --cancel-commands, after "
    "which another robot does it where its invoke has an ext:retry left. With ext:timeout, ext:retry and "
    "ext:retry-other-robot it goes to another robot by itself";

// Whether the robot that a node is to use offers what the node invokes.
absl::Status CheckRobot(const Engine::Core& core, const cawl::Node& node, const RunRequest& request,
                        const RobotDirectory& robots) {
  for (const cawl::Invoke& invoke : node.invokes) {
    if (invoke.operation.value.empty()) continue;
    const rsel::PlanPtr plan = core.PlanOf(invoke.operation.value);
    for (const rsel::PlanStep& step : plan->steps) {
      const std::vector<RobotOffer>& offers = robots.Offers(step.operation);
      const bool is_one = std::any_of(offers.begin(), offers.end(), [&](const RobotOffer& offer) {
        return offer.robot.value() == request.robot;
      });
      if (is_one) continue;
      const auto capability = CapabilityOf(step.operation);
      return absl::FailedPreconditionError(absl::StrCat(
          ToDisplay(Term::Iri(request.robot)), " does not offer ",
          capability ? absl::StrCat("an operation of class ", ToAbsl(step.operation)) : step.operation,
          ", which node ", request.node, " needs; docent robots lists what robots offer"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckNode(const Engine::Core& core, const Run& run, const RunRequest& request,
                       const RobotDirectory* robots) {
  const cawl::Flow& flow = run.Flow();
  const size_t index = NodeIndex(flow, request.node);
  if (index == flow.nodes.size()) {
    std::vector<std::string> names;
    for (const cawl::Node& node : flow.nodes) names.push_back(node.name.value);
    const std::string near = Nearest(request.node, names);
    return absl::NotFoundError(absl::StrCat("run ", run.id.value(), " has no node \"", request.node, "\"",
                                            near.empty() ? "" : absl::StrCat("; did you mean ", near, "?")));
  }
  if (!request.robot.empty() && robots != nullptr) {
    if (absl::Status status = CheckRobot(core, flow.nodes[index], request, *robots); !status.ok())
      return status;
  }
  if (const WorkState state = run.nodes[index].state; !MaySettle(run.nodes[index])) {
    return absl::FailedPreconditionError(absl::StrCat("node ", request.node, " of run ", run.id.value(),
                                                      " has no incident; it is ", ToAbsl(ToString(state)),
                                                      state == WorkState::kRunning ? kEndRunning : ""));
  }
  for (const auto& [name, value] : request.arguments) {
    if (absl::Status status = CheckValue(run, name, value); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckSteering(const Engine::Core& core, const RunRequest& request,
                           const RobotDirectory* robots) {
  switch (request.kind) {
    case Kind::kStart:
    case Kind::kInvokeService:
    case Kind::kCancelCommands:
      return absl::OkStatus();
    case Kind::kPauseWorkflow:
    case Kind::kResumeWorkflow:
      if (core.deployments.contains(request.target) || !RunsOf(core, request.target).empty())
        return absl::OkStatus();
      return absl::NotFoundError(
          absl::StrCat("no workflow \"", request.target, "\" is deployed, and no run of it is live"));
    default:
      break;
  }
  const auto found = core.runs.find(RunId(request.target));
  if (found == core.runs.end())
    return absl::NotFoundError(absl::StrCat("no live run \"", request.target, "\""));
  const Run& run = found->second;
  switch (request.kind) {
    case Kind::kResume:
      if (run.pause || !run.paused()) return absl::OkStatus();
      return absl::FailedPreconditionError(absl::StrCat("run ", request.target, " is paused with run ",
                                                        run.parent.value(),
                                                        ", in which it is nested; resume that"));
    case Kind::kRetryNode:
    case Kind::kSkipNode:
    case Kind::kFailNode:
      return CheckNode(core, run, request, robots);
    case Kind::kSetVariable:
      for (const auto& [name, value] : request.arguments) {
        if (absl::Status status = CheckValue(run, name, value); !status.ok()) return status;
      }
      return absl::OkStatus();
    default:
      return absl::OkStatus();
  }
}

absl::Status Engine::CheckRequest(const RunRequest& request, const RobotDirectory* robots) const {
  const bool starts =
      request.kind == RunRequest::Kind::kStart || request.kind == RunRequest::Kind::kInvokeService;
  if (starts) {
    const auto flow = core_->FindFlow(nullptr, request.target);
    const bool of_workflow = request.kind == RunRequest::Kind::kStart && flow;
    const std::string full =
        core_->WhyNoRoom(of_workflow ? flow->first->flows[flow->second].nodes.size() : 1);
    if (!full.empty()) return OverloadError(full);
  }
  switch (request.kind) {
    case RunRequest::Kind::kStart: {
      const auto flow = core_->FindFlow(nullptr, request.target);
      if (!flow) return absl::NotFoundError(absl::StrCat("no workflow \"", request.target, "\" is deployed"));
      if (!IsEnabled(flow->first->name.value)) {
        return absl::FailedPreconditionError(
            absl::StrCat("workflow ", flow->first->name.value,
                         " is disabled; `docent workflows enable` lets it start runs"));
      }
      if (const std::string fault =
              TypeFault({*flow->first, flow->first->flows[flow->second]},
                        TermBinding(request.arguments.begin(), request.arguments.end()));
          !fault.empty())
        return absl::InvalidArgumentError(fault);
      if (robots != nullptr) {
        const cawl::Flow& asked = flow->first->flows[flow->second];
        const std::vector<std::string> needed =
            NeededWithoutValue(*core_, *flow->first, asked,
                               TermBinding(request.arguments.begin(), request.arguments.end()), *robots);
        if (!needed.empty()) {
          return absl::InvalidArgumentError(absl::StrCat(NeedsText(asked, needed), "; docent run ",
                                                         request.target, " --var ", needed.front(),
                                                         "=… gives one"));
        }
      }
      if (!core_->IsPaused(*flow->first)) return absl::OkStatus();
      return absl::FailedPreconditionError(absl::StrCat("workflow ", flow->first->name.value,
                                                        " is paused; it starts no run until it is resumed"));
    }
    case RunRequest::Kind::kInvokeService: {
      rsel::PlanPtr plan = core_->services.Find(request.target);
      if (plan == nullptr) return core_->services.NotRegistered(request.target);
      return rsel::InstructionHandler::Start(
                 plan, rsel::Arguments(request.arguments.begin(), request.arguments.end()))
          .status();
    }
    default:
      return CheckSteering(*core_, request, robots);
  }
}

void Steer(Engine::Core* core, const RunRequest& request) {
  if (request.kind == Kind::kPauseWorkflow) return PauseWorkflow(core, request);
  if (request.kind == Kind::kResumeWorkflow) return ResumeWorkflow(core, request.target);
  if (request.kind == Kind::kCancelCommands) {
    const RobotId robot(request.target);
    std::vector<RunId> with_robot;
    for (const auto& [id, run] : core->runs) {
      if (run.robots.contains(robot)) with_robot.push_back(id);
    }
    for (const RunId& id : with_robot)
      RunStepper(core, core->Mutable(id)).StopCommands(Stopped::kWithRobot, &robot);
    return;
  }
  const RunId id(request.target);
  if (request.kind == Kind::kCancel) return Cancel(core, id, request);
  if (request.kind == Kind::kPause) return Pause(core, id, request);
  if (request.kind == Kind::kResume) return Resume(core, id);
  Run* run = core->Mutable(id);
  if (run == nullptr || run->state != WorkState::kRunning) return;
  const size_t node = NodeIndex(run->Flow(), request.node);
  RunStepper stepper(core, run);
  if (request.kind == Kind::kSetVariable) {
    for (const auto& [name, value] : request.arguments) stepper.SetVariable(name, value);
  } else if (node == run->nodes.size()) {
    return;
  } else if (request.kind == Kind::kRetryNode) {
    stepper.RetryNode(node, RobotId(request.robot), request.reason);
  } else if (request.kind == Kind::kSkipNode) {
    stepper.SkipNode(node, TermBinding(request.arguments.begin(), request.arguments.end()), request.reason);
  } else if (request.kind == Kind::kFailNode) {
    stepper.FailNode(node, request.reason);
  }
  core->touched.insert(id);
}

std::vector<Quad> PausedWorkflowFacts(const std::string& workflow, const PausedWorkflow& pause,
                                      RunTerms* terms) {
  Dictionary& dictionary = terms->dictionary();
  const TermId subject = dictionary.InternIri(WorkflowIri(workflow)), graph = terms->Of(RunTerm::kRunsGraph);
  std::vector<Quad> facts = {
      {subject, terms->Of(RunTerm::kPausedAt), dictionary.Intern(DateTimeTerm(pause.since_us)), graph}};
  if (!pause.reason.empty()) {
    facts.push_back(
        {subject, terms->Of(RunTerm::kPauseReason), dictionary.Intern(Term::Literal(pause.reason)), graph});
  }
  return facts;
}

}  // namespace docent::engine
