// SPARQL 1.1 Protocol, query operation, at /sparql: GET ?query=…, POST application/sparql-query, POST
// application/x-www-form-urlencoded. (W3C SPARQL 1.1 Protocol, section 2.1.)
//
// Parameters beside `query`: default-graph-uri and named-graph-uri (any number; they replace the query's
// FROM), `timeout` in milliseconds (never more than the limit query_timeout_ms), `min-revision` (read your
// writes: wait for that graph version). The answer's form follows Accept: SPARQL JSON, XML, CSV, TSV for
// SELECT and ASK; Turtle, N-Triples, RDF/XML for CONSTRUCT. The header Docent-Revision names the graph
// version that answered.
//
// Errors are plain text: 400 with line, column and caret for a malformed query, 406 where no form fits
// Accept, 413 beyond query_text_bytes, 415 for another body type, 501 for what the evaluator does not do, 503
// when too many queries wait or a query needs too much memory, 504 at the timeout. An error after the first
// rows were sent cuts the connection. When the client goes, its query is cancelled.
#ifndef DOCENT_KB_SERVER_SERVICE_HTTP_SPARQL_H_
#define DOCENT_KB_SERVER_SERVICE_HTTP_SPARQL_H_

#include "kb_server/service/http_server.h"
#include "kb_server/service/metrics.h"
#include "kb_server/service/ports.h"

namespace docent {

// Queries run on `ports->workers`. Both pointers must outlive the server and the workers' last query.
void AddSparqlRoutes(HttpRoutes* routes, const ServicePorts* ports, Metrics* metrics);

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_HTTP_SPARQL_H_
