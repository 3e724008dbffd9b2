// Parser of Turtle, TriG, N-Triples and N-Quads, RDF 1.1. Included only by parser.cc. Any thread.
//
// Why not Raptor or serd: of the W3C syntax suites Raptor accepts 10 of 94 bad Turtle and 10 of 115 bad TriG
// documents and fails 15 of 98 good TriG ones, and its lexer has open heap-overflow reports; serd 0.30
// accepts the same 10 bad documents (surrogates), and refuses empty documents and those that use both _:b1
// and _:B1. Both stop at the first mistake. (Measured November 2026.)
#ifndef DOCENT_GRAPH_RDF_FORMATS_TURTLE_PARSER_H_
#define DOCENT_GRAPH_RDF_FORMATS_TURTLE_PARSER_H_

#include <functional>
#include <string_view>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/place_recorder.h"

namespace docent {

// `text` must be well-formed UTF-8. After a mistake parsing goes on at the next statement, to find all
// mistakes (up to Limits::document_diagnostics). `places` receives the places of quads and prefixes; may be
// null.
ParsedRdf ParseTurtleFamily(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                            PlaceRecorder* places = nullptr);
// As ParseLines (line_parser.h).
ParsedRdf ParseTurtleLines(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                           const std::function<bool(const TermQuad& quad)>& visit);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_TURTLE_PARSER_H_
