// An operation of a service elsewhere as a node of a workflow can invoke it: what an import of services gives. Values and pure
// functions; any thread.
#ifndef DOCENT_WORKFLOW_TEMPLATES_NODE_TEMPLATE_H_
#define DOCENT_WORKFLOW_TEMPLATES_NODE_TEMPLATE_H_

#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"

namespace docent::templates {

struct TemplatePart {
  std::string name;
  std::string type;  // IRI of a class or datatype; empty: anything
  std::string called =
      {};  // what the service calls it, where that cannot be the name of a part; empty: as `name`

  friend bool operator==(const TemplatePart&, const TemplatePart&) = default;
};

struct NodeTemplate {
  std::string operation;
  std::string service;   // port type, gRPC service, or robot's label
  std::string endpoint;  // where it is served; empty: not told
  std::vector<TemplatePart> inputs, outputs;
  std::string documentation;
  std::string cawl;  // <node> with its <message> elements, ready to paste into a <flow>
};

struct ImportedTemplates {
  std::vector<NodeTemplate> templates;
  Diagnostics diagnostics;  // errors: nothing was read
};

// Adds a part: its name without what a part's name may not hold ("user-name" becomes user_name), unlike those that are there. What
// the service calls it is kept.
// False, and nothing is added, where there are import_parts.
bool AddPart(std::string_view name, std::string type, std::vector<TemplatePart>* parts);

// Whether an operation may have this name in a document.
bool IsOperationName(std::string_view name);

// Writes `cawl` of each: a node named as the operation (operation_2 where there is one of this name), with the messages
// OPERATIONRequest and OPERATIONReply. A part that the service calls otherwise is a variable of the node, and ext:input or
// ext:output says which.
void WriteCawl(std::vector<NodeTemplate>* templates);

}  // namespace docent::templates

#endif  // DOCENT_WORKFLOW_TEMPLATES_NODE_TEMPLATE_H_
