#include "kb_server/robots/operation_facts.h"

#include <string_view>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"

namespace docent::server {

OperationFacts::OperationFacts(const GraphReader& graph, const std::string& robot, std::string operation)
    : graph_(graph), own_(graph.In(robot)), operation_(std::move(operation)) {}

std::vector<std::string> OperationFacts::Capabilities() const {
  return All("capability");
}

std::optional<std::vector<std::string>> OperationFacts::Inputs() const {
  if (own_.Object(operation_, DocentIri("inputsKnown")) != "true") return std::nullopt;
  return All("input");
}

std::vector<std::string> OperationFacts::Outputs() const {
  return All("output");
}

rsel::PartTypes OperationFacts::InputTypes() const {
  return Types("inputPart");
}

rsel::PartTypes OperationFacts::OutputTypes() const {
  return Types("outputPart");
}

engine::Occupation OperationFacts::Occupies() const {
  const std::vector<std::string> resources = All("occupies");
  return {resources.begin(), resources.end()};
}

std::string OperationFacts::Description() const {
  return own_.Object(operation_, Concat(kRdfsNs, "comment"));
}

bool OperationFacts::Idempotent() const {
  std::vector<Term> said = own_.Objects(operation_, DocentIri("idempotent"));
  if (said.empty()) said = graph_.Objects(operation_, DocentIri("idempotent"));
  return said.size() == 1 && said.front().lexical == "true";
}

std::vector<std::string> OperationFacts::All(std::string_view local) const {
  std::vector<std::string> out;
  for (const Term& object : own_.Objects(operation_, DocentIri(local))) out.push_back(object.lexical);
  return out;
}

rsel::PartTypes OperationFacts::Types(std::string_view local) const {
  rsel::PartTypes types;
  for (const Term& part : own_.Objects(operation_, DocentIri(local))) {
    types[own_.Object(part.lexical, DocentIri("partName"))] =
        own_.Object(part.lexical, DocentIri("partType"));
  }
  return types;
}

}  // namespace docent::server
