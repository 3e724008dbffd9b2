// Whether a value is of the type that a variable declares. Pure function.
#ifndef DOCENT_WORKFLOW_CAWL_VALUE_TYPE_H_
#define DOCENT_WORKFLOW_CAWL_VALUE_TYPE_H_

#include <optional>
#include <string>

#include "graph/rdf/term.h"

namespace docent::cawl {

// Why `value` is not of `type`, for people: "is "x", and its type is xsd:integer"; empty: it is, or there is no type. A
// datatype takes its own literals; a numeric one also those of the types that are promoted to it (XPath 2.0, appendix B.1). A
// class takes every resource: which class it is in is not asked.
std::string TypeFault(const Term& value, const std::optional<Term>& type);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_VALUE_TYPE_H_
