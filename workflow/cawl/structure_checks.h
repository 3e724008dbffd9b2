// Structural checks between the parts of one CAWL document. Mistakes go to the reader. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_STRUCTURE_CHECKS_H_
#define DOCENT_WORKFLOW_CAWL_STRUCTURE_CHECKS_H_

#include <string>
#include <vector>

#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Names: declared once in their scope; each use names something ($variables, parts, messages that type variables,
// names in expressions, the activator's flow, forEach's variables).
void CheckNames(const Document& document, xml::ElementReader* reader);

// ?name in a condition, ext:while or ext:while-holds of a node where the run has a value of that name from its beginning on.
void CheckFreeNames(const Document& document, xml::ElementReader* reader);

// Rules with ext:for: see lasting_rules.h.
void CheckLastingRules(const Document& document, xml::ElementReader* reader);

// Each flow's graph: links between nodes that there are, every node reachable from the source and with a way to the
// sink, no cycle without `while`, join conditions over predecessors, no flow that contains itself.
void CheckFlows(const Document& document, xml::ElementReader* reader);

// The free variables (?x) of a condition outside of `not`: what its match may bind.
std::vector<std::string> BoundBy(const Condition& condition);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_STRUCTURE_CHECKS_H_
