// SPARQL 1.1 Graph Store HTTP Protocol at /rdf-graphs: GET and HEAD read a graph, PUT replaces it, POST adds
// to it, DELETE drops it, PATCH changes it by a SPARQL Update (application/sparql-update) whose default graph
// it is.
//
// The graph is ?default (docent:default), ?graph=IRI, or the address itself below /rdf-graphs/. POST to
// /rdf-graphs alone makes a graph and names it in Location. Bodies: Turtle, N-Triples, RDF/XML, and TriG or
// N-Quads that name no graph; multipart/form-data with several. A graph is there while it has a triple;
// docent:default always is. GET and HEAD take `as-of` and `min-revision`, as a query does (http_sparql.h).
//
// Statuses: 200 with what changed as JSON, 201 where the graph is new, 400 with line, column and caret for a
// body that is wrong, 403 for a graph that the server alone writes, 404, 406, 413, 415, 422 for a PATCH that
// is about other graphs.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_GRAPH_STORE_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_GRAPH_STORE_H_

#include "kb_server/door/ports.h"
#include "kb_server/http/http_server.h"

namespace docent::server {

// `ports` must outlive the server and the workers' last job.
void AddGraphStoreRoutes(HttpRoutes* routes, const WritePorts* ports);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_GRAPH_STORE_H_
