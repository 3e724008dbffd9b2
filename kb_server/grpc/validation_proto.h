// Results of validation ↔ messages of the API, for both ends of the line. Any thread.
#ifndef DOCENT_KB_SERVER_GRPC_VALIDATION_PROTO_H_
#define DOCENT_KB_SERVER_GRPC_VALIDATION_PROTO_H_

#include "docent/v1/ontologies.pb.h"
#include "graph/rdf/term.h"
#include "reasoner/shapes/report.h"

namespace docent::server {

// Without a text for the value none is written.
void ToProto(const shapes::ResultText& text, const Term& focus, const Term& value, const Term& shape,
             v1::ValidationResult* out);

// As people are shown it; a term that is none is shown as "".
shapes::ResultText FromProto(const v1::ValidationResult& result);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_VALIDATION_PROTO_H_
