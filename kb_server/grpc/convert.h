// Messages of proto/docent/v1 ↔ our own types. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_GRPC_CONVERT_H_
#define DOCENT_KB_SERVER_GRPC_CONVERT_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <grpcpp/support/status.h>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "docent/v1/context.pb.h"
#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/rdf/term.h"
#include "graph/store/write_batch.h"
#include "graph/wire/term_proto.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/request_memory.h"

namespace docent {
class MemoryUse;
}

namespace docent::server {

using docent::FromProto;  // of terms: graph/wire/term_proto.h
using docent::ToProto;

void ToProto(const Diagnostic& diagnostic, v1::Diagnostic* out);

void ToProto(const BatchOutcome& outcome, v1::AssertReply* out);

// What a client sent. INVALID_ARGUMENT for an unset term or one that RDF does not allow, RESOURCE_EXHAUSTED for one
// over term_bytes (graph/rdf/term_check.h); `what` names the place, e.g. "add[3].subject".
absl::StatusOr<Term> FromProto(const v1::Term& term, const std::string& what, const Limits& limits);
// As above; an unset graph gives a term with an empty IRI.
absl::StatusOr<TermQuad> FromProto(const v1::Quad& quad, const std::string& what, const Limits& limits);
// The same errors for the IRI of a robot.
absl::Status CheckRobotIri(const std::string& robot, const std::string& what, const Limits& limits);
// Of the whole message, for WriteBatch::request_digest; 0 where it has no request_id.
uint64_t DigestOf(const std::string& request_id, const google::protobuf::Message& request);
// INVALID_ARGUMENT where the base of a text is given and no absolute IRI.
absl::Status CheckBase(const std::string& base_iri);

// The batch that an AssertRequest means. INVALID_ARGUMENT names the place of the first bad term and, for
// `rdf`, line and column; RESOURCE_EXHAUSTED names the limit. `memory` counts the batch, which stays counted; null: it is not.
absl::StatusOr<WriteBatch> FromProto(const v1::AssertRequest& request, const Limits& limits,
                                     Cancellation* cancellation = nullptr, MemoryUse* memory = nullptr);

// Names and values as they came; `what` names the field. INVALID_ARGUMENT, RESOURCE_EXHAUSTED as above.
absl::StatusOr<std::vector<std::pair<std::string, Term>>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::NamedTerm>& terms, const std::string& what,
    const Limits& limits);

// RESOURCE_EXHAUSTED naming the document when `text` is beyond document_bytes.
absl::Status CheckDocumentSize(std::string_view name, std::string_view text, const Limits& limits);

// The same code and message (absl codes are gRPC's).
grpc::Status ToGrpc(const absl::Status& status);
v1::StreamError ToStreamError(const absl::Status& status);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_CONVERT_H_
