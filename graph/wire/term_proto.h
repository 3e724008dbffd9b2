// Terms of the graph ↔ messages of proto/docent/v1, for both ends of every line. Pure functions; any thread.
#ifndef DOCENT_GRAPH_WIRE_TERM_PROTO_H_
#define DOCENT_GRAPH_WIRE_TERM_PROTO_H_

#include <optional>

#include "docent/v1/term.pb.h"
#include "graph/rdf/term.h"

namespace docent {

void ToProto(const Term& term, v1::Term* out);
// An empty graph stays unset.
void ToProto(const TermQuad& quad, v1::Quad* out);

// As it came: nothing is checked. nullopt for an unset term (an unbound value of a row).
std::optional<Term> FromProto(const v1::Term& term);

}  // namespace docent

#endif  // DOCENT_GRAPH_WIRE_TERM_PROTO_H_
