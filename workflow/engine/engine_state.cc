#include "workflow/engine/engine_state.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/term_archive.h"
#include "workflow/cawl/parser.h"
#include "workflow/engine/packed_state.h"
#include "workflow/engine/robot_facts.h"
#include "workflow/engine/run_facts.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

// A state of format 4 as this version would have it.
void Complete(Packed* packed) {
  std::map<RunId, Run*> runs;
  for (PackedRun& run : packed->runs) runs.emplace(run.run.id, &run.run);
  for (PackedRun& run : packed->runs) {
    for (auto outer = runs.find(run.run.parent); outer != runs.end();
         outer = runs.find(outer->second->parent))
      outer->second->robots.insert(run.run.robots.begin(), run.run.robots.end());
    for (PackedNode& node : run.nodes) {
      for (PackedInvocation& invocation : node.invocations) {
        InvocationState& s = invocation.state;
        s.sent = s.attempt > 1 || s.state != WorkState::kPending;
        s.queued = s.state == WorkState::kPending;
      }
    }
  }
}

// A state of format 5 likewise: conditions know which events they need together.
void CompleteEvents(Packed* packed) {
  for (PackedRun& run : packed->runs) {
    for (PackedNode& node : run.nodes) {
      for (ArmedCondition& armed : node.state.armed) armed.ask.joint_events = cawl::JointEventsOf(armed.ask);
    }
  }
  for (auto& [name, deployment] : packed->deployments) {
    for (ArmedCondition& armed : deployment.armed) armed.ask.joint_events = cawl::JointEventsOf(armed.ask);
  }
}

// Gives each distinct object a number in order of first use.
template <class T>
class Numbers {
 public:
  uint64_t Of(const std::shared_ptr<const T>& object) {
    const auto [it, fresh] = numbers_.try_emplace(object.get(), objects_.size());
    if (fresh) objects_.push_back(object);
    return it->second;
  }
  const std::vector<std::shared_ptr<const T>>& objects() const { return objects_; }

 private:
  std::map<const T*, uint64_t> numbers_;
  std::vector<std::shared_ptr<const T>> objects_;
};

std::vector<PackedInvocation> Pack(std::vector<InvocationState> invocations, Numbers<rsel::Plan>* plans) {
  std::vector<PackedInvocation> packed;
  for (InvocationState& invocation : invocations) {
    PackedInvocation& into = packed.emplace_back();
    if (invocation.handler) {
      into.handler.emplace(plans->Of(invocation.handler->shared_plan()), invocation.handler->Save());
    }
    into.state = std::move(invocation);
  }
  return packed;
}

// nullopt for a run in the middle of a turn.
std::optional<PackedRun> Pack(const Run& run, Numbers<cawl::Document>* documents,
                              Numbers<rsel::Plan>* plans) {
  PackedRun packed;
  packed.run = run;
  packed.document = documents->Of(run.document);
  for (NodeState& node : packed.run.nodes) {
    if (!node.pending_links.empty()) return std::nullopt;
    PackedNode& to = packed.nodes.emplace_back();
    to.invocations = Pack(std::move(node.invocations), plans);
    node.invocations.clear();
    to.state = std::move(node);
  }
  for (LateStep& step : packed.run.late_steps) {
    PackedLateStep& to = packed.late_steps.emplace_back();
    to.document = documents->Of(step.document);
    to.invocations = Pack(std::move(step.invocations), plans);
    step.invocations.clear();
    to.step = std::move(step);
  }
  packed.run.late_steps.clear();
  return packed;
}

absl::StatusOr<cawl::DocumentPtr> Parse(const DocumentText& text, const Limits& limits) {
  if (!text.service.empty()) return ServiceWorkflow(text.service);
  cawl::ParsedCawl parsed = cawl::ParseCawl(text.text, text.file, limits);
  if (parsed.ok()) return parsed.document;
  return absl::InternalError(
      absl::StrCat("the workflow document ", text.file,
                   " that a snapshot holds is refused: ", ToStatus(parsed.diagnostics, text.text).message()));
}

absl::Status Damaged() {
  return absl::DataLossError("the workflow engine's state in the snapshot does not decode");
}

// What the packed numbers stand for.
struct Shared {
  std::vector<cawl::DocumentPtr> documents;
  std::vector<rsel::PlanPtr> plans;
};

// False: it does not fit its document.
bool FitsDocument(const Run& run) {
  if (run.flow >= run.document->flows.size()) return false;
  const cawl::Flow& flow = run.Flow();
  if (run.nodes.size() != flow.nodes.size()) return false;
  for (size_t n = 0; n < run.nodes.size(); ++n) {
    for (const InvocationState& invocation : run.nodes[n].invocations) {
      if (invocation.invoke >= flow.nodes[n].invokes.size()) return false;
    }
    for (const size_t next : run.nodes[n].actions.next) {
      if (next > flow.nodes[n].actions.size()) return false;
    }
  }
  return true;
}

bool FitsDocument(const LateStep& step) {
  if (step.flow >= step.document->flows.size()) return false;
  const cawl::Flow& flow = step.document->flows[step.flow];
  return step.node < flow.nodes.size() && !step.invocations.empty() &&
         std::all_of(step.invocations.begin(), step.invocations.end(),
                     [&](const InvocationState& invocation) {
                       return invocation.invoke < flow.nodes[step.node].invokes.size();
                     });
}

// False: they do not fit their plans.
bool Unpack(std::vector<PackedInvocation> packed, const Shared& shared, std::vector<InvocationState>* to) {
  for (PackedInvocation& invocation : packed) {
    InvocationState& into = to->emplace_back(std::move(invocation.state));
    if (!invocation.handler) continue;
    auto& [plan, saved] = *invocation.handler;
    if (plan >= shared.plans.size()) return false;
    auto handler = rsel::InstructionHandler::Restore(shared.plans[plan], std::move(saved));
    if (!handler.ok()) return false;
    into.handler = *std::move(handler);
  }
  return true;
}

absl::StatusOr<Run> Unpack(PackedRun packed, const Shared& shared, RunTerms* terms) {
  Run run = std::move(packed.run);
  if (packed.document >= shared.documents.size()) return Damaged();
  run.document = shared.documents[packed.document];
  for (PackedNode& node : packed.nodes) {
    NodeState& to = run.nodes.emplace_back(std::move(node.state));
    if (!Unpack(std::move(node.invocations), shared, &to.invocations)) return Damaged();
  }
  for (PackedLateStep& late : packed.late_steps) {
    LateStep& to = run.late_steps.emplace_back(std::move(late.step));
    if (late.document >= shared.documents.size()) return Damaged();
    to.document = shared.documents[late.document];
    if (!Unpack(std::move(late.invocations), shared, &to.invocations) || !FitsDocument(to)) return Damaged();
  }
  if (!FitsDocument(run)) return Damaged();
  run.facts = std::make_shared<const std::vector<Quad>>(RunFacts(run, terms));
  return run;
}

absl::StatusOr<rsel::ServiceRegistry> RestoreServices(const Packed& packed, const Limits& limits) {
  std::vector<rsel::DocumentPtr> documents;
  for (const auto& [file, text] : packed.services) {
    rsel::ParsedRsel parsed = rsel::ParseRsel(text, file, limits);
    if (!parsed.ok()) {
      return absl::InternalError(
          absl::StrCat("the robot service document ", file,
                       " that a snapshot holds is refused: ", ToStatus(parsed.diagnostics, text).message()));
    }
    documents.push_back(std::move(parsed.document));
  }
  return rsel::ServiceRegistry::Restore(documents, packed.services_version);
}

}  // namespace

absl::StatusOr<std::string> EncodeEngineState(const EngineState& state) {
  Packed packed;
  Numbers<cawl::Document> documents;
  Numbers<rsel::Plan> plans;
  for (const auto& [id, run] : state.runs) {
    std::optional<PackedRun> one = Pack(run, &documents, &plans);
    if (!one) return absl::InternalError(absl::StrCat("run ", id.value(), " is in the middle of a turn"));
    packed.runs.push_back(*std::move(one));
  }
  for (const auto& [name, deployment] : state.deployments) {
    packed.deployments[name] = {documents.Of(deployment.document),
                                deployment.armed,
                                deployment.active,
                                deployment.held_back,
                                deployment.disabled,
                                deployment.names};
  }
  for (const cawl::DocumentPtr& document : documents.objects()) {
    const std::string service = ServiceOf(*document);
    packed.documents.push_back({document->file, document->source, service});
  }
  for (const rsel::PlanPtr& plan : plans.objects()) packed.plans.push_back(*plan);
  for (const KeptRun& run : state.kept) packed.kept.push_back(run.id);
  for (const rsel::DocumentPtr& document : state.services.Documents()) {
    packed.services.emplace_back(document->file, document->source);
  }
  packed.services_version = state.services.version();
  for (const auto& [id, ending] : state.ending) packed.ending.push_back(ending);
  packed.joint_events = state.joint_events;
  packed.activations = state.activations;
  for (const auto& [id, open] : state.outbox) packed.outbox.push_back(open);
  packed.paused_workflows = state.paused_workflows;
  packed.last_used = state.last_used;
  packed.next_handle = state.next_handle;
  packed.next_run = state.next_run;
  ByteWriter writer;
  Fields(writer, packed);
  AddedFields(writer, packed);
  AddedIn6(writer, packed);
  AddedIn7(writer, packed);
  AddedIn8(writer, packed);
  AddedIn9(writer, packed);
  writer(packed.last_used);  // since format 10
  AddedIn11(writer, packed);
  AddedIn12(writer, packed);
  AddedIn13(writer, packed);
  AddedIn14(writer, packed);
  return writer.Take();
}

absl::StatusOr<EngineState> DecodeEngineState(std::string_view bytes, const Limits& limits,
                                              Dictionary* dictionary, const RunFactsLookup& facts) {
  Packed packed;
  ByteReader reader(bytes);
  Fields(reader, packed);
  if (reader.AtEnd())
    Complete(&packed);
  else
    AddedFields(reader, packed);
  if (reader.AtEnd())
    CompleteEvents(&packed);
  else
    AddedIn6(reader, packed);
  if (!reader.AtEnd()) AddedIn7(reader, packed);
  if (!reader.AtEnd()) AddedIn8(reader, packed);
  if (!reader.AtEnd()) AddedIn9(reader, packed);
  if (!reader.AtEnd()) reader(packed.last_used);
  if (!reader.AtEnd()) AddedIn11(reader, packed);
  if (!reader.AtEnd()) AddedIn12(reader, packed);
  if (!reader.AtEnd()) AddedIn13(reader, packed);
  if (!reader.AtEnd()) AddedIn14(reader, packed);
  if (!reader.AtEnd()) return Damaged();
  EngineState state;
  Shared shared;
  for (const DocumentText& text : packed.documents) {
    auto document = Parse(text, limits);
    if (!document.ok()) return document.status();
    shared.documents.push_back(*std::move(document));
  }
  for (rsel::Plan& plan : packed.plans) {
    shared.plans.push_back(std::make_shared<const rsel::Plan>(std::move(plan)));
  }
  RunTerms terms(dictionary);
  for (PackedRun& one : packed.runs) {
    auto run = Unpack(std::move(one), shared, &terms);
    if (!run.ok()) return run.status();
    const RunId id = run->id;
    // As it was told, which an older version may have done otherwise.
    if (std::vector<Quad> told = facts(id); !told.empty()) {
      std::sort(told.begin(), told.end());
      run->facts = std::make_shared<const std::vector<Quad>>(std::move(told));
    }
    state.runs.emplace(id, *std::move(run));
  }
  for (auto& [name, one] : packed.deployments) {
    if (one.document >= shared.documents.size()) return Damaged();
    Deployment& deployment = state.deployments[name];
    deployment.document = shared.documents[one.document];
    deployment.armed = std::move(one.armed);
    deployment.active = std::move(one.active);
    deployment.held_back = std::move(one.held_back);
    deployment.disabled = one.disabled;
    deployment.names = std::move(one.names);
  }
  auto services = RestoreServices(packed, limits);
  if (!services.ok()) return services.status();
  state.services = *std::move(services);
  for (const RunId& id : packed.kept) {
    std::vector<Quad> of_run = facts(id);
    if (of_run.empty()) return Damaged();
    std::sort(of_run.begin(), of_run.end());
    state.kept.push_back({id, std::make_shared<const std::vector<Quad>>(std::move(of_run))});
  }
  for (EndingCommand& ending : packed.ending) {
    const CommandId id = ending.command.id;
    state.ending.emplace(id, std::move(ending));
  }
  state.joint_events = std::move(packed.joint_events);
  state.activations = std::move(packed.activations);
  for (OpenNotification& open : packed.outbox) {
    const CommandId id = open.notification.id;
    state.outbox.emplace(id, std::move(open));
  }
  state.paused_workflows = std::move(packed.paused_workflows);
  state.last_used = std::move(packed.last_used);
  state.next_handle = packed.next_handle;
  state.next_run = packed.next_run;
  return state;
}

std::vector<ConditionRequest> ArmedConditions(const EngineState& state) {
  std::vector<ConditionRequest> requests;
  for (const auto& [name, deployment] : state.deployments) {
    for (const ArmedCondition& armed : deployment.armed) {
      requests.push_back(
          RequestOf(armed.handle, armed.ask,
                    cawl::KeyVariables(*deployment.document->activator, armed.ask, deployment.names)));
    }
  }
  for (const auto& [id, run] : state.runs) {
    for (size_t n = 0; n < run.nodes.size(); ++n) {
      const NodeState& node = run.nodes[n];
      const cawl::Node& syntax = run.Flow().nodes[n];
      for (const ArmedCondition& armed : node.armed) {
        requests.push_back(RequestOf(armed.handle, armed.ask, NodeKeys(armed.ask, syntax.holds_condition)));
      }
      for (const std::optional<Guard>* guard : {&node.guard, &node.hold}) {
        if (!*guard || (*guard)->armed.handle == 0) continue;
        const ArmedCondition& armed = (*guard)->armed;
        const std::vector<std::string> keys =
            guard == &node.hold ? std::vector<std::string>() : NodeKeys(armed.ask, (*guard)->every);
        requests.push_back(RequestOf(armed.handle, armed.ask, keys));
      }
    }
  }
  std::sort(requests.begin(), requests.end(),
            [](const ConditionRequest& a, const ConditionRequest& b) { return a.handle < b.handle; });
  return requests;
}

EngineState Engine::Save() const {
  return {core_->runs,
          {core_->kept.begin(), core_->kept.end()},
          core_->deployments,
          core_->services,
          core_->ledger.ending(),
          core_->event_waits.joint(),
          core_->activations.state(),
          core_->outbox,
          core_->paused_workflows,
          core_->last_used,
          core_->next_handle,
          core_->next_run};
}

void Engine::Restore(EngineState state) {
  core_->times.Restore(ArmedConditions(state));
  core_->runs = std::move(state.runs);
  core_->kept.assign(state.kept.begin(), state.kept.end());
  core_->deployments = std::move(state.deployments);
  core_->services = std::move(state.services);
  core_->outbox = std::move(state.outbox);
  core_->paused_workflows = std::move(state.paused_workflows);
  core_->next_handle = state.next_handle;
  core_->next_run = state.next_run;
  core_->ledger.Restore(std::move(state.ending));
  core_->event_waits.Restore(std::move(state.joint_events));
  core_->activations.Restore(std::move(state.activations), &core_->run_terms.dictionary());
  core_->last_used = std::move(state.last_used);
  core_->RebuildDerived();
  std::set<RobotId> told;
  for (const auto& [robot, run] : core_->ledger.holders()) told.insert(robot);
  for (const auto& [robot, time] : core_->last_used) told.insert(robot);
  told.merge(core_->waiting.TakeChanged());
  for (const RobotId& robot : told)
    core_->robot_facts[robot] = std::make_shared<const std::vector<Quad>>(RobotFacts(robot, core_.get()));
  Commit();
}

std::vector<CommandUnderWay> Engine::OpenCommands() const {
  std::map<uint64_t, const Run*> by_age;
  for (const auto& [id, run] : core_->runs) by_age.emplace(run.number, &run);
  std::vector<CommandUnderWay> commands;
  for (const auto& [id, ending] : core_->ledger.ending()) commands.push_back({ending.command, true, false});
  for (const auto& [number, run] : by_age) {
    for (const NodeState& node : run->nodes) {
      for (const InvocationState& invocation : node.invocations) {
        for (const OpenCommand& open : invocation.commands)
          commands.push_back({open.command, open.IsEnding(), open.recalled != Stopped::kNo});
      }
    }
  }
  return commands;
}

}  // namespace docent::engine
