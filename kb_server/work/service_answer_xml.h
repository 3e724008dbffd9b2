// Reader of SPARQL Query Results in XML (W3C recommendation of 2013), for servers that answer SERVICE in nothing else. Any
// thread.
#ifndef DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_XML_H_
#define DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_XML_H_

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/sparql/run/federation.h"

namespace docent::server {

// The rows of a SELECT, whose blank nodes have labels of ours. UNKNOWN: it is not well-formed, no such document, or holds
// what is no RDF term. RESOURCE_EXHAUSTED: more rows than Limits::remote_rows.
absl::StatusOr<sparql::ServiceAnswer> ReadXmlAnswer(const std::string& body, const Limits& limits,
                                                    Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_SERVICE_ANSWER_XML_H_
