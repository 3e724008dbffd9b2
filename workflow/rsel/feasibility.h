// Can the robots that are here do this service? And the generator: a document from what a robot can do. Any thread.
#ifndef DOCENT_WORKFLOW_RSEL_FEASIBILITY_H_
#define DOCENT_WORKFLOW_RSEL_FEASIBILITY_H_

#include <string>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/base/ids.h"
#include "workflow/rsel/service_registry.h"

namespace docent::rsel {

// An operation as a robot's adapter describes it (RobotAdapter.Describe).
struct OfferedOperation {
  RobotId robot;
  std::string name;
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  bool idempotent = false;
  std::string description;
  bool inputs_known = true;  // false: `inputs` says nothing
  PartTypes input_types = {}, output_types = {};
  std::vector<std::string> capabilities = {};  // IRIs of the classes that it is of
};

// The robots that offer every operation of the plan, in order of their IRIs.
std::vector<RobotId> CapableRobots(const Plan& plan, const std::vector<OfferedOperation>& offered);

// Warnings with places in `document`: an operation that no robot offers (with the nearest that one does), an input
// part that the operation does not have, one that it has and that is not given, a result that it does not describe (where it
// describes any), a clash of types (type_checks.h), a process that no single robot can do as a whole. `registry` knows the
// document's processes and those that it reuses.
Diagnostics CheckFeasibility(const Document& document, const ServiceRegistry& registry,
                             const std::vector<OfferedOperation>& offered);

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_FEASIBILITY_H_
