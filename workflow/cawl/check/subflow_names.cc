#include "workflow/cawl/check/subflow_names.h"

#include "graph/base/text.h"

namespace docent::cawl {

std::vector<std::string> SubflowNames(const Document& document) {
  std::vector<std::string> names = {document.name.value};
  for (const Flow& flow : document.flows) names.push_back(Concat(document.name.value, "/", flow.name.value));
  return names;
}

}  // namespace docent::cawl
