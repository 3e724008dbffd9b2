// The terms that the facts of every run are made of, each looked up in the dictionary once: made from text at
// every change they were a third of the writer's work.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_RUN_TERMS_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_RUN_TERMS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "graph/rdf/dictionary.h"
#include "workflow/engine/state/run_state.h"

namespace docent::engine {

// In the order of the table in run_terms.cc.
enum class RunTerm : uint8_t {
  kRunsGraph,
  kType,
  kRun,
  kNodeInstance,
  kInvocation,
  kStartedAtTime,
  kEndedAtTime,
  kWorkflow,
  kFlow,
  kRunState,
  kReason,
  kParentRun,
  kUsesRobot,
  kHasVariable,
  kVariableName,
  kVariableValue,
  kOfRun,
  kNodeName,
  kPosition,
  kNodeState,
  kWaitsFor,
  kFiredBecause,
  kFiredAt,
  kSince,
  kOfNode,
  kOperation,
  kInvocationState,
  kRobot,
  kChildRun,
  kCommand,
  kStep,
  kProgress,
  kStepDone,
  kStepFailed,
  kStepRunning,
  kHeldBy,
  kHeldFor,
  kEndingCommand,
  kHasResult,
  kPausedAt,
  kPauseReason,
  kNotBefore,
  kOpensAt,
  kWantedCapability,
  kWantedRobot,
  kForValue,
  kLoad,
  kLastUsed,
};

// Writer thread only.
class RunTerms {
 public:
  explicit RunTerms(Dictionary* dictionary) : dictionary_(*dictionary) {}

  Dictionary& dictionary() { return dictionary_; }
  // Interned when first asked for, so that ids are given in the order in which facts need them.
  TermId Of(RunTerm term);
  TermId Of(WorkState state);
  // The turn is refused: what it interned is gone.
  void Forget() {
    terms_.fill(TermId());
    states_.fill(TermId());
  }

 private:
  Dictionary& dictionary_;
  std::array<TermId, static_cast<size_t>(RunTerm::kLastUsed) + 1> terms_;
  std::array<TermId, static_cast<size_t>(WorkState::kIncident) + 1> states_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_RUN_TERMS_H_
