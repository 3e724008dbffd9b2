// The workflow that RobotServices.Invoke runs: one node that invokes one robot service. Not for other
// folders. Pure functions; any thread.
#ifndef DOCENT_WORKFLOW_ENGINE_SERVICE_WORKFLOW_H_
#define DOCENT_WORKFLOW_ENGINE_SERVICE_WORKFLOW_H_

#include <string>

#include "workflow/cawl/ast.h"

namespace docent::engine {

cawl::DocumentPtr ServiceWorkflow(const std::string& process);
// The service of a document that ServiceWorkflow made; empty: somebody wrote the document.
std::string ServiceOf(const cawl::Document& document);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_SERVICE_WORKFLOW_H_
