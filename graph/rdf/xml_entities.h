// The document type definition that OWL editors write (Protégé, the OWL API): entities that stand for namespaces,
//
//   <!DOCTYPE rdf:RDF [ <!ENTITY owl "http://www.w3.org/2002/07/owl#" > ]>   … rdf:resource="&owl;Class"
//
// put into the text in their places. Nothing is fetched, and nothing can grow: an entity's text may not name entities.
// Any thread.
#ifndef DOCENT_GRAPH_RDF_XML_ENTITIES_H_
#define DOCENT_GRAPH_RDF_XML_ENTITIES_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/rdf/parser.h"

namespace docent {

// nullopt: there is no document type definition, or it is refused and `diagnostics` says where and why: external or
// parameter entities, declarations of anything else, an entity whose text holds & % or <, a text that would grow beyond
// document_bytes. Lines of the result are those of `text`.
std::optional<std::string> ExpandEntities(std::string_view text, const ParseRdfOptions& options,
                                          Diagnostics* diagnostics);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_XML_ENTITIES_H_
