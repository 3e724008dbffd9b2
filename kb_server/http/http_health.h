// The pages for those who watch over the server: /healthz and /metrics.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_HEALTH_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_HEALTH_H_

#include <functional>

#include "absl/status/status.h"
#include "kb_server/door/metrics.h"
#include "kb_server/http/http_server.h"

namespace docent::server {

// GET /healthz: 200 "ok" while `health` is OK, otherwise 503 with its message. Called on a network thread:
// quick.
void AddHealthRoute(HttpRoutes* routes, std::function<absl::Status()> health);

// GET /metrics: `metrics` in Prometheus text format. `metrics` must outlive the server.
void AddMetricsRoute(HttpRoutes* routes, const Metrics* metrics);

// The server's own counts as metrics. `server` must outlive every Render.
void AddHttpMetrics(Metrics* metrics, const HttpServer* server);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_HEALTH_H_
