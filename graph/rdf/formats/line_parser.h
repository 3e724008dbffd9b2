// N-Triples and N-Quads a quad at a time: for files that would be large as a list of text quads. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_LINE_PARSER_H_
#define DOCENT_GRAPH_RDF_FORMATS_LINE_PARSER_H_

#include <functional>
#include <string_view>

#include "graph/rdf/formats/parser.h"

namespace docent {

// Calls `visit` for each statement of `text` as ParseRdf would give it (its graph is empty where none is named), until it
// returns false. The quad is reused for the next statement. `format` is kNTriples or kNQuads. All mistakes are
// reported, as by ParseRdf; statements before and between them have been visited. The result has no quads.
ParsedRdf ParseLines(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                     const std::function<bool(const TermQuad& quad)>& visit);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_LINE_PARSER_H_
