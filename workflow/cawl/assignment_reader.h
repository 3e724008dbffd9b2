// <ext:assign> (ast.h, Action): its SELECT or expression, as a query that is ready to be asked. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_ASSIGNMENT_READER_H_
#define DOCENT_WORKFLOW_CAWL_ASSIGNMENT_READER_H_

#include "graph/base/limits.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Mistakes are reported at their places; out->query is null after one in the query.
void ReadAssignment(const xml::Element& element, const Limits& limits, xml::ElementReader* reader,
                    Action* out);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ASSIGNMENT_READER_H_
