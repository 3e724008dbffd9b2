// Streaming parser of N-Triples and N-Quads, for files that would be large as a list of text quads. Any
// thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_LINE_PARSER_H_
#define DOCENT_GRAPH_RDF_FORMATS_LINE_PARSER_H_

#include <functional>
#include <string_view>

#include "graph/rdf/formats/parser.h"

namespace docent {

// Calls `visit` for each statement of `text`, with the quad that ParseRdf would give (an empty graph if none
// is named), until it returns false. The quad is reused for the next statement. `format` is kNTriples or
// kNQuads. All mistakes are reported, as by ParseRdf; the correct statements around them are visited. The
// result has no quads.
ParsedRdf ParseLines(std::string_view text, RdfFormat format, const ParseRdfOptions& options,
                     const std::function<bool(const TermQuad& quad)>& visit);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_LINE_PARSER_H_
