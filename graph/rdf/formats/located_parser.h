// RDF text → term quads with the place where each was written, for those who report on documents (`docent check`,
// `docent validate`). Everybody else takes ParseRdf (parser.h), which keeps no places. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_LOCATED_PARSER_H_
#define DOCENT_GRAPH_RDF_FORMATS_LOCATED_PARSER_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/formats/parser.h"

namespace docent {

// Where a quad's terms stand. What the text does not write out (a list's rdf:first, a bracket's node) is placed where it
// is made. RDF/XML: the start tag of the node element for the subject, that of the property
// element or the property attribute for the others.
struct QuadPlace {
  SourceSpan subject, predicate, object;
};

// A prefix declaration, and how many names use it.
struct PrefixPlace {
  std::string prefix, iri;
  SourceSpan span;
  uint64_t uses = 0;
};

struct LocatedRdf {
  ParsedRdf rdf;                      // as ParseRdf gives it
  std::vector<QuadPlace> places;      // of rdf.quads, one each
  std::vector<PrefixPlace> prefixes;  // in order of declaration; Turtle and TriG only
};
LocatedRdf ParseLocatedRdf(std::string_view text, RdfFormat format, const ParseRdfOptions& options = {});

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_LOCATED_PARSER_H_
