// The state of one workflow run: a plain value. The engine copies a run before it first changes it in a turn,
// so a turn that fails puts the copy back. Everything here also stands in the graph (run_facts.h). Writer
// thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_RUN_STATE_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_RUN_STATE_H_

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/store/quad.h"
#include "workflow/cawl/ask_compiler.h"
#include "workflow/cawl/ast.h"
#include "workflow/engine/state/action_state.h"
#include "workflow/engine/state/flow_graph.h"
#include "workflow/engine/state/ports.h"
#include "workflow/rsel/instruction_handler.h"

namespace docent::engine {

// The words of docent:runState, docent:nodeState and docent:invocationState.
//   run:        running → done | failed | cancelled
//   node:       inactive → waiting → running → done | failed | skipped | cancelled
//               waiting, running → incident (it failed, and waits for an operator) → waiting, running or failed
//   invocation: pending (no robot free yet) → running → done | failed | cancelled
enum class WorkState : uint8_t {
  kInactive,
  kWaiting,
  kPending,
  kRunning,
  kDone,
  kFailed,
  kSkipped,
  kCancelled,
  kIncident  // last: the numbers are part of the format of snapshots
};
std::string_view ToString(WorkState state);
inline bool IsFinal(WorkState state) {
  return state >= WorkState::kDone && state != WorkState::kIncident;
}
// Of a node: its run does not end before it.
inline bool IsLive(WorkState state) {
  return state == WorkState::kWaiting || state == WorkState::kRunning || state == WorkState::kIncident;
}

// Why a command was cancelled, or called back, though its invocation goes on.
enum class Stopped : uint8_t { kNo, kByPause, kWithRobot };
// "its run was paused", "its robot was taken out of service"; empty: kNo.
std::string_view ToString(Stopped why);

// A command that went out (or goes out with this turn) and has no final report.
struct OpenCommand {
  RobotCommand command;
  int step = 0;     // of the RSEL plan, from 1
  int attempt = 0;  // of that step, from 1
  Occupation occupies;
  // Its time was over and it was cancelled; until then its end is waited for, then the step fails without another attempt.
  std::optional<TimeMicros> overdue_until_us;
  Stopped stopped = Stopped::kNo;
  Stopped recalled = Stopped::kNo;  // it is not to begin, where the robot has not begun it

  // Whether its Cancel has been decided: it is told to the adapter until that has heard it, over restarts, too.
  bool IsEnding() const { return overdue_until_us || stopped != Stopped::kNo; }
  // When something has to be done about it, if it has no final report by then.
  std::optional<TimeMicros> EndsAt() const {
    if (overdue_until_us || command.deadline_us == 0) return overdue_until_us;
    return command.deadline_us;
  }
};

// A command that its invocation no longer waits for, and that has no final report. What succeeds all the same is done.
struct LateCommand {
  CommandId id;
  int step = 0;  // of the RSEL plan, from 1
};

// In a binding: the variable has no value, also where the run has one.
inline const Term kNoValue = {};

// One invoke of a node, for one binding of forEach.
struct InvocationState {
  size_t invoke = 0;    // index in cawl::Node::invokes
  TermBinding binding;  // forEach: the variables of this invocation, in front of the run's
  TermBinding
      inputs;  // ext:input: as they were when this attempt last tried to begin, in front of the binding
  TermBinding
      results;  // done: what it made of variables of the run; kNoValue: a named result that was not given
  WorkState state = WorkState::kPending;
  int attempt = 1;  // of the whole invoke, counted over all attempts of the node; part of its commands' ids
  int retries = 0;  // of those, by the invoke's own ext:retry in this attempt of the node
  int resends = 0;  // commands sent again after an unknown outcome; part of their ids
  std::optional<rsel::InstructionHandler> handler;
  RobotId robot;
  std::vector<OpenCommand> commands;
  // To be sent again: what was not begun, and idempotent ones that were cancelled or have an unknown outcome.
  std::vector<OpenCommand> lost;
  RunId child;       // subflow
  std::string step;  // "2/4 moveToBooth", the latest given
  double progress = 0;
  std::string reason;
  // Of this attempt, where the document gives a time; else of waiting for a robot.
  std::optional<TimeMicros> deadline_us;
  std::optional<TimeMicros> not_before_us;  // pending: its ext:retry-delay
  std::set<RobotId> failed_on;  // ext:retry-other-robot: robots on which an attempt before has failed
  Occupation occupies;          // of the robot, while it runs
  // This attempt has failed, and the next one begins when the end of all its commands is known. Empty: it goes on.
  std::string overdue;
  TermBinding match;        // of the guard, with which the node opened for this invocation
  Revision guard_revision;  // at which the guard was last seen to hold: when this attempt began
  bool sent = false;        // in this attempt or one before, a command or a sub-flow
  std::string failure;      // why the attempt before failed
  bool queued = false;      // pending: it waits for a robot in the waiting room (waiting_room.h)
  bool once =
      false;  // an outcome is unknown and the operation is not idempotent: there is no further attempt
  std::vector<LateCommand> late;
  // Of this attempt and those before, where it is not done: something of it was done; how a command ended is not known.
  bool partly_done = false;
  bool unknown = false;
};

// What an invocation has values of its own for, in front of the run's variables.
TermBinding GivenTo(const InvocationState& invocation);

struct ArmedCondition {
  ConditionHandle handle = 0;
  cawl::CompiledAsk ask;
  // ask.by_event(): events that came while only robots that serve other runs could take them, and still stand.
  std::set<TermBinding> waiting_events;
};

// What is asked again after a node has opened: the condition that opened it, or its ext:while-holds.
struct Guard {
  ArmedCondition armed;  // handle 0: not armed, since nothing waits
  bool every = false;    // armed for each binding of its free variables (NodeKeys)
};

// What the match that opened a node made of a variable of the run.
struct ReplacedValue {
  Term given;
  std::optional<Term> before;
};

// A link with ext:while, waiting for the level of its condition.
struct PendingLink {
  size_t link = 0;  // index in cawl::Flow::links
  ConditionHandle handle = 0;
};

struct NodeState {
  WorkState state = WorkState::kInactive;
  int iteration = 0;  // times it was entered again (ext:while)
  int attempt = 1;    // ext:retry
  TimeMicros since_us = 0;
  std::set<std::string> arrived;  // predecessors whose link was followed
  std::set<std::string> dead;     // predecessors from which nothing can come any more
  std::vector<ArmedCondition> armed;
  std::vector<PendingLink> pending_links;
  std::set<RobotId> busy_robots;  // waiting: its condition holds, but only with these, which serve other runs
  std::optional<TimeMicros> deadline_us;  // of waiting, then of running
  std::vector<InvocationState> invocations;
  std::optional<Guard> guard;  // running: the condition that opened it, while it may have to be asked again
  std::optional<Guard> hold;   // running: its ext:while-holds, where that is not its condition
  std::map<std::string, ReplacedValue> replaced;  // running, incident: by the match that opened it
  int first_attempt = 1;                          // of the invocations when it opens next
  NodeActions actions;                            // running: what it has done of its own
  std::string waits_for;                          // the ASK, while waiting
  std::string fired_because;                      // N-Triples, since it opened
  TimeMicros fired_us = 0;
  std::string
      reason;  // failed, skipped, cancelled, incident: why; running: what interrupted it, while it ends
  RobotId wanted_robot;  // that an operator chose for it; empty: as the document says
};

using FactsPtr = std::shared_ptr<const std::vector<Quad>>;

// An ended run whose facts are still in the graph.
struct KeptRun {
  RunId id;
  FactsPtr facts;
};

// A node that is done and has ext:compensate, for one binding of its forEach.
struct DoneStep {
  std::string place;      // "Deliver"; of a sub-flow "Visit-3/Deliver"
  std::string operation;  // that undoes it; empty: it cannot be undone
  TermBinding variables;  // when it was done, with the robot that did it
  TimeMicros done_us = 0;
  std::string stays;  // why it cannot be undone
};

// The same of a node that has come to an end while commands of it were under way: whether it is done is known when all of these
// have their final report.
struct LateStep {
  std::string place, operation;
  TermBinding variables;                     // of the run, when the node came to its end
  std::vector<InvocationState> invocations;  // of the binding: one for each invoke
  // What these are of. The run may have ended since.
  cawl::DocumentPtr document;
  size_t flow = 0;
  size_t node = 0;
};

// A run that undoes what it did, then ends.
struct Undoing {
  WorkState outcome = WorkState::kCancelled;
  std::string reason;
  std::vector<DoneStep> left;       // the last is the next
  RunId child;                      // that undoes a step now
  std::string current;              // this step, for people
  std::vector<std::string> failed;  // steps that could not be undone, and why
  bool undid = false;               // some step
};

// The timer of a run that had more to do than its turn allows: it goes on with the next turn of the clock. That one may be
// refused; what others send is not.
inline constexpr TimeMicros kNextTick = 1;

struct Run {
  RunId id;
  uint64_t number = 0;  // in order of start, over all flows
  cawl::DocumentPtr document;
  size_t flow = 0;  // index in document->flows
  WorkState state = WorkState::kRunning;
  std::string reason;
  TimeMicros started_us = 0;
  TimeMicros ended_us = 0;
  TermBinding variables;
  std::vector<NodeState> nodes;  // as cawl::Flow::nodes
  bool sink_reached = false;
  std::set<RobotId> robots;      // that this run or a run nested in it has taken (robot_ledger.h)
  bool unknown_outcome = false;  // of an operation that is not idempotent: nothing of this run is tried again

  RunActions actions;                // what its nodes have done of their own
  std::optional<std::string> pause;  // that was asked for this run: why
  TimeMicros paused_since_us = 0;    // by that or by a pause of a run that it is nested in; 0: it goes on

  std::vector<DoneStep> done_steps;  // in order of completion
  std::vector<LateStep> late_steps;
  std::optional<Undoing> undoing;  // no node of its flow goes on any more
  // Nodes of which something stays when the run is undone, those of sub-flows that have ended as "Call/Grip": they invoked something
  // and have no ext:compensate; they told, withdrew or notified something for longer than the run.
  std::set<std::string> not_compensated, told_for_good;

  FlowGraphPtr graph;  // of its flow; null until it is first needed
  size_t counted = 0;  // its part of the engine's nodes_live
  RunId root;          // the outermost run that it is nested in, or itself
  // Of the outermost run; they follow from its document.
  int priority = 0;
  bool preempts = false;

  // The invocation that this run is the subflow of.
  RunId parent;
  size_t parent_node = 0;
  size_t parent_invocation = 0;

  FactsPtr facts;                      // as last told to the graph, sorted; null: nothing yet
  std::optional<TimeMicros> timer_us;  // as in the engine's timer queue; or kNextTick

  const cawl::Flow& Flow() const { return document->flows[flow]; }
  bool paused() const { return paused_since_us != 0; }
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_RUN_STATE_H_
