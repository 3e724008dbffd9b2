// Names by which other documents invoke the flows of a document (<invoke subflow="…"/>). Pure function; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_SUBFLOW_NAMES_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_SUBFLOW_NAMES_H_

#include <string>
#include <vector>

#include "workflow/cawl/ast.h"

namespace docent::cawl {

// "BoothGuide", the document's own name, and "BoothGuide/FLOW" of each of its flows.
std::vector<std::string> SubflowNames(const Document& document);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_SUBFLOW_NAMES_H_
