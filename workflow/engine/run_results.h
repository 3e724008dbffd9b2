// What a flow gives back when it is done (ext:output). Pure function. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_RESULTS_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_RESULTS_H_

#include "workflow/engine/state/run_state.h"

namespace docent::engine {

// The results that the flow declares and that have a value, by the names that they have outside.
TermBinding FlowResults(const Run& run);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_RESULTS_H_
