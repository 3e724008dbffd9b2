// The engine's whole state between two turns as a value: what a snapshot keeps, so that a start need not
// replay every turn. An engine into which it was put back decides as the one from which it was taken.
//
// What follows from the rest is not in it: queues and timers are made anew, and the facts of runs stand in
// the graph. Taking it is a copy of the live runs; encoding it may be done on any thread.
#ifndef DOCENT_WORKFLOW_ENGINE_ENGINE_STATE_H_
#define DOCENT_WORKFLOW_ENGINE_ENGINE_STATE_H_

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/limits.h"
#include "workflow/engine/engine_core.h"

namespace docent::engine {

struct EngineState {
  std::map<RunId, Run> runs;
  std::vector<KeptRun> kept;  // of ended runs, the one that ended first in front
  std::map<std::string, Deployment> deployments;
  rsel::ServiceRegistry services;
  RobotLedger::Ending ending;
  EventWaits::Joint joint_events;
  Activations::State activations;
  std::map<CommandId, OpenNotification> outbox;
  std::map<std::string, PausedWorkflow> paused_workflows;
  std::map<RobotId, TimeMicros> last_used;
  ConditionHandle next_handle = 1;
  uint64_t next_run = 1;
};

// INTERNAL for a state in the middle of a turn.
absl::StatusOr<std::string> EncodeEngineState(const EngineState& state);

// The facts about a run that the graph of the same snapshot holds, in any order.
using RunFactsLookup = std::function<std::vector<Quad>(const RunId& run)>;
// Interns no term that is not in the graph. DATA_LOSS for bytes that EncodeEngineState did not make; INTERNAL where a document that was good before is
// not under these limits.
absl::StatusOr<EngineState> DecodeEngineState(std::string_view bytes, const Limits& limits,
                                              Dictionary* dictionary, const RunFactsLookup& facts);

// The conditions that this state waits for, in the order in which they were armed.
std::vector<ConditionRequest> ArmedConditions(const EngineState& state);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_ENGINE_STATE_H_
