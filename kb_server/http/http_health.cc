#include "kb_server/http/http_health.h"

#include <utility>

namespace docent::server {

void AddHealthRoute(HttpRoutes* routes, std::function<absl::Status()> health) {
  routes->Add("GET", "/healthz", [health = std::move(health)](std::shared_ptr<HttpExchange> exchange) {
    const absl::Status status = health();
    exchange->Respond(status.ok() ? TextResponse(200, "ok")
                                  : TextResponse(503, std::string(status.message())));
  });
}

void AddMetricsRoute(HttpRoutes* routes, const Metrics* metrics) {
  routes->Add("GET", "/metrics", [metrics](std::shared_ptr<HttpExchange> exchange) {
    HttpResponse response;
    response.content_type = "text/plain; version=0.0.4; charset=utf-8";
    response.body = metrics->Render();
    exchange->Respond(std::move(response));
  });
}

void AddHttpMetrics(Metrics* metrics, const HttpServer* server) {
  metrics->AddGaugeFunction("docent_http_connections", "Open HTTP connections.",
                            [server] { return static_cast<double>(server->counts().open); });
  metrics->AddGaugeFunction("docent_http_bodies_bytes",
                            "Bodies of HTTP requests as they came and unpacked, begun messages of /live, and "
                            "what is followed there (http_bodies_bytes).",
                            [server] { return static_cast<double>(server->counts().body_bytes); });
  metrics->AddCounterFunction("docent_http_connections_total", "HTTP connections accepted.",
                              [server] { return static_cast<double>(server->counts().connections); });
  metrics->AddCounterFunction("docent_http_requests_total", "HTTP requests answered, refused ones included.",
                              [server] { return static_cast<double>(server->counts().requests); });
  metrics->AddCounterFunction("docent_http_connections_slow_closed_total",
                              "HTTP connections, idle or with a slow client, closed to make room for others.",
                              [server] { return static_cast<double>(server->counts().slow_closed); });
  metrics->AddCounterFunction(
      "docent_http_refused_total",
      "HTTP requests refused before any handler saw them (host, origin, size, syntax).",
      [server] { return static_cast<double>(server->counts().refused); });
}

}  // namespace docent::server
