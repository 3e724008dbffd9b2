#include "workflow/engine/engine.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/docent_iris.h"
#include "workflow/cawl/symbol_table.h"
#include "workflow/engine/activator_modes.h"
#include "workflow/engine/engine_core.h"
#include "workflow/engine/robot_facts.h"
#include "workflow/engine/run_facts.h"
#include "workflow/engine/run_notifications.h"
#include "workflow/engine/run_scheduler.h"
#include "workflow/engine/run_steering.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"

namespace docent::engine {
namespace {

// Sets what has no value yet.
void Initialise(const cawl::Scope& scope, TermBinding* values) {
  for (const cawl::InitialValue& initial : cawl::InitialValues(scope)) {
    if (initial.value) {
      values->try_emplace(initial.key, *initial.value);
    } else if (const auto from = values->find(initial.copy_of); from != values->end()) {
      const Term copy = from->second;
      values->try_emplace(initial.key, copy);
    }
  }
}

// Nodes of a run that take about as long to tell the graph as a change of one does.
constexpr size_t kNodesOfAChange = 4;
// Changes of a node that take about as long as a condition that is armed.
constexpr size_t kChangesOfACondition = 8;

// What a nested run is of (NestedRun::by). Runs that undo are of no node of the flow.
std::string Named(const Run& outer, const CommandOwner& owner) {
  if (owner.node >= outer.nodes.size()) return outer.id.value();
  return absl::StrCat(outer.id.value(), "/", IriSegment(outer.Flow().nodes[owner.node].name.value), "/",
                      owner.invocation);
}

}  // namespace

ConditionRequest RequestOf(ConditionHandle handle, const cawl::CompiledAsk& ask,
                           std::vector<std::string> key_variables) {
  ConditionRequest request{handle, ask.ask, std::move(key_variables), ask.by_event(), {}, ask.query};
  for (const cawl::LastingAsk& part : ask.lasting) {
    request.lasting.push_back({part.ask, part.variables, part.at_least_ms * 1000, part.query});
  }
  return request;
}

ArmedCondition Armed(ConditionHandle handle, cawl::CompiledAsk ask) {
  ask.query.reset();
  for (cawl::LastingAsk& part : ask.lasting) part.query.reset();
  return {handle, std::move(ask), {}};
}

Run* Engine::Core::Mutable(const RunId& id) {
  auto it = runs.find(id);
  if (it == runs.end()) return nullptr;
  undo_runs.try_emplace(id, it->second);
  changed.insert(id);
  return &it->second;
}

Deployment& Engine::Core::MutableDeployment(const std::string& workflow) {
  auto it = deployments.find(workflow);
  undo_deployments.try_emplace(workflow,
                               it == deployments.end() ? std::nullopt : std::make_optional(it->second));
  return deployments[workflow];
}

int Engine::Core::AddActive(const std::string& workflow, const std::string& key, int more) {
  std::map<std::string, int>& active = deployments.at(workflow).active;
  const auto place = active.try_emplace(key, 0).first;
  const int before = place->second;
  if (!undo_deployments.contains(workflow)) undo_active.push_back({workflow, key, before});
  place->second = before + more;
  if (place->second <= 0) active.erase(place);
  return before;
}

ConditionHandle Engine::Core::Arm(const cawl::CompiledAsk& ask, std::vector<std::string> key_variables,
                                  ConditionOwner owner) {
  ConditionHandle handle = next_handle++;
  owners.emplace(handle, std::move(owner));
  event_waits.Arm(handle, ask);
  bounds.Worked(kChangesOfACondition + ask.ask.size() / kTextOfAChange);
  output->arm.push_back(RequestOf(handle, ask, std::move(key_variables)));
  return handle;
}

void Engine::Core::Keep(KeptRun run) {
  kept.push_back(std::move(run));
  ++kept_new;
  if (kept.size() <= limits.runs_kept) return;
  output->remove.insert(output->remove.end(), kept.front().facts->begin(), kept.front().facts->end());
  if (kept_new == kept.size())
    --kept_new;  // it ended in this turn, too
  else
    undo_kept.push_back(std::move(kept.front()));
  kept.pop_front();
}

void Engine::Core::Disarm(ConditionHandle handle) {
  owners.erase(handle);
  event_waits.Disarm(handle);
  // What is armed and disarmed within one Step is dropped at its end.
  if (!IsArming(handle)) output->disarm.push_back(handle);
}

bool Engine::Core::IsArming(ConditionHandle handle) const {
  const auto place = std::lower_bound(
      output->arm.begin(), output->arm.end(), handle,
      [](const ConditionRequest& request, ConditionHandle wanted) { return request.handle < wanted; });
  return place != output->arm.end() && place->handle == handle;
}

void Engine::Core::Say(std::string subject, std::string_view from, std::string_view to, std::string cause) {
  output->transitions.push_back({std::move(subject), std::string(from), std::string(to), std::move(cause)});
}

RunId Engine::Core::Start(const cawl::DocumentPtr& given, size_t given_flow, TermBinding variables,
                          const std::string& cause, const CommandOwner* parent) {
  Run run;
  run.number = TakeNumber(parent);
  cawl::DocumentPtr document = given;
  size_t flow = given_flow;
  if (played && parent == nullptr) played->Begin(run.number, &document, &flow, &variables);
  run.id = RunId(absl::StrCat(IriSegment(document->flows[flow].name.value), "-", run.number));
  run.document = document;
  run.flow = flow;
  run.started_us = input->now_us;
  run.variables = std::move(variables);
  const cawl::Scope scope(*document);
  Initialise(scope, &run.variables);
  if (document->activator && document->activator->flow.value == document->flows[flow].name.value) {
    Initialise(cawl::Scope(scope, *document->activator), &run.variables);
  }
  Initialise(cawl::Scope(scope, document->flows[flow]), &run.variables);
  run.nodes.resize(document->flows[flow].nodes.size());
  run.counted = run.nodes.size();
  nodes_live += run.counted;
  bounds.Worked(1 + run.nodes.size() / kNodesOfAChange);
  if (parent != nullptr) {
    run.parent = parent->run;
    run.parent_node = parent->node;
    run.parent_invocation = parent->invocation;
    output->nested.push_back({run.id, Named(runs.at(parent->run), *parent)});
  }
  RunId id = run.id;
  run.root = RootOf(run);
  InheritPriority(&run);
  trees[run.root].insert(id);
  if (!run.parent.empty()) nested[run.parent].insert(id);
  undo_runs.try_emplace(id, std::nullopt);
  changed.insert(id);
  Run& stored = runs.emplace(id, std::move(run)).first->second;
  RunStepper(this, &stored).Begin(cause);
  return id;
}

rsel::PlanPtr Engine::Core::PlanOf(const std::string& operation) const {
  if (rsel::PlanPtr plan = services.Find(operation)) return plan;
  return rsel::OperationPlan(operation, {});
}

void Engine::Core::Cancel(const RunId& id, const std::string& reason) {
  if (Run* run = Mutable(id)) RunStepper(this, run).End(WorkState::kCancelled, reason);
}

void Engine::Core::RebuildDerived() {
  owners.clear();
  commands.clear();
  timers.clear();
  ledger.ClearDerived();
  waiting.Clear();
  event_waits.ClearDerived();
  trees.clear();
  nested.clear();
  nodes_live = 0;
  for (const auto& [name, deployment] : deployments) {
    for (const ArmedCondition& armed : deployment.armed) {
      owners[armed.handle] = {RunId(), 0, name};
      event_waits.Arm(armed.handle, armed.ask);
    }
  }
  for (auto& [id, run] : runs) {
    run.root = RootOf(run);
    InheritPriority(&run);
    trees[run.root].insert(id);
    if (!run.parent.empty()) nested[run.parent].insert(id);
    run.counted = SizeOf(run);
    nodes_live += run.counted;
    Reblock(run);
    if (run.timer_us) timers.insert({*run.timer_us, id});
    for (const RobotId& robot : run.robots) ledger.Hold(robot, RootOf(run));
    for (size_t n = 0; n < run.nodes.size(); ++n) {
      for (const ArmedCondition& armed : run.nodes[n].armed) {
        owners[armed.handle] = {id, n, ""};
        event_waits.Arm(armed.handle, armed.ask);
        event_waits.SetHolds(armed.handle, !armed.waiting_events.empty());
      }
      for (const std::optional<Guard>* guard : {&run.nodes[n].guard, &run.nodes[n].hold}) {
        if (*guard && (*guard)->armed.handle != 0) owners[(*guard)->armed.handle] = {id, n, ""};
      }
      for (const PendingLink& link : run.nodes[n].pending_links) owners[link.handle] = {id, n, ""};
      for (size_t i = 0; i < run.nodes[n].invocations.size(); ++i) {
        const InvocationState& invocation = run.nodes[n].invocations[i];
        if (invocation.state == WorkState::kPending && invocation.queued) {
          waiting.Wait(RankOf(run), {id, n, i}, WishOf(run, {id, n, i}));
          NoteBarred({id, n, i}, invocation.reason);
        }
        if (invocation.state == WorkState::kRunning && invocation.handler) RebuildTask(run, {id, n, i});
        for (const OpenCommand& open : invocation.commands) commands[open.command.id.value()] = {id, n, i};
      }
    }
  }
  for (const auto& [id, ending] : ledger.ending()) ledger.Hold(ending.command.robot, ending.root);
}

Engine::Engine(Dictionary* dictionary, const Limits& limits)
    : core_(std::make_unique<Core>(dictionary, limits)) {}
Engine::~Engine() = default;

Diagnostics Engine::PutServices(rsel::DocumentPtr document) {
  if (!core_->undo_services) core_->undo_services = core_->services;
  core_->services_changed = true;
  return core_->services.Put(std::move(document));
}

absl::Status Engine::RemoveServices(const std::string& document, bool force) {
  if (!core_->undo_services) core_->undo_services = core_->services;
  core_->services_changed = true;
  return core_->services.Remove(document, force);
}

namespace {

// Requests and reports that this turn brings.
void TakeRequests(Engine::Core* core) {
  for (const RunRequest& request : *core->input->requests) {
    TermBinding arguments(request.arguments.begin(), request.arguments.end());
    switch (request.kind) {
      case RunRequest::Kind::kStart:
        if (auto flow = core->FindFlow(nullptr, request.target)) {
          core->output->started.push_back(
              core->Start(flow->first, flow->second, std::move(arguments), "asked for", nullptr));
        }
        break;
      case RunRequest::Kind::kInvokeService:
        core->output->started.push_back(
            core->Start(ServiceWorkflow(request.target), 0, std::move(arguments), "asked for", nullptr));
        break;
      default:
        Steer(core, request);
        break;
    }
  }
}

// The final report of a command that its run no longer waits for. What it did counts for what is undone, and for whether it may
// be done again.
void TakeEnd(Engine::Core* core, const CommandReport& report) {
  const std::optional<EndingCommand> ended = core->ledger.Ended(report.command);
  if (!ended) return;  // repeated, or of a server whose older backup was put back
  const RobotId& robot = ended->command.robot;
  core->released.insert(robot);
  core->changed_robots.insert(robot);
  const bool unknown = report.outcome == CommandReport::Outcome::kUnknown;
  std::string how = unknown ? ": how it ended is unknown" : "";
  if (report.outcome == CommandReport::Outcome::kSucceeded) how = ": it succeeded all the same";
  core->Say(ended->invocation, "ending", "ended",
            absl::StrCat(ended->command.operation, " on ", ToDisplay(Term::Iri(robot.value())), how));
  for (const auto& [run, facts] : ended->kept) core->WithdrawWhenEnded(run, facts);
  bool taken = false;
  for (const CommandOwner& owner : ended->owners) {
    Run* run = core->Mutable(owner.run);
    if (run == nullptr) continue;
    taken = taken || RunStepper(core, run).TakeLate(*ended, report);
    if (unknown && !ended->command.idempotent) RunStepper(core, run).OutcomeUnknown(owner);
    core->touched.insert(owner.run);
  }
}

void TakeReports(Engine::Core* core) {
  for (const CommandReport& report : *core->input->reports) {
    if (core->outbox.contains(report.command)) {
      if (IsFinal(report.outcome)) TakeDelivery(core, report);
      continue;
    }
    auto it = core->commands.find(report.command.value());
    if (it == core->commands.end()) {
      if (IsFinal(report.outcome)) TakeEnd(core, report);
      continue;
    }
    CommandOwner owner = it->second;
    if (Run* run = core->Mutable(owner.run)) {
      RunStepper(core, run).Report(owner, report);
      core->touched.insert(owner.run);
    }
  }
}

void TakeEdges(Engine::Core* core) {
  for (const ConditionEdge& edge : core->input->conditions->edges()) {
    auto it = core->owners.find(edge.handle);
    if (it == core->owners.end()) continue;
    if (edge.moved && !it->second.run.empty()) core->Mutable(it->second.run);
    if (edge.OnlyMoved()) continue;
    core->edges[edge.handle] = &edge;
    for (const TermBinding& match : edge.appeared) core->event_waits.Used(edge.handle, match);
    if (edge.overflowed) {
      core->output->refused.Update(core->GiveUp(edge.handle));
    } else if (it->second.run.empty()) {
      std::string workflow = it->second.workflow;
      Activate(core, workflow, edge);
    } else {
      core->touched.insert(it->second.run);
    }
  }
}

// Tells the graph what changed in runs, keeps the timers, and lets go of runs that ended.
void TellChanges(Engine::Core* core) {
  // Those that are nested in others are the first to leave the graph again.
  std::map<std::pair<bool, uint64_t>, KeptRun> ended;  // by whether a run is nested in none, and its number
  for (const RunId& id : core->changed) {
    auto it = core->runs.find(id);
    if (it == core->runs.end()) continue;
    Run& run = it->second;
    core->bounds.Worked(run.nodes.size() / kNodesOfAChange);
    core->nodes_live -= std::exchange(run.counted, SizeOf(run));
    core->nodes_live += run.counted;
    auto facts =
        std::make_shared<const std::vector<Quad>>(RunFacts(run, &core->run_terms, core->input->conditions));
    static const std::vector<Quad> kNothing;
    DiffFacts(run.facts ? *run.facts : kNothing, *facts, &core->output->add, &core->output->remove);
    run.facts = std::move(facts);
    const bool waits_for_tick = run.timer_us == kNextTick && !core->resumed.contains(id);
    if (run.timer_us) core->timers.erase({*run.timer_us, id});
    run.timer_us = run.state == WorkState::kRunning ? RunStepper(core, &run).NextDeadline() : std::nullopt;
    if (run.state == WorkState::kRunning && (waits_for_tick || core->unfinished.contains(id)))
      run.timer_us = kNextTick;
    if (run.timer_us) core->timers.insert({*run.timer_us, id});
    if (core->advanced.contains(id)) core->gone_on.insert(id);
    if (run.state == WorkState::kRunning) continue;
    ended[{run.parent.empty(), run.number}] = {id, run.facts};
    const auto tree = core->trees.find(run.root);
    tree->second.erase(id);
    if (tree->second.empty()) core->trees.erase(tree);
    if (const auto siblings = core->nested.find(run.parent); siblings != core->nested.end()) {
      siblings->second.erase(id);
      if (siblings->second.empty()) core->nested.erase(siblings);
    }
    core->nodes_live -= run.counted;
    core->runs.erase(it);
  }
  for (auto& [order, run] : ended) core->Keep(std::move(run));
  TellRobots(core);
}

// What runs wrote in earlier rounds and the graph does not have yet counts as written in this one.
void TakeUntold(Engine::Core* core) {
  core->written.clear();
  core->writing_trees.clear();
  if (core->input->untold == nullptr) return;
  std::vector<FactWrite>& writes = core->output->writes = std::move(*core->input->untold);
  for (size_t i = 0; i < writes.size(); ++i) {
    const auto run = core->runs.find(writes[i].run);
    if (run == core->runs.end()) continue;
    core->written[run->first].push_back(i);
    core->writing_trees.insert(core->RootOf(run->second));
  }
}

}  // namespace

EngineOutput Engine::Step(const EngineInput& input) {
  EngineOutput output;
  core_->input = &input;
  core_->output = &output;
  core_->edges.clear();
  core_->touched = std::move(core_->awaiting);
  core_->awaiting.clear();
  core_->changed.clear();
  core_->advanced.clear();
  core_->unfinished.clear();
  core_->resumed.clear();
  core_->ended.clear();
  core_->bounds.BeginRound();
  core_->released.clear();
  core_->coveted.clear();
  core_->preempted.clear();
  core_->changed_robots.clear();
  const bool first_round = input.requests != nullptr || input.reports != nullptr;
  core_->turn_round = first_round ? 0 : core_->turn_round + 1;
  if (first_round) core_->facts_written = 0;
  TakeUntold(core_.get());
  std::swap(output.arm, core_->deploy_arm);
  std::swap(output.disarm, core_->deploy_disarm);
  for (const RunId& run : std::exchange(core_->deploy_cancel, {})) {
    if (core_->runs.contains(run)) output.undeployed.push_back(run);
    core_->Cancel(run, "its workflow was undeployed");
  }
  std::swap(output.remove, core_->deploy_remove);
  for (const std::string& workflow : std::exchange(core_->deploy_gone, {}))
    core_->EndReservationsOf(workflow);
  if (input.requests != nullptr) TakeRequests(core_.get());
  if (input.reports != nullptr) TakeReports(core_.get());
  if (input.events != nullptr) core_->event_waits.Take(*input.events);
  const std::pair<TimeMicros, RunId> first(input.clock_tick ? kNextTick : kNextTick + 1, RunId());
  for (auto due = core_->timers.lower_bound(first); due != core_->timers.end(); ++due) {
    if (due->first > input.now_us || core_->bounds.spent()) break;
    core_->touched.insert(due->second);
  }
  TakeEdges(core_.get());
  core_->LetOwnGuardsGo();
  core_->TouchAsking();
  for (const std::string& workflow : std::exchange(core_->deploy_enabled, {}))
    StartHeldBack(core_.get(), workflow);
  if (input.robots->changed()) RecallFromOutOfService(core_.get());
  if (input.robots->changed() || core_->services_changed) ReconsiderWaiting(core_.get());
  core_->services_changed = false;
  AdvanceAll(core_.get());
  TellChanges(core_.get());
  output.refused.Update(core_->TellMissed());
  output.asks_again = !core_->asking.empty();
  std::erase_if(output.arm,
                [this](const ConditionRequest& request) { return !core_->owners.contains(request.handle); });
  std::stable_partition(output.writes.begin(), output.writes.end(),
                        [](const FactWrite& write) { return !write.run_ended; });
  core_->activations.Tell(&core_->run_terms.dictionary(), &output.add, &output.remove);
  for (const ConditionRequest& armed : output.arm) core_->times.Arm(armed);
  for (const ConditionHandle handle : output.disarm) core_->times.Disarm(handle);
  core_->times.Tell(&core_->run_terms.dictionary(), &output.add, &output.remove);
  core_->edges.clear();
  core_->input = nullptr;
  core_->output = nullptr;
  return output;
}

void Engine::Commit() {
  for (const auto& [name, before] : core_->undo_deployments) {
    // what held when the document was replaced has been told by now; whatever comes later is new
    if (auto it = core_->deployments.find(name); it != core_->deployments.end()) it->second.carried.clear();
  }
  core_->undo_runs.clear();
  core_->undo_deployments.clear();
  core_->undo_active.clear();
  core_->undo_services.reset();
  core_->undo_paused_workflows.reset();
  core_->undo_robot_facts.clear();
  core_->undo_outbox.clear();
  core_->undo_last_used.clear();
  core_->ledger.Commit();
  core_->event_waits.Commit();
  core_->activations.Commit();
  core_->times.Commit();
  core_->undo_kept.clear();
  core_->kept_new = 0;
  core_->gone_on.clear();
  core_->bounds.Clear();
  core_->committed_handle = core_->next_handle;
  core_->committed_run = core_->next_run;
}

void Engine::Rollback() {
  core_->run_terms.Forget();
  bool untouched = core_->undo_runs.empty() && core_->undo_deployments.empty() &&
                   core_->undo_active.empty() && !core_->undo_services && !core_->ledger.changed() &&
                   core_->undo_robot_facts.empty() && !core_->event_waits.changed() &&
                   !core_->activations.changed() && core_->undo_outbox.empty() &&
                   !core_->undo_paused_workflows && !core_->times.changed();
  core_->bounds.Clear();
  if (untouched) return;  // the batch was refused before it came to the engine
  for (auto& [id, before] : core_->undo_runs) {
    if (before)
      core_->runs.insert_or_assign(id, *std::move(before));
    else
      core_->runs.erase(id);
  }
  for (auto& [name, before] : core_->undo_deployments) {
    if (before)
      core_->deployments.insert_or_assign(name, *std::move(before));
    else
      core_->deployments.erase(name);
  }
  // Those of a deployment that was replaced after them are put back into what it was.
  for (auto change = core_->undo_active.rbegin(); change != core_->undo_active.rend(); ++change) {
    std::map<std::string, int>& active = core_->deployments.at(change->workflow).active;
    if (change->count == 0)
      active.erase(change->key);
    else
      active[change->key] = change->count;
  }
  if (core_->undo_services) core_->services = *std::move(core_->undo_services);
  core_->services_changed = false;  // what was refused leaves no trace: the log does not have it
  if (core_->undo_paused_workflows) core_->paused_workflows = *std::move(core_->undo_paused_workflows);
  core_->next_handle = core_->committed_handle;
  core_->next_run = core_->committed_run;
  core_->deploy_arm.clear();
  core_->deploy_disarm.clear();
  core_->deploy_enabled.clear();
  core_->deploy_cancel.clear();
  core_->deploy_remove.clear();
  core_->deploy_gone.clear();
  core_->wrote_at_open.clear();
  core_->asking.clear();
  core_->awaiting.clear();
  core_->kept.erase(core_->kept.end() - core_->kept_new, core_->kept.end());
  core_->kept.insert(core_->kept.begin(), core_->undo_kept.begin(), core_->undo_kept.end());
  for (auto& [robot, before] : core_->undo_robot_facts) {
    if (before)
      core_->robot_facts[robot] = before;
    else
      core_->robot_facts.erase(robot);
  }
  for (auto& [id, before] : core_->undo_outbox) {
    if (before)
      core_->outbox.insert_or_assign(id, *std::move(before));
    else
      core_->outbox.erase(id);
  }
  for (const auto& [robot, before] : core_->undo_last_used) {
    if (before)
      core_->last_used[robot] = *before;
    else
      core_->last_used.erase(robot);
  }
  core_->ledger.Rollback();
  core_->event_waits.Rollback();
  core_->activations.Rollback();
  core_->times.Rollback();
  core_->RebuildDerived();
  Commit();
}

std::set<Term> Engine::AwaitedEvents() const {
  std::set<Term> awaited;
  for (const auto& [handle, events] : core_->event_waits.joint())
    awaited.insert(events.begin(), events.end());
  for (const ConditionHandle handle : core_->event_waits.holders()) {
    const ConditionOwner& owner = core_->owners.at(handle);
    for (const ArmedCondition& armed : core_->runs.at(owner.run).nodes[owner.node].armed) {
      if (armed.handle != handle) continue;
      for (const TermBinding& match : armed.waiting_events) {
        for (const std::string& name : armed.ask.event_variables) {
          if (const auto event = match.find(name); event != match.end()) awaited.insert(event->second);
        }
      }
    }
  }
  return awaited;
}

bool Engine::AwaitsTick() const {
  return NextDeadline() == kNextTick;
}

std::optional<TimeMicros> Engine::NextDeadline() const {
  if (core_->timers.empty()) return std::nullopt;
  return core_->timers.begin()->first;
}

const RunId* Engine::HolderOf(const RobotId& robot) const {
  return core_->ledger.Holder(robot);
}

const rsel::ServiceRegistry& Engine::services() const {
  return core_->services;
}

std::vector<cawl::DocumentPtr> Engine::workflows() const {
  std::vector<cawl::DocumentPtr> documents;
  for (const auto& [name, deployment] : core_->deployments) documents.push_back(deployment.document);
  return documents;
}

cawl::DocumentPtr Engine::FindWorkflow(const std::string& name) const {
  auto it = core_->deployments.find(name);
  return it == core_->deployments.end() ? nullptr : it->second.document;
}

size_t Engine::live_runs() const {
  return core_->runs.size();
}

}  // namespace docent::engine
