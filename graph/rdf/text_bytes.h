// Text length of terms and quads, for limits. Any thread.
#ifndef DOCENT_GRAPH_RDF_TEXT_BYTES_H_
#define DOCENT_GRAPH_RDF_TEXT_BYTES_H_

#include <cstddef>

#include "graph/rdf/term.h"

namespace docent {

inline size_t TextBytes(const Term& term) {
  return term.lexical.size() + term.datatype.size() + term.language.size();
}
inline size_t TextBytes(const TermQuad& quad) {
  return TextBytes(quad.subject) + TextBytes(quad.predicate) + TextBytes(quad.object) + TextBytes(quad.graph);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TEXT_BYTES_H_
