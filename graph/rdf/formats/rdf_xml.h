// RDF/XML: a reader on libxml2's SAX2 (rdf_xml_reader.h) and a writer (rdf_xml_writer.cc), of our own. This
// header does not expose libxml2. Any thread.
//
// Why they are not Raptor: Raptor 2.0.15 collapses white space in attributes, forgets xml:lang of
// property attributes, resolves wrongly against bases with a query, a fragment or no path, changes XML
// literals, silently drops misplaced text, and refuses entities that name entities, and documents above 10
// MB; its writer says rdf:li and other words of the syntax as if they were properties. (Seen November 2026.)
#ifndef DOCENT_GRAPH_RDF_FORMATS_RDF_XML_H_
#define DOCENT_GRAPH_RDF_FORMATS_RDF_XML_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/place_recorder.h"

namespace docent {

// `text` must be well-formed UTF-8 without a byte order mark, whatever encoding it declares. `places`
// receives the places of quads; may be null.
ParsedRdf ParseRdfXml(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places = nullptr);

// INVALID_ARGUMENT for what RDF/XML cannot express: a predicate without an XML name at its end or with a
// meaning of its own in RDF/XML (rdf:li), a character that XML has not. Graphs are not written.
absl::StatusOr<std::string> WriteRdfXml(const std::vector<TermQuad>& quads,
                                        const std::vector<std::pair<std::string, std::string>>& prefixes);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_RDF_XML_H_
