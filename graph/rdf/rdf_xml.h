// RDF/XML through Raptor2: reading (parser.cc) and writing (serializer.cc). Nothing of Raptor shows here.
//
// Raptor worlds are kept in a pool: making and freeing one calls libxml2's global initialisation and
// clean-up, which is not safe beside other threads (helgrind: 63 races; pooled: none), so they are made under
// a mutex and never freed. Any thread.
#ifndef DOCENT_GRAPH_RDF_RDF_XML_H_
#define DOCENT_GRAPH_RDF_RDF_XML_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/parser.h"
#include "graph/rdf/place_recorder.h"

namespace docent {

// `text` must be well-formed UTF-8. Raptor sees no document type definition: one that only declares entities by their
// text, as OWL editors write it, is expanded before (xml_entities.h), any other is refused. Refused is any declared
// encoding but UTF-8, too (another could hide one). `places`: where quads are recorded, if it is not null.
ParsedRdf ParseRdfXml(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places = nullptr);

// INVALID_ARGUMENT where RDF/XML cannot say it: a named graph, or a predicate whose end is not an XML name.
absl::StatusOr<std::string> WriteRdfXml(const std::vector<TermQuad>& quads,
                                        const std::vector<std::pair<std::string, std::string>>& prefixes);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_RDF_XML_H_
