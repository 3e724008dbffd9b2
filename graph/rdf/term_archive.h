// Terms in an archive (graph/base/archive.h). Any thread.
#ifndef DOCENT_GRAPH_RDF_TERM_ARCHIVE_H_
#define DOCENT_GRAPH_RDF_TERM_ARCHIVE_H_

#include "graph/base/archive.h"
#include "graph/rdf/term.h"

namespace docent {

template <class Archive>
void Fields(Archive& a, Term& term) {
  a(term.kind, term.lexical, term.datatype, term.language);
  if constexpr (Archive::kReads) {
    if (term.kind > TermKind::kLiteral) a.Fail();
  }
}

template <class Archive>
void Fields(Archive& a, TermQuad& quad) {
  a(quad.subject, quad.predicate, quad.object, quad.graph);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TERM_ARCHIVE_H_
