// Reader of SPARQL Query Results in XML (W3C recommendation of 2013), for servers that answer SERVICE in nothing else. Any
// thread.
#ifndef DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_XML_H_
#define DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_XML_H_

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/sparql/run/federation.h"

namespace docent::server {

// The rows of a SELECT. UNKNOWN: it is not well-formed, no such document, or holds what is no RDF term. RESOURCE_EXHAUSTED:
// more rows than Limits::remote_rows, a term of more than term_bytes, or more than `memory` allows, which counts the answer.
// `cancellation` may be null.
absl::StatusOr<sparql::ServiceAnswer> ReadXmlAnswer(const std::string& body, const Limits& limits,
                                                    Cancellation* cancellation, MemoryUse* memory);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_XML_H_
