// Reader of SPARQL 1.1 Query Results in JSON (W3C recommendation of 2013): what answers SERVICE as a rule. It keeps the
// variables and the rows, and nothing of the rest. Any thread.
#ifndef DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_JSON_H_
#define DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_JSON_H_

#include <string_view>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/sparql/run/federation.h"

namespace docent::server {

// The rows of a SELECT. UNKNOWN: it is not JSON, no such answer, or holds what is no RDF term. RESOURCE_EXHAUSTED: more rows
// than Limits::remote_rows, a text of more than term_bytes, or more than `memory` allows, which counts the answer.
// `cancellation` may be null.
absl::StatusOr<sparql::ServiceAnswer> ReadJsonAnswer(std::string_view body, const Limits& limits,
                                                     Cancellation* cancellation, MemoryUse* memory);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_JSON_H_
