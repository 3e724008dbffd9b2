// Takes one run as far as it can go now: opens nodes whose conditions hold, gives invocations to robots,
// follows links, ends the run. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_STEPPER_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_STEPPER_H_

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "workflow/engine/engine_core.h"

namespace docent::engine {

// The key variables with which a node's condition is armed.
std::vector<std::string> NodeKeys(const cawl::CompiledAsk& ask);

class RunStepper {
 public:
  RunStepper(Engine::Core* core, Run* run) : core_(*core), run_(*run), flow_(run->Flow()) {}

  // A new run: sets variables and follows the links out of the source.
  void Begin(const std::string& cause);
  // Everything that is possible now. Returns when nothing more changes.
  void Advance();
  // What became of a command of this run.
  void Report(const CommandOwner& owner, const CommandReport& report);
  // A subflow ended.
  void ChildEnded(const CommandOwner& owner, const Run& child);
  // Ends the run; what is under way is cancelled.
  void End(WorkState state, const std::string& reason);

  // The earliest deadline of this run.
  std::optional<TimeMicros> NextDeadline() const;

 private:
  // run_stepper.cc: nodes
  void SetNode(size_t index, WorkState state, const std::string& cause);
  void Arrive(const std::string& from, const std::string& to, bool closes_cycle);
  void DeadEnd(const std::string& from, const std::string& to);
  void Resolve(size_t index);
  void Activate(size_t index);
  void Reenter(size_t index);
  void ArmNode(size_t index);
  void DisarmNode(size_t index);
  bool TryOpen(size_t index);
  void TakeEvents(ArmedCondition* armed);
  std::vector<TermBinding> Solutions(const ArmedCondition& armed) const;
  bool TryOpenWith(size_t index, const ArmedCondition& armed, std::set<RobotId>* busy);
  void Open(size_t index, const std::vector<TermBinding>& bindings, std::string evidence,
            const std::string& cause);
  bool CheckNode(size_t index);
  void NodeDone(size_t index);
  void NodeFailed(size_t index, const std::string& reason);
  void CancelNode(size_t index, const std::string& reason);
  bool ResolvePendingLinks(size_t index);
  void FollowLinks(size_t index, const std::vector<size_t>& taken);
  bool CheckDeadlines(size_t index);
  bool CheckEnd();
  void SetVariables(const TermBinding& binding);

  // run_invocations.cc: invocations
  // As transitions name it: RUN/NODE, RUN/NODE/INVOCATION, of segments (graph/rdf/docent_iris.h).
  std::string Subject(size_t node) const;
  std::string Subject(size_t node, size_t invocation) const;
  void SetInvocation(size_t node, size_t invocation, WorkState state, const std::string& cause);
  bool TryDispatch(size_t node, size_t invocation);
  std::vector<std::string> InputsOf(size_t node, size_t invocation) const;
  bool StartSubflow(size_t node, size_t invocation);
  void SendReady(size_t node, size_t invocation);
  void SendInstruction(size_t node, size_t invocation, const rsel::Instruction& instruction);
  void Resend(size_t node, size_t invocation, const OpenCommand& lost, const std::string& incarnation);
  void SettleHandler(size_t node, size_t invocation);
  void InvocationFailed(size_t node, size_t invocation, const std::string& reason);
  void CancelInvocation(size_t node, size_t invocation, const std::string& reason);
  void CancelCommands(InvocationState* invocation);
  std::optional<Term> Value(const std::string& name, const TermBinding* overlay) const;

  Engine::Core& core_;
  Run& run_;
  const cawl::Flow& flow_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_STEPPER_H_
