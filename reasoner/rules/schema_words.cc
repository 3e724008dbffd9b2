#include "reasoner/rules/schema_words.h"

#include <string>

#include "graph/rdf/vocabulary.h"

namespace docent::rules {

bool IsSchemaPattern(std::string_view predicate_iri, std::string_view object_iri) {
  const auto of_standard = [](std::string_view iri) {
    return iri.starts_with(kOwlNs) || iri.starts_with(kRdfsNs) || iri.starts_with(kRdfNs);
  };
  if (predicate_iri == kRdfType) return of_standard(object_iri);
  if (predicate_iri == "http://www.w3.org/2002/07/owl#differentFrom") return false;
  for (const std::string_view word : {"listNode", "longList"}) {
    if (predicate_iri.ends_with(word) && predicate_iri == DocentIri(word)) return true;
  }
  if (predicate_iri.starts_with(kOwlNs)) return true;
  for (const std::string_view word : {"subClassOf", "subPropertyOf", "domain", "range"}) {
    if (predicate_iri.starts_with(kRdfsNs) && predicate_iri.substr(kRdfsNs.size()) == word) return true;
  }
  return predicate_iri.starts_with(kRdfNs) &&
         (predicate_iri.substr(kRdfNs.size()) == "first" || predicate_iri.substr(kRdfNs.size()) == "rest");
}

}  // namespace docent::rules
