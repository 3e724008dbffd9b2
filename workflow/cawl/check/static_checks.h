// Static verification of a CAWL document that has no errors: what will go wrong when it runs, or never happen. All
// findings are warnings with a rule (rule_names.h); those for which a remedy is evident have a fix. Those that may take long
// end early by their cancellation (null: never), and what they have found then is not all. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_STATIC_CHECKS_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_STATIC_CHECKS_H_

#include <cstddef>

#include "graph/base/cancellation.h"
#include "workflow/cawl/ast.h"
#include "workflow/cawl/check/environment.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Beyond, what needs every pair of a flow's nodes is not looked for: races, variables that are never set.
inline constexpr size_t kMaxPairedNodes = 500;

// Whether a check is to end. `cancellation`: null, it is not. It looks at the clock.
inline bool IsOver(Cancellation* cancellation) {
  return cancellation != nullptr && !cancellation->CheckNow().ok();
}

// Conditions that can never hold or always hold, activators that can never rise, values and types that do not go
// together, in conditions and in what is told and withdrawn. `environment` null: what needs an ontology is left out.
void CheckConditions(const Document& document, const Environment* environment, xml::ElementReader* reader,
                     Cancellation* cancellation);

// Activators that the facts of their own runs start again.
void CheckFeedback(const Document& document, xml::ElementReader* reader);

// Names of inputs and results that a flow of the document, or a robot service, does not have. `environment` null: what an
// operation takes and gives is not known.
void CheckExchange(const Document& document, const Environment* environment, xml::ElementReader* reader,
                   Cancellation* cancellation);

// Nodes that may command one robot, or set one variable, at the same time.
void CheckRaces(const Document& document, xml::ElementReader* reader, Cancellation* cancellation);

// Flows: loops that nothing slows down, joins that never open, what a node does when it opens and undoes at once.
void CheckRuns(const Document& document, xml::ElementReader* reader, Cancellation* cancellation);

// Variables that are used where they can have no value. `environment` null: what an invoked operation gives and takes is not
// known.
void CheckValues(const Document& document, const Environment* environment, xml::ElementReader* reader,
                 Cancellation* cancellation);

// Values of variables of a type that does not suit. `environment` null: by the names of types alone.
void CheckTypes(const Document& document, const Environment* environment, xml::ElementReader* reader,
                Cancellation* cancellation);

// Names of datatypes that XML Schema does not have.
void CheckDatatypes(const Document& document, xml::ElementReader* reader);

// Timeouts that end nothing, and attempts that come too late.
void CheckTimeouts(const Document& document, const Environment* environment, xml::ElementReader* reader);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_STATIC_CHECKS_H_
