// Terms of the graph ↔ messages of proto/docent/v1. Pure functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_TERM_PROTO_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_TERM_PROTO_H_

#include <optional>

#include "docent/v1/term.pb.h"
#include "kb_server/rdf/term.h"

namespace docent::robot {

void ToProto(const Term& term, v1::Term* out);
// An empty graph stays unset.
void ToProto(const TermQuad& quad, v1::Quad* out);
// nullopt for an unset term (an unbound value of a row).
std::optional<Term> FromProto(const v1::Term& term);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_TERM_PROTO_H_
