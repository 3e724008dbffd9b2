// RDF/XML: reading, by a reader of our own (rdf_xml_reader.h), and writing, by Raptor2 (rdf_xml_writer.cc). Nothing of
// libxml2 or Raptor shows here. Any thread.
//
// Why not Raptor for reading: Raptor 2.0.15 collapses white space in attributes, forgets xml:lang of property attributes,
// resolves wrongly against bases with a query, a fragment or no path, changes XML literals, drops text that may not stand
// where it does, and refuses entities that name entities, and documents above 10 MB. (Seen November 2026.)
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

// `text` must be well-formed UTF-8 without a byte order mark, whatever encoding it declares. `places`: where quads are
// recorded, if it is not null.
ParsedRdf ParseRdfXml(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places = nullptr);

// INVALID_ARGUMENT where RDF/XML cannot say it: a named graph, or a predicate whose end is not an XML name.
absl::StatusOr<std::string> WriteRdfXml(const std::vector<TermQuad>& quads,
                                        const std::vector<std::pair<std::string, std::string>>& prefixes);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_RDF_XML_H_
