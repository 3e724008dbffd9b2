// Takes one run as far as it can go now: opens nodes whose conditions hold, gives invocations to robots,
// follows links, ends the run. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_STEPPER_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_STEPPER_H_

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/run_limits.h"
#include "workflow/engine/engine_core.h"
#include "workflow/engine/run_values.h"

namespace docent::engine {

// "90 s", "2 min", "1500 ms": a time of a document, for people.
std::string TimeText(int64_t ms);

// "place = <urn:x>, robot = <urn:r1>", for people.
std::string ShowBinding(const TermBinding& binding);

// Solutions looked at to find one whose robot is free.
inline constexpr size_t kSolutionLimit = 1000;
// Of a node with forEach: one more than it can have, so that it fails.
inline constexpr size_t kEachLimit = kRunLimits.node_invocations + 1;

// The reason of a running node begins so while what interrupted it ends.
inline constexpr std::string_view kInterrupted = "interrupted: ";

// The key variables with which a node's condition is armed. `every`: a change of any binding is to be noticed.
std::vector<std::string> NodeKeys(const cawl::CompiledAsk& ask, bool every);

// Whether an operator may say what becomes of the node: it has an incident, or was retried after one and has begun nothing.
bool MaySettle(const NodeState& node);

// Whether something of the invocation was done, in this attempt or in one before.
bool IsPartlyDone(const InvocationState& invocation);

class RunStepper {
 public:
  RunStepper(Engine::Core* core, Run* run);

  // A new run: sets variables and follows the links out of the source.
  void Begin(const std::string& cause);
  // Everything that is possible now. Returns when nothing more changes.
  void Advance();
  // What became of a command of this run.
  void Report(const CommandOwner& owner, const CommandReport& report);
  // An operation of an attempt that failed has an unknown outcome and is not idempotent: there is no further attempt.
  void OutcomeUnknown(const CommandOwner& owner);
  // A subflow ended.
  void ChildEnded(const CommandOwner& owner, const Run& child);
  // What became of a notification of the node.
  void Delivered(size_t node, const CommandReport& report);
  // The node can not be followed any further: it fails.
  void GiveUp(size_t index, const absl::Status& why);
  // Ends the run; what is under way is cancelled.
  void End(WorkState state, const std::string& why);

  // Compensation (run_compensation.cc). EndAndUndo ends the run when what its done nodes did is undone.
  bool TakeLate(const EndingCommand& ended, const CommandReport& report);
  void EndAndUndo(WorkState outcome, const std::string& reason);

  // In the round after the node wrote at="open": a guard that this made fall is not asked again.
  void LetOwnGuardGo(size_t index);

  // Steering (run_incidents.cc). Each `reason` is an operator's, and may be empty.
  void SetVariable(const std::string& name, const Term& value);
  // Cancels what is under way; it begins again when it may, or an operator is asked. `robot`: of this one only.
  void StopCommands(Stopped why, const RobotId* robot);
  // Calls back what no robot has begun; it is sent again when it may. What a robot has begun goes on.
  void RecallCommands(Stopped why, const RobotId* robot);
  // Of a node that may be settled (MaySettle).
  void RetryNode(size_t index, const RobotId& robot, const std::string& reason);
  void SkipNode(size_t index, const TermBinding& values, const std::string& reason);
  void FailNode(size_t index, const std::string& reason);

  // The earliest deadline of this run.
  std::optional<TimeMicros> NextDeadline() const;

 private:
  // run_stepper.cc: nodes
  void SetNode(size_t index, WorkState state, const std::string& cause);
  void Activate(size_t index);
  bool HasCondition(size_t index) const;
  void AwaitCondition(size_t index);
  void ArmNode(size_t index);
  std::string WaitsForText(size_t index, const std::vector<cawl::CompiledAsk>& asks) const;
  void DisarmNode(size_t index);
  bool TryOpen(size_t index);
  std::optional<TimeMicros> OpensAt(size_t index, size_t alternative) const;
  // `by`: the condition that opens it; null: it has none.
  void Open(size_t index, const std::vector<TermBinding>& bindings, std::string evidence,
            const std::string& cause, const ArmedCondition* by);
  bool CheckNode(size_t index);
  void NodeFailed(size_t index, const std::string& reason);
  void NodeFailedForGood(size_t index, const std::string& reason);
  void NodeImpossible(size_t index, const absl::Status& why);
  void CancelNode(size_t index, const std::string& reason);
  bool CheckDeadlines(size_t index);
  bool HasToGoOnLater() const;
  void GoOnLater();
  bool HasEntered() const;
  void Enter();
  bool CheckEnd();
  void SetVariables(const TermBinding& binding);
  void RearmWaiting(const std::set<std::string>& changed);

  // run_lacks.cc: why a time was over, for people
  std::string Lacks(size_t index, const std::vector<bool>& held) const;
  // Of a node whose condition did not open it.
  std::string NotOpened(size_t index) const;
  std::string RobotsKept(size_t node, size_t invocation) const;
  // Of an invocation, and of a node with all of its invocations that have not ended.
  std::string NotDone(size_t node, size_t invocation, const std::string& within) const;
  std::string NotDone(size_t index) const;

  // run_matches.cc: the matches that open a node, and their robots
  void TakeEvents(ArmedCondition* armed);
  size_t MostSolutions(size_t index) const;
  absl::StatusOr<std::vector<TermBinding>> Solutions(size_t index, const ArmedCondition& armed) const;
  bool HasToAskAgain(const ArmedCondition& armed) const;
  void AskAgain();
  // Better ones first. kOffersNot: it is offline or does not offer it, and its invocation waits until it does.
  enum class Fitness { kFree, kServesOthers, kOffersNot };
  struct Choice {
    Fitness fitness = Fitness::kFree;
    TermBinding match;
  };
  Fitness FitnessOf(size_t index, const RobotId& robot, const RunId& root) const;
  RobotId BestOf(const std::string& choose, const std::vector<std::string>& inputs, const TermBinding& given,
                 std::vector<RobotId> able) const;
  RobotId BestFor(size_t index, const TermBinding& given, std::vector<RobotId> able) const;
  Choice ChooseMatch(size_t index, const std::vector<TermBinding>& matches,
                     const std::set<RobotId>& taken) const;
  std::vector<TermBinding> ChooseMatches(size_t index, const ArmedCondition& armed,
                                         std::vector<TermBinding> solutions, std::set<RobotId>* busy) const;
  bool TryOpenWith(size_t index, const ArmedCondition& armed, std::set<RobotId>* busy);

  // run_links.cc: links
  void Arrive(const std::string& from, const std::string& to, bool closes_cycle);
  void DeadEnd(size_t link);
  bool Resolve(size_t index);
  void Reenter(size_t index);
  void NodeDone(size_t index);
  bool ResolvePendingLinks(size_t index);
  void FollowLinks(size_t index, const std::vector<size_t>& taken);

  // run_actions.cc: what a node does itself
  enum class Progress { kDone, kWaits, kEnded };
  bool IsOpening(size_t index) const;
  bool GoOnOpening(size_t index, bool at_once);
  bool WroteInThisRound() const;
  Progress DoActions(size_t index, bool when_done);
  absl::Status DoAction(size_t index, const cawl::Action& action);
  absl::Status Fail(size_t index, const cawl::Action& action);
  std::string DoOnFailure(size_t index);
  absl::StatusOr<std::vector<std::pair<size_t, TermBinding>>> EachBinding(size_t index) const;
  absl::StatusOr<std::vector<TermBinding>> BindingsOf(size_t index) const;
  static absl::Status TooManyBindings();
  std::vector<TermBinding> WithDoneValues(size_t index, std::vector<TermBinding> matches) const;
  void AddResults(size_t index, size_t number, TermBinding* binding) const;
  const InvocationState* DoneFor(size_t index, const TermBinding& binding, size_t invoke) const;
  absl::Status MakeInvocations(size_t index);
  absl::StatusOr<std::vector<TermBinding>> Compute(const cawl::Computation& computed,
                                                   const TermBinding* overlay) const;
  absl::Status Assign(size_t index, const cawl::Action& action);
  absl::Status TakeInputs(size_t node, size_t invocation);
  absl::Status CheckAssigned(size_t index, const TermBinding& values) const;
  absl::Status Notify(size_t index, const cawl::Action& action);
  absl::StatusOr<std::string> TextOf(const cawl::Text& text, const TermBinding* binding) const;
  // run_results.cc: results of what was invoked
  TermBinding ResultsOf(size_t node, size_t invocation, const TermBinding& given, std::string* note);
  TermBinding ResultsAt(const VariablePlace& place, size_t invoke, const TermBinding& given,
                        std::string* note) const;
  void KeepSolutions(const cawl::Action& action, std::vector<TermBinding> solutions);
  absl::Status MayWrite(size_t facts);
  absl::StatusOr<Term> ValueOf(const cawl::Word& word, const TermBinding* binding) const;
  absl::StatusOr<TermQuad> FactOf(const cawl::Constraint& fact, const TermBinding* binding) const;
  absl::StatusOr<std::vector<TermQuad>> FactsOf(const cawl::Action& action, const TermBinding& binding) const;
  absl::Status Tell(size_t index, const cawl::Action& action);
  absl::Status Withdraw(size_t index, const cawl::Action& action);
  absl::StatusOr<FactPattern> PatternOf(size_t index, const cawl::Constraint& fact, bool any_source,
                                        const TermBinding* binding) const;
  absl::StatusOr<std::vector<TermQuad>> ToldFacts(const cawl::Constraint& fact,
                                                  const absl::StatusOr<FactPattern>& wanted,
                                                  bool* of_others) const;
  void NoteTold(size_t index, const cawl::Action& action);
  // `by`: Subject of the node that tells it.
  // `continues`: it belongs to the same telling as the one before.
  void Write(bool tells, TermQuad fact, const cawl::Action* action, std::string by = "",
             bool continues = false);
  void WithdrawUntilEnd();
  // run_reservations.cc
  absl::Status Reserve(size_t index, const cawl::Action& action);
  absl::Status GiveBack(size_t index, const cawl::Action& action);
  absl::Status ReleaseReservation(size_t index, const cawl::Action& action);
  // run_compensation.cc: ext:compensate
  bool GoesOn() const { return run_.state == WorkState::kRunning && !run_.undoing; }
  void NoteDone(size_t index, bool late_only = false);
  void SettleLate(std::vector<LateStep>::iterator late);
  bool AwaitsOutcomes(TimeMicros* until_us) const;
  void TakeDoneSteps(const RunId& child);
  bool BeginUndo(WorkState outcome, const std::string& reason);
  void GatherDoneSteps();
  void Undo();
  bool StepUndone(const Run& child);
  std::string EndUndoing(const std::string& reason);
  // run_incidents.cc: incidents, and commands that were stopped
  bool WaitsForOperator(size_t index) const;
  void BeginIncident(size_t index, const std::string& reason);
  void LetRobotsGo(size_t index);
  void TakeBackRetry(size_t index);
  void CommandStopped(const CommandOwner& owner, OpenCommand stopped, bool begun, const std::string& reason);
  // run_retries.cc: ext:retry-delay and the like
  void DelayAttempt(const cawl::RetryPolicy& policy, int retries, const InvocationState& before,
                    InvocationState* next) const;
  bool IsTooEarly(size_t node, size_t invocation);
  void LeaveOutFailed(size_t node, size_t invocation, const rsel::Plan& plan, std::vector<RobotId>* robots,
                      std::string* why_not) const;

  // run_guards.cc: guards
  enum class Answer { kYes, kNo, kUnknown };
  bool IsKnown(ConditionHandle handle) const;
  Answer Ask(const Guard& guard, const TermBinding& match);
  static TermBinding MatchOf(const cawl::CompiledAsk& ask, const TermBinding& solution);
  absl::Status KeepGuard(size_t index, const ArmedCondition& by);
  bool NeedsGuard(size_t index) const;
  void SettleGuard(size_t index);
  void ArmGuard(size_t index, bool every);
  void DisarmGuard(std::optional<Guard>* guard);
  void WritesAtOpen(size_t index);
  absl::Status ArmHold(size_t index);
  bool HasBegun(size_t index) const;
  bool NothingBegun(size_t index) const;
  bool MayBegin(size_t node, size_t invocation, bool* changed);
  bool CheckHold(size_t index);
  void Interrupt(size_t index, const std::string& why);
  // What the node did was cancelled, and how that ended is not known yet.
  bool IsInterrupted(size_t index) const {
    return run_.nodes[index].state == WorkState::kRunning &&
           run_.nodes[index].reason.starts_with(kInterrupted);
  }
  bool IsOutOfReach(size_t node, size_t invocation) const;
  bool SettleInterrupt(size_t index);
  std::vector<size_t> InterruptLinks(size_t index) const;
  void Interrupted(size_t index, const std::string& why);
  // `kept`: invocations that are done, and are not done again.
  void WaitAgain(size_t index, const std::string& why, std::vector<InvocationState> kept = {});
  void PutBack(const std::map<std::string, ReplacedValue>& replaced);

  // run_invocations.cc, run_attempts.cc: invocations
  // As transitions name it: RUN/NODE, RUN/NODE/INVOCATION, of segments (graph/rdf/docent_iris.h).
  std::string Subject(size_t node) const;
  std::string Subject(size_t node, size_t invocation) const;
  void SetInvocation(size_t node, size_t invocation, WorkState state, const std::string& cause);
  bool GoOn(size_t node, size_t invocation);
  // `opening`: its node opens in this round, and its guard holds.
  bool TryDispatch(size_t node, size_t invocation, bool opening = false);
  bool ComesLater(size_t node, size_t invocation) const;
  bool AttemptsEnded(size_t node) const;
  void BeginTime(size_t node);
  void WaitForRobot(size_t node, size_t invocation, std::string why);
  bool WaitForOwnRobot(size_t node, size_t invocation, std::string_view why);
  std::optional<TimeMicros> GivenDeadline(size_t node, size_t invocation) const;
  std::optional<TimeMicros> OuterDeadline(size_t node, size_t invocation) const;
  std::optional<TimeMicros> DefaultDeadline(size_t node, size_t invocation) const;
  std::optional<TimeMicros> StepDeadline(size_t node, size_t invocation,
                                         std::optional<int64_t> timeout_ms) const;
  std::vector<std::string> InputsOf(size_t node, size_t invocation) const;
  std::vector<std::string> PartsWithValue(size_t node, const TermBinding& given) const;
  RobotId Preferred(size_t node, size_t invocation, const std::vector<std::string>& inputs,
                    std::vector<RobotId> able) const;
  bool StartSubflow(size_t node, size_t invocation);
  bool SendReady(size_t node, size_t invocation);
  bool HasItsRobot(size_t node, size_t invocation);
  bool MaySend(size_t node, size_t invocation, const std::string& operation, std::vector<Occupation>* taken,
               std::string* why_not) const;
  void SendInstruction(size_t node, size_t invocation, const rsel::Instruction& instruction);
  void Resend(size_t node, size_t invocation, const OpenCommand& lost);
  bool Decide(size_t node, size_t invocation, OpenCommand open, const std::string* gone = nullptr);
  void SettleHandler(size_t node, size_t invocation);
  void InvocationFailed(size_t node, size_t invocation, const std::string& reason);
  void BeginAgain(size_t node, size_t invocation);
  bool CheckOverdue(size_t node, size_t invocation);
  void CommandOverdue(size_t node, size_t invocation, const CommandId& command);
  void LeaveRobot(size_t node, size_t invocation);
  void CancelInvocation(size_t node, size_t invocation, const std::string& reason);
  void LetEnd(size_t node, size_t invocation, const OpenCommand& open);
  void LetCommandsEnd(size_t node, size_t invocation);
  static void ForgetLost(InvocationState* invocation);
  std::optional<Term> Value(const std::string& name, const TermBinding* overlay) const;

  Engine::Core& core_;
  Run& run_;
  const cawl::Flow& flow_;
  const FlowGraph& graph_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_STEPPER_H_
