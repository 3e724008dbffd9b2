// Values of the variables of a run: whether the run has the variable, and it can have the value. Pure. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_VALUES_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_VALUES_H_

#include <string>

#include "absl/status/status.h"
#include "workflow/engine/state/run_state.h"

namespace docent::engine {

// A place of a document that sees variables: a flow, with those of the activator that starts it, or a node of the flow.
struct VariablePlace {
  const cawl::Document& document;
  const cawl::Flow& flow;
  const cawl::Node* node = nullptr;
};

// Why the variable of this name ("user" or "request.booth") cannot have `value`: "$n is of type xsd:integer, and "many" is of
// type xsd:string". Empty: it can, or no type is declared. A datatype takes its own literals, numbers that it has among its
// values, and those that are promoted to it (rsel::TypeFault); a class takes every resource: in which class it is is not asked.
std::string TypeFault(const VariablePlace& place, const std::string& name, const Term& value);
// The first of those of `values`, in order of their names.
std::string TypeFault(const VariablePlace& place, const TermBinding& values);

// Of a value that an operator gives. INVALID_ARGUMENT: the variable is not declared and has no value, or `value` is not of its
// type.
absl::Status CheckValue(const Run& run, const std::string& name, const Term& value);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_VALUES_H_
