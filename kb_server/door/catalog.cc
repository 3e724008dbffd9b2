#include "kb_server/door/catalog.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/rdf/document_name.h"

namespace docent::server {

std::string OntologyGraph(const std::string& name) {
  return absl::StrCat("https://w3id.org/docent/ontology/", NameInIri(name));
}

cawl::DocumentPtr Catalog::FindWorkflow(std::string_view name) const {
  const auto found = std::lower_bound(
      workflows.begin(), workflows.end(), name,
      [](const auto& workflow, std::string_view wanted) { return workflow.first->name.value < wanted; });
  return found != workflows.end() && found->first->name.value == name ? found->first : nullptr;
}

}  // namespace docent::server
