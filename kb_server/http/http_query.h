// A query over HTTP, answered on a worker thread: parse, evaluate on the newest version, write in the format
// that the client accepts. Long answers are sent while they are made.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_QUERY_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_QUERY_H_

#include <memory>

#include "graph/base/cancellation.h"
#include "kb_server/door/ports.h"
#include "kb_server/http/http_exchange.h"
#include "kb_server/http/http_sparql_request.h"

namespace docent::server {

// Answers the exchange, whatever happens. The HTTP status that the answer has.
int AnswerQuery(const ReadPorts& ports, const SparqlRequest& request, std::shared_ptr<HttpExchange> exchange,
                Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_QUERY_H_
