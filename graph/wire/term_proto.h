// Conversion between terms of the graph and messages of proto/docent/v1, for servers and clients. Pure; any
// thread.
#ifndef DOCENT_GRAPH_WIRE_TERM_PROTO_H_
#define DOCENT_GRAPH_WIRE_TERM_PROTO_H_

#include <optional>

#include "docent/v1/term.pb.h"
#include "graph/rdf/term.h"

namespace docent {

void ToProto(const Term& term, v1::Term* out);
// An empty graph is left unset.
void ToProto(const TermQuad& quad, v1::Quad* out);

// Unchecked. nullopt for an unset term (an unbound value of a row).
std::optional<Term> FromProto(const v1::Term& term);

}  // namespace docent

#endif  // DOCENT_GRAPH_WIRE_TERM_PROTO_H_
