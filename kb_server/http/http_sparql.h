// SPARQL 1.1 Protocol at /sparql: queries by GET ?query=…, POST application/sparql-query or as a form;
// updates by POST application/sparql-update or as a form; GET without any gives the Service Description.
//
// Parameters: default-graph-uri and named-graph-uri (any number; they replace the query's FROM),
// using-graph-uri and using-named-graph-uri (for updates that have no USING or WITH of their own), `timeout`
// in milliseconds (never more than the limit query_timeout_ms), `min-revision` (read your writes: wait for
// that graph version), `request-id` (a repeated update is not applied again). Relative IRIs are relative to
// the address that was asked. The answer's form follows Accept: SPARQL JSON, XML, CSV, TSV for SELECT and
// ASK; Turtle, N-Triples, RDF/XML, TriG, N-Quads for graphs. The header Docent-Revision names the graph
// version that answered, or that holds the update.
//
// Errors are plain text: 400 with line, column and caret for malformed text, 405 for an update by GET, 406
// where no form fits Accept, 413 beyond a limit that is named, 415 for another body type, 503 when too much
// work waits or an evaluation needs too much memory, 504 at the timeout. An error after the first rows were
// sent cuts the connection. When the client goes, its evaluation is cancelled.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_SPARQL_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_SPARQL_H_

#include "kb_server/door/inbox.h"
#include "kb_server/door/metrics.h"
#include "kb_server/door/ports.h"
#include "kb_server/http/http_server.h"

namespace docent::server {

// Queries run on `ports->workers`. Both pointers must outlive the server and the workers' last query.
void AddSparqlRoutes(HttpRoutes* routes, const WritePorts* ports, Metrics* metrics);

// What an update did, as JSON.
HttpResponse OutcomeResponse(int status, const BatchOutcome& outcome);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_SPARQL_H_
