// Steering: what operators ask of live runs and of workflows. Pause and resume, incidents settled, variables set, commands of
// a robot cancelled; runs
// cancelled.
//
//   pause   Of a run: it opens no node and sends no command, nor do the runs that are nested in it, until it is resumed. Its
//           times of waiting stand still meanwhile; a command that is under way has its own time, which goes on.
//           Of a workflow: each live run of it is paused, and it starts none. Activations are held back; those that still
//           hold when it is resumed start their runs then.
//
// Private to this folder. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_STEERING_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_STEERING_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "workflow/engine/engine_core.h"

namespace docent::engine {

// NOT_FOUND: no such run, workflow or node. FAILED_PRECONDITION: it is not in the state for that. INVALID_ARGUMENT: a value
// that the variable cannot have. Requests that start runs are not looked at.
absl::Status CheckSteering(const Engine::Core& core, const RunRequest& request, const RobotDirectory* robots);

// Does it; what its kind needs not hold any more is left as it is.
void Steer(Engine::Core* core, const RunRequest& request);

// Starts the runs that its activator held back.
void StartHeldBack(Engine::Core* core, const std::string& workflow);

// What the graph is told of a workflow that is paused.
std::vector<Quad> PausedWorkflowFacts(const std::string& workflow, const PausedWorkflow& pause,
                                      RunTerms* terms);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_STEERING_H_
