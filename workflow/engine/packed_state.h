// Layout of the saved state of the engine: which fields of runs, deployments and their parts are written, in which order, and
// what each format of snapshots added. One description serves both directions (ByteWriter, ByteReader). Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_PACKED_STATE_H_
#define DOCENT_WORKFLOW_ENGINE_PACKED_STATE_H_

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/term_archive.h"
#include "workflow/cawl/parser.h"
#include "workflow/engine/engine_state.h"
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
void Fields(Archive& a, LateCommand& late) {
  a(late.id, late.step);
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
// Its invocations apart.
struct PackedLateStep {
  LateStep step;
  uint64_t document = 0;
  std::vector<PackedInvocation> invocations;
};
struct PackedNode {
  NodeState state;  // its invocations apart
  std::vector<PackedInvocation> invocations;
};
struct PackedRun {
  Run run;  // its document, nodes and late steps apart
  uint64_t document = 0;
  std::vector<PackedNode> nodes;
  std::vector<PackedLateStep> late_steps;
};
struct PackedDeployment {
  uint64_t document = 0;
  std::vector<ArmedCondition> armed;
  std::map<std::string, int> active;
  std::map<std::string, HeldBackStart> held_back;
  bool disabled = false;
  cawl::NameMap names;
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
void AddedIn9(Archive& a, PackedInvocation& packed) {
  a(packed.state.not_before_us, packed.state.failed_on);
  for (std::vector<OpenCommand>* commands : {&packed.state.commands, &packed.state.lost}) {
    for (OpenCommand& open : *commands) a(open.stopped);
  }
}
template <class Archive>
void AddedIn9(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    a(run.run.pause, run.run.paused_since_us);
    for (PackedNode& node : run.nodes) {
      a(node.state.wanted_robot);
      for (PackedInvocation& invocation : node.invocations) AddedIn9(a, invocation);
    }
  }
  for (PackedRun& run : p.runs) a(run.run.done_steps, run.run.undoing);
  a(p.paused_workflows);
}

// What format 11 added.
template <class Archive>
void AddedIn11(Archive& a, PackedInvocation& packed) {
  a(packed.state.inputs, packed.state.results, packed.state.failure);
}
template <class Archive>
void AddedIn11(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    for (PackedNode& node : run.nodes) {
      for (PackedInvocation& invocation : node.invocations) AddedIn11(a, invocation);
    }
  }
  for (EndingCommand& ending : p.ending) a(ending.kept);
}

// What format 12 added: work that was cancelled while its commands were under way.
template <class Archive>
void AddedIn12(Archive& a, PackedInvocation& packed) {
  a(packed.state.late, packed.state.partly_done, packed.state.unknown);
}
template <class Archive>
void Fields(Archive& a, PackedLateStep& packed) {
  LateStep& s = packed.step;
  a(s.place, s.operation, s.variables, packed.document, s.flow, s.node);
  List(a, packed.invocations);
  for (PackedInvocation& invocation : packed.invocations) {
    AddedFields(a, invocation);
    AddedIn9(a, invocation);
    AddedIn11(a, invocation);
    AddedIn12(a, invocation);
  }
}
template <class Archive>
void AddedIn12(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    for (PackedNode& node : run.nodes) {
      for (PackedInvocation& invocation : node.invocations) AddedIn12(a, invocation);
    }
    for (DoneStep& step : run.run.done_steps) a(step.stays);
    if (run.run.undoing) {
      for (DoneStep& step : run.run.undoing->left) a(step.stays);
      a(run.run.undoing->undid);
    }
    List(a, run.late_steps);
  }
}

// What format 13 added.
template <class Archive>
void AddedIn13(Archive& a, PackedInvocation& packed) {
  for (std::vector<OpenCommand>* commands : {&packed.state.commands, &packed.state.lost}) {
    for (OpenCommand& open : *commands) a(open.recalled);
  }
}
template <class Archive>
void AddedIn13(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) {
    for (PackedNode& node : run.nodes) {
      for (PackedInvocation& invocation : node.invocations) AddedIn13(a, invocation);
    }
  }
  for (auto& [name, deployment] : p.deployments) a(deployment.names);
}

// What format 14 added.
template <class Archive>
void AddedIn14(Archive& a, Packed& p) {
  for (PackedRun& run : p.runs) a(run.run.not_compensated, run.run.told_for_good);
}

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_PACKED_STATE_H_
