#include "workflow/engine/engine_state.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/term_archive.h"
#include "workflow/cawl/parser.h"
#include "workflow/engine/robot_facts.h"
#include "workflow/engine/run_facts.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/service_workflow.h"
#include "workflow/rsel/parser.h"

// Fields() of each type stands in the namespace of the type, where the archive finds it.
namespace docent::cawl {
template <class Archive>
void Fields(Archive& a, LastingAsk& part) {
  a(part.ask, part.variables, part.at_least_ms);
}
template <class Archive>
void Fields(Archive& a, CompiledAsk& ask) {
  a(ask.name, ask.ask, ask.priority, ask.free_variables, ask.unset, ask.event_variables, ask.lasting);
}
}  // namespace docent::cawl

namespace docent::rsel {
template <class Archive>
void Fields(Archive& a, PlanSource& source) {
  a(source.constant, source.slot);
}
template <class Archive>
void Fields(Archive& a, PlanStep& step) {
  a(step.path, step.operation, step.service, step.inputs, step.after, step.retry, step.timeout_ms,
    step.on_failure);
}
template <class Archive>
void Fields(Archive& a, Plan& plan) {
  a(plan.process, plan.document, plan.version, plan.inputs, plan.outputs, plan.steps);
}
template <class Archive>
void Fields(Archive& a, InstructionHandler::StepStatus& status) {
  a(status.state, status.attempt, status.reported);
}
template <class Archive>
void Fields(Archive& a, InstructionHandler::Saved& saved) {
  a(saved.values, saved.steps, saved.state, saved.reason);
}
}  // namespace docent::rsel

namespace docent::engine {

template <class Archive>
void Fields(Archive& a, CommandOwner& owner) {
  a(owner.run, owner.node, owner.invocation);
}
template <class Archive>
void Fields(Archive& a, Guard& guard) {
  a(guard.armed.handle, guard.armed.ask, guard.armed.waiting_events, guard.every);
}
template <class Archive>
void Fields(Archive& a, ReplacedValue& value) {
  a(value.given, value.before);
}
template <class Archive>
void Fields(Archive& a, DoneStep& step) {
  a(step.place, step.operation, step.variables, step.done_us);
}
template <class Archive>
void Fields(Archive& a, Undoing& undoing) {
  a(undoing.outcome, undoing.reason, undoing.left, undoing.child, undoing.current, undoing.failed);
}
template <class Archive>
void Fields(Archive& a, HeldBackStart& start) {
  a(start.handle, start.key);
}
template <class Archive>
void Fields(Archive& a, PausedWorkflow& pause) {
  a(pause.since_us, pause.reason);
}

template <class Archive>
void Fields(Archive& a, Activations::Firing& firing) {
  a(firing.variables, firing.cause);
}
template <class Archive>
void Fields(Archive& a, Activations::Key& key) {
  a(key.live, key.waiting);
}
template <class Archive>
void Fields(Archive& a, Activations::State& state) {
  a(state.keys, state.ignored);
}

namespace {

// A workflow's document: its text, or the robot service of which it is the workflow.
struct DocumentText {
  std::string file;
  std::string text;
  std::string service;
};

// A run, with numbers for what several runs share.
struct PackedInvocation {
  InvocationState state;                                                        // its handler apart
  std::optional<std::pair<uint64_t, rsel::InstructionHandler::Saved>> handler;  // plan, progress
};
struct PackedNode {
  NodeState state;  // its invocations apart
  std::vector<PackedInvocation> invocations;
};
struct PackedRun {
  Run run;  // its document and nodes apart
  uint64_t document = 0;
  std::vector<PackedNode> nodes;
};
struct PackedDeployment {
  uint64_t document = 0;
  std::vector<ArmedCondition> armed;
  std::map<std::string, int> active;
  std::map<std::string, HeldBackStart> held_back;
  bool disabled = false;
};
struct Packed {
  std::vector<DocumentText> documents;
  std::vector<rsel::Plan> plans;
  std::vector<PackedRun> runs;
  std::vector<RunId> kept;
  std::map<std::string, PackedDeployment> deployments;
  std::vector<std::pair<std::string, std::string>> services;  // file, text
  uint64_t services_version = 0;
  std::vector<EndingCommand> ending;
  EventWaits::Joint joint_events;
  Activations::State activations;
  std::vector<OpenNotification> outbox;
  std::map<std::string, PausedWorkflow> paused_workflows;
  std::map<RobotId, TimeMicros> last_used;
  ConditionHandle next_handle = 1;
  uint64_t next_run = 1;
};

template <class Archive>
void Fields(Archive& a, DocumentText& document) {
  a(document.file, document.text, document.service);
}
template <class Archive>
void Fields(Archive& a, RobotCommand& command) {
  a(command.id, command.robot, command.operation, command.arguments, command.expected_incarnation,
    command.guard_revision, command.deadline_us, command.idempotent);
}
template <class Archive>
void Fields(Archive& a, OpenCommand& open) {
  Fields(a, open.command);
  a(open.step, open.attempt);
}

template <class Archive>
void Fields(Archive& a, ArmedCondition& armed) {
  a(armed.handle, armed.ask, armed.waiting_events);
}

template <class Archive>
void Fields(Archive& a, OpenNotification& open) {
  Notification& n = open.notification;
  a(n.id, n.target, n.source, n.type, n.subject, n.time_us, n.data, open.run, open.node);
}

template <class Archive>
void Fields(Archive& a, EndingCommand& ending) {
  Fields(a, ending.command);
  a(ending.occupies, ending.root, ending.invocation, ending.owners, ending.since_us);
}

// Lists of types of namespace docent whose Fields stand here, not where the archive would look.
template <class Archive, class T>
void List(Archive& a, std::vector<T>& list) {
  if constexpr (Archive::kReads) {
    list.resize(a.Count());
  } else {
    a.Varint(list.size());
  }
  for (T& value : list) Fields(a, value);
}

template <class Archive>
void Fields(Archive& a, PackedInvocation& packed) {
  InvocationState& s = packed.state;
  a(s.invoke, s.binding, s.state, s.attempt, s.retries, s.resends, s.robot);
  List(a, s.commands);
  a(s.child, s.step, s.progress, s.reason, s.deadline_us, packed.handler);
}
template <class Archive>
void Fields(Archive& a, PackedNode& packed) {
  NodeState& s = packed.state;
  a(s.state, s.iteration, s.attempt, s.since_us, s.arrived, s.dead);
  List(a, s.armed);
  a(s.busy_robots, s.deadline_us, s.waits_for, s.fired_because, s.fired_us, s.reason);
  List(a, packed.invocations);
}
template <class Archive>
void Fields(Archive& a, PackedRun& packed) {
  Run& r = packed.run;
  a(r.id, r.number, packed.document, r.flow, r.state, r.reason, r.started_us, r.ended_us, r.variables,
    r.sink_reached, r.robots, r.parent, r.parent_node, r.parent_invocation, r.timer_us);
  List(a, packed.nodes);
}
template <class Archive>
void Fields(Archive& a, PackedDeployment& packed) {
  a(packed.document);
  List(a, packed.armed);
  a(packed.active);
}
template <class Archive>
void Fields(Archive& a, Packed& p) {
  List(a, p.documents);
  a(p.plans);
  List(a, p.runs);
  a(p.kept);
  std::vector<std::string> names;
  for (const auto& [name, deployment] : p.deployments) names.push_back(name);
  a(names);
  for (const std::string& name : names) Fields(a, p.deployments[name]);
  a(p.services, p.services_version, p.next_handle, p.next_run);
}

// What format 5 of snapshots added, behind what format 4 had.
template <class Archive>
void AddedFields(Archive& a, PackedInvocation& packed) {
  InvocationState& s = packed.state;
  for (OpenCommand& open : s.commands) a(open.occupies, open.overdue_until_us);
  List(a, s.lost);
  for (OpenCommand& open : s.lost) a(open.occupies);
  a(s.occupies, s.overdue, s.match, s.guard_revision, s.sent, s.queued, s.once);
}
template <class Archive>
void AddedFields(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    a(run.run.unknown_outcome);
    for (PackedNode& node : run.nodes) {
      a(node.state.guard, node.state.hold, node.state.replaced, node.state.first_attempt);
      for (PackedInvocation& invocation : node.invocations) AddedFields(a, invocation);
    }
  }
  List(a, p.ending);
}

// What format 6 added.
template <class Archive>
void AddedIn6(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    for (PackedNode& node : run.nodes) {
      for (ArmedCondition& armed : node.state.armed) a(armed.ask.joint_events);
    }
  }
  for (auto& [name, deployment] : p.deployments) {
    for (ArmedCondition& armed : deployment.armed) a(armed.ask.joint_events);
  }
  a(p.joint_events);
}

// What format 7 added.
template <class Archive>
void AddedIn7(Archive& a, Packed& p) {
  for (auto& [name, deployment] : p.deployments) a(deployment.held_back, deployment.disabled);
  a(p.activations);
}

template <class Archive>
void SolutionFields(Archive& a, std::map<std::string, SolutionsPtr>* solutions) {
  std::map<std::string, std::vector<TermBinding>> values;
  for (const auto& [name, list] : *solutions) values[name] = *list;
  a(values);
  if constexpr (Archive::kReads) {
    for (auto& [name, list] : values)
      (*solutions)[name] = std::make_shared<const std::vector<TermBinding>>(std::move(list));
  }
}

// What format 8 added, behind that: what nodes have done of their own.
template <class Archive>
void AddedIn8(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    std::vector<TermQuad> until_end(run.run.actions.until_end.begin(), run.run.actions.until_end.end());
    a(until_end);
    run.run.actions.until_end = {until_end.begin(), until_end.end()};
    SolutionFields(a, &run.run.actions.solutions);
    for (PackedNode& node : run.nodes) {
      NodeActions& actions = node.state.actions;
      a(actions.next[0], actions.next[1], actions.bindings, actions.begun, actions.awaited);
    }
  }
  List(a, p.outbox);
}

// What format 9 added.
template <class Archive>
void AddedIn9(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    a(run.run.pause, run.run.paused_since_us);
    for (PackedNode& node : run.nodes) {
      a(node.state.wanted_robot);
      for (PackedInvocation& invocation : node.invocations) {
        a(invocation.state.not_before_us, invocation.state.failed_on);
        for (std::vector<OpenCommand>* commands : {&invocation.state.commands, &invocation.state.lost}) {
          for (OpenCommand& open : *commands) a(open.stopped);
        }
      }
    }
  }
  for (PackedRun& run : p.runs) a(run.run.done_steps, run.run.undoing);
  a(p.paused_workflows);
}

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

// nullopt for a run in the middle of a turn.
std::optional<PackedRun> Pack(const Run& run, Numbers<cawl::Document>* documents,
                              Numbers<rsel::Plan>* plans) {
  PackedRun packed;
  packed.run = run;
  packed.document = documents->Of(run.document);
  for (NodeState& node : packed.run.nodes) {
    if (!node.pending_links.empty()) return std::nullopt;
    PackedNode& to = packed.nodes.emplace_back();
    for (InvocationState& invocation : node.invocations) {
      PackedInvocation& into = to.invocations.emplace_back();
      if (invocation.handler) {
        into.handler.emplace(plans->Of(invocation.handler->shared_plan()), invocation.handler->Save());
      }
      into.state = std::move(invocation);
    }
    node.invocations.clear();
    to.state = std::move(node);
  }
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

absl::StatusOr<Run> Unpack(PackedRun packed, const Shared& shared, RunTerms* terms) {
  Run run = std::move(packed.run);
  if (packed.document >= shared.documents.size()) return Damaged();
  run.document = shared.documents[packed.document];
  for (PackedNode& node : packed.nodes) {
    NodeState& to = run.nodes.emplace_back(std::move(node.state));
    for (PackedInvocation& invocation : node.invocations) {
      InvocationState& into = to.invocations.emplace_back(std::move(invocation.state));
      if (!invocation.handler) continue;
      auto& [plan, saved] = *invocation.handler;
      if (plan >= shared.plans.size()) return Damaged();
      auto handler = rsel::InstructionHandler::Restore(shared.plans[plan], std::move(saved));
      if (!handler.ok()) return Damaged();
      into.handler = *std::move(handler);
    }
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
    packed.deployments[name] = {documents.Of(deployment.document), deployment.armed, deployment.active,
                                deployment.held_back, deployment.disabled};
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
  writer(packed.last_used);  // since format 6
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
  if (!reader.AtEnd()) AddedIn6(reader, packed);
  if (!reader.AtEnd()) AddedIn7(reader, packed);
  if (!reader.AtEnd()) AddedIn8(reader, packed);
  if (!reader.AtEnd()) AddedIn9(reader, packed);
  if (!reader.AtEnd()) reader(packed.last_used);
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
          RequestOf(armed.handle, armed.ask, cawl::KeyVariables(*deployment.document->activator, armed.ask)));
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
  for (const RobotId& robot : told)
    core_->robot_facts[robot] = std::make_shared<const std::vector<Quad>>(RobotFacts(robot, core_.get()));
  Commit();
}

}  // namespace docent::engine
