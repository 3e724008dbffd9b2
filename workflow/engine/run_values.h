// Values that an operator gives to variables of a run: whether the run has the variable, and it can have the value. Pure.
// Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_VALUES_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_VALUES_H_

#include <string>

#include "absl/status/status.h"
#include "workflow/engine/state/run_state.h"

namespace docent::engine {

// `name`: "user" or "request.booth". INVALID_ARGUMENT: it is not declared and has no value, or `value` is not of its type.
absl::Status CheckValue(const Run& run, const std::string& name, const Term& value);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_VALUES_H_
