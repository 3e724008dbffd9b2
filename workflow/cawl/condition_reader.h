// <condition> and what stands in it: the part of document_reader.h that is about context. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CONDITION_READER_H_
#define DOCENT_WORKFLOW_CAWL_CONDITION_READER_H_

#include "graph/base/limits.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

Condition ReadCondition(const xml::Element& element, const Limits& limits, xml::ElementReader* reader);

// <constraint>: one subject, verb and object.
Constraint ReadConstraint(const xml::Element& element, xml::ElementReader* reader);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CONDITION_READER_H_
