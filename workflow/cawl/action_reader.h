// What a node does itself (ast.h, Action): <ext:tell>, <ext:withdraw> and <ext:assign> as they are written; and <ext:input> and <ext:output>. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_ACTION_READER_H_
#define DOCENT_WORKFLOW_CAWL_ACTION_READER_H_

#include "graph/base/limits.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Mistakes are reported; what could be read is kept.
Action ReadAction(const xml::Element& element, Action::Kind kind, const Limits& limits,
                  xml::ElementReader* reader);

Input ReadInput(const xml::Element& element, const Limits& limits, xml::ElementReader* reader);

// <ext:output>, of an invoke or a flow.
Output ReadOutput(const xml::Element& element, xml::ElementReader* reader);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ACTION_READER_H_
