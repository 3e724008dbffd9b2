// What becomes of the firings of an activator: a run, a place in a queue, or nothing, as its ext:mode says
// (workflow/cawl/ast.h). Private to this folder. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_ACTIVATOR_MODES_H_
#define DOCENT_WORKFLOW_ENGINE_ACTIVATOR_MODES_H_

#include <string>

#include "workflow/engine/engine_core.h"

namespace docent::engine {

// Bindings of an activator's key variables appeared or disappeared.
void Activate(Engine::Core* core, const std::string& workflow, const ConditionEdge& edge);

// A run that may be an activator's ended: the next firing of its key that waits starts its run.
void ActivatedRunEnded(Engine::Core* core, const RunId& run);

// The workflow may start runs again: those that its activator held back, and firings that wait.
void StartHeldBack(Engine::Core* core, const std::string& workflow);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_ACTIVATOR_MODES_H_
