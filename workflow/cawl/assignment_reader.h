// <ext:assign>, and the expression of <ext:input> (ast.h): queries that are ready to be asked. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_ASSIGNMENT_READER_H_
#define DOCENT_WORKFLOW_CAWL_ASSIGNMENT_READER_H_

#include "graph/base/limits.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Mistakes are reported at their places; the query of a computation is null after one in it.
void ReadAssignment(const xml::Element& element, const Limits& limits, xml::ElementReader* reader,
                    Action* out);

// `expression`: an attribute of the element. `output`: what its value is called.
void ReadExpression(const xml::Element& element, const Text& expression, const Text& output,
                    const Limits& limits, xml::ElementReader* reader, Computation* out);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ASSIGNMENT_READER_H_
