// A request that brings a document for Ontologies, as a batch. Any thread.
#ifndef DOCENT_KB_SERVER_GRPC_MODULE_REQUESTS_H_
#define DOCENT_KB_SERVER_GRPC_MODULE_REQUESTS_H_

#include "absl/status/statusor.h"
#include "docent/v1/context.pb.h"
#include "docent/v1/ontologies.pb.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/rdf/formats/parser.h"
#include "graph/store/write_batch.h"
#include "kb_server/work/load_judge.h"

namespace docent::server {

// INVALID_ARGUMENT with all diagnostics where it does not parse, or has no name; RESOURCE_EXHAUSTED naming the limit.
// CANCELLED, DEADLINE_EXCEEDED: what `cancellation`, which may be null, said meanwhile.
// Warnings about the text go to `warnings`, which may be null. `memory` counts the batch, which stays counted; null: it is
// not counted.
absl::StatusOr<WriteBatch> ToLoadBatch(const v1::LoadRequest& request, const Limits& limits,
                                       Cancellation* cancellation = nullptr, Diagnostics* warnings = nullptr,
                                       MemoryUse* memory = nullptr);

// Whether the data takes the place of what its graph holds, which that batch does not say.
bool ReplacesGraph(const v1::LoadRequest& request);

// Where the quads of that batch stand in the request's text, which must outlive the result; a part of a document (its lines
// are not the document's) and rules have no places.
LoadedText TextOf(const v1::LoadRequest& request, const Limits& limits);

// How the text of facts is read, named "rdf".
ParseRdfOptions RdfOptionsOf(const v1::AssertRequest& request, const Limits& limits);
// The same of the request's `rdf`.
LoadedText TextOf(const v1::AssertRequest& request, const Limits& limits);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_MODULE_REQUESTS_H_
