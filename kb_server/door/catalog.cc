#include "kb_server/door/catalog.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/document_name.h"
#include "graph/store/server_graphs.h"

namespace docent::server {

std::string OntologyGraph(const std::string& name) {
  return Concat(kModuleGraphs, NameInIri(name));
}

cawl::DocumentPtr Catalog::FindWorkflow(std::string_view name) const {
  const auto found = std::lower_bound(
      workflows.begin(), workflows.end(), name,
      [](const auto& workflow, std::string_view wanted) { return workflow.first->name.value < wanted; });
  return found != workflows.end() && found->first->name.value == name ? found->first : nullptr;
}

}  // namespace docent::server
