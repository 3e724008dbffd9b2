// Types of what goes from step to step of robot services, and of what is given to an invoked one. Pure functions; any thread.
#ifndef DOCENT_WORKFLOW_RSEL_TYPE_CHECKS_H_
#define DOCENT_WORKFLOW_RSEL_TYPE_CHECKS_H_

#include <vector>

#include "absl/status/status.h"
#include "graph/base/diagnostic.h"
#include "workflow/rsel/feasibility.h"
#include "workflow/rsel/instruction_handler.h"
#include "workflow/rsel/service_registry.h"

namespace docent::rsel {

struct ServiceTypes {
  PartTypes inputs, outputs;
};
// What a registered service takes and gives: the types of its messages' parts, and where they say none, those of the parts of
// the robots' operations that take or give the value.
ServiceTypes TypesOf(const Plan& plan, const std::vector<OfferedOperation>& offered);

// Warnings with places in `document`, of the rule type-clash: a constant or a name of the process that is given to a part of a
// type of which it cannot be; a part of the output message of which what is kept under its name cannot be. `registry` knows
// the document's processes and those that it reuses; `offered` may be empty.
Diagnostics CheckTypes(const Document& document, const ServiceRegistry& registry,
                       const std::vector<OfferedOperation>& offered);

// INVALID_ARGUMENT, naming what the service takes: a part without argument.
absl::Status CheckComplete(const Plan& plan, const PartTypes& input_types, const Arguments& arguments);
// The same for an argument that the service does not take, one that is missing, one whose value is not of the type of its part.
absl::Status CheckArguments(const Plan& plan, const PartTypes& input_types, const Arguments& arguments);

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_TYPE_CHECKS_H_
