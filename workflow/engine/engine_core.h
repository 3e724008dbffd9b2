// The engine's inside, shared by engine.cc (documents, requests, reports, journal) and the run stepper (one
// run's way through its flow). Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_ENGINE_CORE_H_
#define DOCENT_WORKFLOW_ENGINE_ENGINE_CORE_H_

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "workflow/cawl/ask_names.h"
#include "workflow/engine/activations.h"
#include "workflow/engine/engine.h"
#include "workflow/engine/run_numbers.h"
#include "workflow/engine/state/asked_times.h"
#include "workflow/engine/state/event_waits.h"
#include "workflow/engine/state/robot_ledger.h"
#include "workflow/engine/state/run_state.h"
#include "workflow/engine/state/run_terms.h"
#include "workflow/engine/state/waiting_room.h"
#include "workflow/engine/turn_bounds.h"

namespace docent::engine {

// Whose condition a handle is: a run's node, or (run empty) a workflow's activator.
struct ConditionOwner {
  RunId run;
  size_t node = 0;
  std::string workflow;
};

// A binding of an activator's key variables that has yet to start its run.
struct HeldBackStart {
  ConditionHandle handle = 0;
  TermBinding key;
};

struct PausedWorkflow {
  TimeMicros since_us = 0;
  std::string reason;
};

struct Deployment {
  cawl::DocumentPtr document;
  std::vector<ArmedCondition> armed;  // the activator's alternatives
  std::map<std::string, int> active;  // key binding → number of alternatives that give it
  std::set<std::string> carried;      // of the version before: start no second run
  // Bindings that appeared while the workflow started no runs and still hold: they start their runs when it does again.
  std::map<std::string, HeldBackStart> held_back;
  bool disabled = false;
  // What variables of `armed` are called in the document, where that is otherwise: it was loaded again under other names.
  cawl::NameMap names;
};

// How a compiled condition is asked for.
ConditionRequest RequestOf(ConditionHandle handle, const cawl::CompiledAsk& ask,
                           std::vector<std::string> key_variables);

// What is kept of a condition once it is asked for: its text, not its query.
ArmedCondition Armed(ConditionHandle handle, cawl::CompiledAsk ask);

// Nodes of the run and their invocations, as the limit nodes_live counts them.
size_t SizeOf(const Run& run);

// Bytes of a text that is evaluated, or made a condition of, that take about as long as a change of a node.
inline constexpr size_t kTextOfAChange = 256;

inline bool IsFinal(CommandReport::Outcome outcome) {
  using Outcome = CommandReport::Outcome;
  return outcome == Outcome::kSucceeded || outcome == Outcome::kFailed || outcome == Outcome::kCancelled ||
         outcome == Outcome::kUnknown || outcome == Outcome::kNotBegun;
}

// Why an invocation is pending: all robots that could do it are held by other runs.
inline constexpr std::string_view kAllServeOthers = "every robot that offers it serves another run";
// Or those that could do it now are at another step of the same run.
inline constexpr std::string_view kAtAnotherStep = "the robot is at another step of this run, or ends one";
// Or its ext:while-holds is not so.
inline constexpr std::string_view kHoldsNot = "what has to hold while it runs does not hold";
// Or its guard is not so any more: the end of the reason.
inline constexpr std::string_view kCeasedToHold = " ceased to hold";
// Or ext:sequential.
inline constexpr std::string_view kComesLater = "it comes after the one before it";
// Or a command of an attempt before has no final report yet.
inline constexpr std::string_view kAttemptNotEnded = "the end of the attempt before it is not known yet";

// Or the workflow that is to be its sub-flow is paused.
inline constexpr std::string_view kWorkflowPaused = "the workflow of its sub-flow is paused";
// Or its ext:retry-delay is not over.
inline constexpr std::string_view kRetryLater = "its next attempt begins later";

struct Engine::Core {
  Core(Dictionary* dictionary, const Limits& limits_in) : run_terms(dictionary), limits(limits_in) {}

  RunTerms run_terms;
  const Limits limits;
  std::map<RunId, Run> runs;  // live ones
  // Ended ones whose facts are still in the graph, the one that ended first in front.
  std::deque<KeptRun> kept;
  std::map<std::string, Deployment> deployments;
  std::map<std::string, PausedWorkflow> paused_workflows;  // deployed ones
  rsel::ServiceRegistry services;
  ConditionHandle next_handle = 1;
  uint64_t next_run = 1;

  // Derived from `runs` and `deployments`; made anew by Rollback.
  absl::flat_hash_map<ConditionHandle, ConditionOwner> owners;
  absl::flat_hash_map<std::string, CommandOwner> commands;  // by command id
  std::set<std::pair<TimeMicros, RunId>> timers;
  RobotLedger ledger;                       // its ending commands are state
  std::map<RobotId, RunId> held_by_others;  // Engine::HoldForOthers
  std::optional<RunNumbers> played;         // Engine::PlayInstead
  AskedTimes times;
  WaitingRoom waiting;
  Activations activations;
  EventWaits event_waits;  // the events that conditions have of those that they need are state
  FlowGraphs graphs;
  size_t nodes_live = 0;                    // and invocations, of all live runs
  std::map<RunId, std::set<RunId>> trees;   // live runs, by root
  std::map<RunId, std::set<RunId>> nested;  // live runs, by the run that they are nested in
  std::map<RobotId, TimeMicros> last_used;  // when a run took the robot last
  std::map<RobotId, FactsPtr> robot_facts;  // as last told to the graph
  std::map<CommandId, OpenNotification> outbox;

  // The journal: what Rollback puts back. Empty after Commit.
  std::map<RunId, std::optional<Run>> undo_runs;  // nullopt: did not exist
  std::map<std::string, std::optional<Deployment>> undo_deployments;
  struct ActiveBefore {  // of a deployment that is not in undo_deployments: there may be very many keys
    std::string workflow, key;
    int count;
  };
  std::vector<ActiveBefore> undo_active;
  std::optional<rsel::ServiceRegistry> undo_services;
  std::optional<std::map<std::string, PausedWorkflow>> undo_paused_workflows;
  std::map<RobotId, FactsPtr> undo_robot_facts;
  std::map<CommandId, std::optional<OpenNotification>> undo_outbox;
  std::map<RobotId, std::optional<TimeMicros>> undo_last_used;
  std::vector<KeptRun> undo_kept;  // let go of in this turn, in their order
  size_t kept_new = 0;             // at the end of `kept`
  ConditionHandle committed_handle = 1;
  uint64_t committed_run = 1;

  // This Step's input and output.
  const EngineInput* input = nullptr;
  EngineOutput* output = nullptr;
  std::map<ConditionHandle, const ConditionEdge*> edges;
  std::set<RunId> touched;           // runs to be advanced
  std::set<RunId> advanced;          // of these, those that went on
  std::set<RunId> changed;           // runs whose facts and timers are to be told at the end of the Step
  std::set<RobotId> released;        // robots of which something became free, or may take commands again
  std::set<RobotId> changed_robots;  // robots whose facts are to be told at the end of the Step
  std::set<RobotId> coveted;         // that more urgent runs wait for: looked at for pre-emption
  std::set<RobotId> preempted;       // in this Step: at most once each
  std::set<std::pair<uint64_t, RunId>> asking;  // runs that ask a condition again in a round to come, by rank
  std::set<RunId> awaiting;                     // runs that armed a `while` condition in the round before
  std::set<RunId> gone_on;                      // runs that changed in an earlier round of this turn
  std::set<RunId> unfinished;                   // runs that this Step does no more for
  std::set<RunId> resumed;                      // runs that it does something for
  std::set<RunId> ended;                        // runs whose end nothing has followed from yet
  TurnBounds bounds;                            // of the turn
  bool services_changed = false;                // since the last Step
  int turn_round = 0;                           // of this turn, from 0
  size_t facts_written = 0;                     // by runs in this turn
  std::map<RunId, std::vector<size_t>> written;      // in this round: index in output->writes
  std::set<RunId> writing_trees;                     // of these, the outermost runs
  std::set<std::pair<RunId, size_t>> wrote_at_open;  // of these, nodes whose invocations come after that
  // Output of Deploy and Undeploy, told with the next Step.
  std::vector<ConditionRequest> deploy_arm;
  std::vector<ConditionHandle> deploy_disarm;
  std::vector<std::string> deploy_enabled;  // workflows
  std::vector<RunId> deploy_cancel;         // runs of workflows that were undeployed
  std::vector<Quad> deploy_remove;
  std::vector<std::string> deploy_gone;  // workflows that were undeployed

  // The run to be changed; journals it first. Null if it is not live.
  Run* Mutable(const RunId& id);
  // The deployment to be changed (made if there is none); journals it first.
  Deployment& MutableDeployment(const std::string& workflow);
  // So many (1 or -1) alternatives of the activator more give `key`, never less than none. Journals how many did, and
  // returns it.
  int AddActive(const std::string& workflow, const std::string& key, int more);

  // Why no run may start of a flow with so many nodes, for people; empty: one may.
  std::string WhyNoRoom(size_t nodes) const;
  // The same of so many nodes or invocations more of a live run.
  std::string WhyNoNodes(size_t nodes) const;
  // Tells of matches that started no run. An error: the turn deploys a document that may not be deployed.
  absl::Status TellMissed();
  // The condition has more matches than are kept: it is not followed any more. An error as above.
  absl::Status GiveUp(ConditionHandle handle);
  // The number of a run that begins, nested in `parent` (null: in none).
  uint64_t TakeNumber(const CommandOwner* parent);
  // Starts a run of `flow` with these variables. The caller gives the parent, if any.
  RunId Start(const cawl::DocumentPtr& document, size_t flow, TermBinding variables, const std::string& cause,
              const CommandOwner* parent);
  void Cancel(const RunId& id, const std::string& reason);
  // Whether the workflow of that document starts no run now.
  bool IsPaused(const cawl::Document& document) const {
    return paused_workflows.contains(document.name.value);
  }
  // The flow that `subflow` names, seen from `from`: a flow of that document, or a deployed document's first
  // flow.
  std::optional<std::pair<cawl::DocumentPtr, size_t>> FindFlow(const cawl::DocumentPtr& from,
                                                               const std::string& name) const;

  ConditionHandle Arm(const cawl::CompiledAsk& ask, std::vector<std::string> key_variables,
                      ConditionOwner owner);
  // What the graph is told of a run that ended stays there until limits.runs_kept others have ended.
  void Keep(KeptRun run);
  void Disarm(ConditionHandle handle);
  // The same between Steps, for an activator's condition.
  void DisarmDeployed(ConditionHandle handle);
  // Whether the condition is armed by this Step.
  bool IsArming(ConditionHandle handle) const;
  void Say(std::string subject, std::string_view from, std::string_view to, std::string cause);

  // Robots that can take this plan for `self` now, in term order: online, offering all of its operations, in service, free
  // for `root`, and with nothing under way that occupies what the plan does. `wanted`: only this one. None: `*why_not` says
  // why.
  std::vector<RobotId> RobotsFor(const rsel::Plan& plan, const std::optional<Term>& wanted, const RunId& root,
                                 const CommandOwner& self, std::string* why_not) const;
  // Of these, those that are online and offer all of the operations, in term order: what they offer of the first one.
  std::vector<const RobotOffer*> OnlineFor(const rsel::Plan& plan, const std::optional<Term>& wanted,
                                           const CommandOwner& self, std::string* why_not) const;
  // What the robot offers of this operation; null: nothing. Of a capability: the most general.
  const RobotOffer* OfferOf(const std::string& operation, const RobotId& robot) const;
  // Likewise for `self`: of a capability, the most general operation whose inputs all have a value there. `*lacks`: of the last
  // one that was passed over, which input has none. An owner without a run has every value.
  const RobotOffer* OfferFor(const std::string& operation, const RobotId& robot, const CommandOwner& self,
                             std::string* lacks = nullptr) const;
  // What a plan occupies of the robot from its first step to its last.
  Occupation OccupationOf(const rsel::Plan& plan, const RobotId& robot, const CommandOwner& self) const;
  // Why the robot takes no command now, for people; empty: it takes some.
  std::string OutOfService(const RobotOffer& offer) const;
  // What keeps the robot from the runs of `root` now, for people: "is held by run Tour-1", "is reserved …".
  std::vector<std::string> WhatKeeps(const RobotId& robot, const RunId& root) const;
  // The same from any run that would begin the plan: "is offline", "is out of service: brush", "does not offer grip".
  std::vector<std::string> WhatKeeps(const RobotId& robot, const rsel::Plan& plan) const;
  // The plan of an invoke's operation: a registered process, or the robots' own operation, without inputs.
  rsel::PlanPtr PlanOf(const std::string& operation) const;

  // How many runs a run is nested in as a subflow.
  int DepthOf(const Run& run) const;
  // Whether the run, or one that it is nested in, is of the flow, in whatever version of its document.
  bool IsInside(const Run& run, const cawl::Document& document, size_t flow) const;
  // The outermost run that a run belongs to.
  RunId RootOf(const Run& run) const;
  // The invocation, then those that its run is nested in.
  std::vector<CommandOwner> OwnersOf(const CommandOwner& owner) const;
  // The robot is held by the run's root from now on.
  void Hold(const RobotId& robot, const Run& run);
  void Used(const RobotId& robot);
  // The command is cancelled, and its run no longer waits for its end: the robot does.
  void LetEnd(const OpenCommand& open, const CommandOwner& owner);
  // Withdraws facts of a run that has ended, as soon as none of its commands is ending.
  void WithdrawWhenEnded(const RunId& run, std::vector<TermQuad> facts);
  // True if the robot's last holder has ended with all its commands; it is free from now on.
  bool FreeIfOver(const RobotId& robot);
  // What a pending invocation waits for.
  RobotWish WishOf(const Run& run, const CommandOwner& owner) const;
  // run_reservations.cc
  // The reservation that keeps the robot from the runs of `root`; null: none does.
  const Reservation* Bars(const RobotId& robot, const RunId& root) const;
  bool BarsRun(const RobotId& robot, const RunId& run) const;
  // Tells the waiting room, if that is why the invocation waits.
  void NoteBarred(const CommandOwner& owner, const std::string& reason);
  // For people: "is reserved for run Tour-1 until …, with priority 5".
  static std::string ShowReservation(const Reservation& reservation);
  // What keeps robots for the run alone is withdrawn: it has ended.
  void EndReservations(const RunId& root);
  // What keeps robots for the runs of a workflow, where it is not deployed any more and none of its runs is live.
  void EndReservationsOf(const std::string& workflow);
  // `root`: of the runs that may have written it in this round.
  void EndReservationsFor(const std::string& kept_for, const RunId& root);
  // The told facts of a reservation, in whatever graph; with what the run tree `root` has written in this round.
  std::vector<TermQuad> ReservationFacts(const std::string& reservation, const RunId& root) const;
  // Whether something that was written in this round may change the condition's answer.
  bool MayHaveChanged(ConditionHandle handle) const;
  void LetOwnGuardsGo();
  // Takes runs that ask again into `touched`: some each round, since mostly one of them gets what all ask for.
  void TouchAsking();
  // run_preemption.cc
  void InheritPriority(Run* run) const;
  uint64_t RankOf(const Run& run) const;
  bool CouldServe(const rsel::Plan& plan, const RobotId& robot) const;
  // The run waits for the operation, and may take a robot of less urgent ones. `wanted`: only this robot.
  void Covet(const Run& run, const std::string& operation, const std::optional<Term>& wanted);
  // The robot goes from its holder to the most urgent run that waits for it, if it may.
  void Preempt(const RobotId& robot);
  void TakeFrom(const RunId& root, const RobotId& robot, const Run& by);
  void RebuildTask(const Run& run, const CommandOwner& owner);

  // Tells the waiting room of the run's busy robots.
  void Reblock(const Run& run);

  void RebuildDerived();
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_ENGINE_CORE_H_
