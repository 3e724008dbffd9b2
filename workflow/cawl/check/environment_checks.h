// A parsed CAWL document against what there is: operations, services, and the words of the ontology. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_ENVIRONMENT_CHECKS_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_ENVIRONMENT_CHECKS_H_

#include "graph/base/cancellation.h"
#include "workflow/cawl/ast.h"
#include "workflow/cawl/check/environment.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// As CheckDocument (check.h) says. `cancellation`: ends it early; null: nothing does.
void CheckAgainst(const Document& document, const Environment& environment, xml::ElementReader* reader,
                  Cancellation* cancellation);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_ENVIRONMENT_CHECKS_H_
