// A request of the SPARQL 1.1 Protocol (section 2) as a value. Pure function; any thread.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_SPARQL_REQUEST_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_SPARQL_REQUEST_H_

#include <optional>
#include <string>
#include <vector>

#include "graph/base/cancellation.h"
#include "graph/base/ids.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/rdf/term.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

struct SparqlRequest {
  enum class Kind { kQuery, kUpdate, kDescription };  // kDescription: GET without anything to do
  Kind kind = Kind::kQuery;
  std::string text;
  std::string base_iri;              // the address that was asked: what relative IRIs are relative to
  std::vector<Term> default_graphs;  // default-graph-uri, using-graph-uri
  std::vector<Term> named_graphs;    // named-graph-uri, using-named-graph-uri
  std::string request_id;            // kUpdate: a repeat is not applied again
  int timeout_ms = 0;
  Revision min_revision;
  std::string as_of;  // kQuery: ParseAsOf; empty: the newest version
};

// The request, or the refusal: 400 (a parameter is wrong or missing), 405, 413 (too long, the limit is
// named), 415 (the body's type).
struct ReadSparqlRequest {
  std::optional<HttpResponse> refusal;
  SparqlRequest request;
};
// `memory`: counts what is unpacked; may be null. A large or packed body takes time: see IsQuicklyRead.
ReadSparqlRequest ReadSparql(const HttpRequest& http, const Limits& limits, MemoryUse* memory = nullptr,
                             Cancellation* cancellation = nullptr);
bool IsQuicklyRead(const HttpRequest& http);

// "http://host:port/path" of a request.
std::string AddressOf(const HttpRequest& http);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_SPARQL_REQUEST_H_
