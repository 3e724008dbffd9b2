#include "kb_server/door/catalog.h"

#include "absl/strings/str_cat.h"
#include "graph/rdf/document_name.h"

namespace docent {

std::string OntologyGraph(const std::string& name) {
  return absl::StrCat("https://w3id.org/docent/ontology/", NameInIri(name));
}

}  // namespace docent
