// RDF parser that also returns the place of each term, for reports on documents (`docent check`, `docent
// validate`). All other code uses ParseRdf (parser.h), which keeps no places. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_LOCATED_PARSER_H_
#define DOCENT_GRAPH_RDF_FORMATS_LOCATED_PARSER_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/formats/parser.h"

namespace docent {

// Places of a quad's terms. A term that the text does not write out (a list's rdf:first, a bracket's node)
// has the place of the construct. RDF/XML: the start tag of the node element for the subject, that of the
// property element or the property attribute for the others.
struct QuadPlace {
  SourceSpan subject, predicate, object;
};

// A prefix declaration, and the number of names that use it.
struct PrefixPlace {
  std::string prefix, iri;
  SourceSpan span;
  uint64_t uses = 0;
};

struct LocatedRdf {
  ParsedRdf rdf;                      // as from ParseRdf
  std::vector<QuadPlace> places;      // one for each of rdf.quads
  std::vector<PrefixPlace> prefixes;  // in order of declaration; Turtle and TriG only
};
LocatedRdf ParseLocatedRdf(std::string_view text, RdfFormat format, const ParseRdfOptions& options = {});

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_LOCATED_PARSER_H_
