// A small HTTP/1.1 server on Boost.Beast and Asio coroutines: routes, limits, timeouts, keep-alive; nothing
// else. Beast does not show here.
//
//   HttpRoutes routes;
//   routes.Add("GET", "/healthz", [](std::shared_ptr<HttpExchange> e) { e->Respond(TextResponse(200, "ok"));
//   }); auto server = HttpServer::Start({.listen = "127.0.0.1:7480"}, std::move(routes));
//
// Handlers are called on a network thread and must return at once; what takes long answers later from a
// thread of its own through the exchange. Each connection has one request in work at a time; pipelined ones
// wait their turn.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_SERVER_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_SERVER_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "graph/base/limits.h"
#include "kb_server/http/http_exchange.h"

namespace docent::server {

class SendBudget;

struct HttpRoute {
  HttpHandler handler;
  bool any_encoding = false;  // the handler looks at Content-Encoding itself; otherwise it is gzip or none
};

// Which handler answers what. Filled before the server starts.
class HttpRoutes {
 public:
  // `path` exactly; with "/*" at its end, whatever lies below. A GET route answers HEAD as well.
  void Add(const std::string& method, const std::string& path, HttpHandler handler) {
    Put(method, path, {std::move(handler)});
  }
  // The same for a handler that answers for encodings that it does not read.
  void AddAnyEncoding(const std::string& method, const std::string& path, HttpHandler handler) {
    Put(method, path, {std::move(handler), true});
  }

  // Answers GET and HEAD of paths that have no route, where `takes` says so. Both on a network thread.
  void SetFallback(std::function<bool(const HttpRequest&)> takes, HttpHandler handler);

  // The route, or null with `*refusal` saying why: 404, or 405 with the header Allow.
  const HttpRoute* Find(const HttpRequest& request, HttpResponse* refusal) const;

 private:
  void Put(const std::string& method, const std::string& path, const HttpRoute& route);
  std::string Paths() const;

  std::map<std::string, std::map<std::string, HttpRoute, std::less<>>> routes_;  // path → method → route
  std::function<bool(const HttpRequest&)> fallback_takes_;
  HttpRoute fallback_;
};

struct HttpServerOptions {
  Clients* clients = nullptr;                      // each connection is one; null: none counts
  std::string listen = "127.0.0.1:7480";           // address or host name, and port; port 0 takes a free one
  std::vector<std::string> allowed_hosts;          // beside the loopback names: see HttpGuard
  std::vector<std::string> allowed_origins;        // of other servers' pages: see HttpGuard
  int threads = 2;                                 // network threads, 1 … 64
  size_t connections = Limits{}.http_connections;  // beyond: idle and slow ones are closed, or 503
  size_t body_bytes = Limits{}.http_body_bytes;    // beyond: 413
  size_t bodies_bytes = Limits{}.http_bodies_bytes;    // of all requests at the same time; beyond: 503
  size_t header_bytes = Limits{}.http_header_bytes;    // request line and header fields; beyond: 414, 431
  size_t header_fields = Limits{}.http_header_fields;  // beyond: 431
  size_t parameters = Limits{}.http_parameters;        // of the query string; beyond: 400
  std::chrono::milliseconds idle_timeout{60000};       // between two requests of a connection
  std::chrono::milliseconds header_timeout{10000};     // from a connection's begin, or a request's first byte
  std::chrono::milliseconds body_timeout{60000};       // for a whole request body
  std::chrono::milliseconds write_timeout{30000};      // for each 64 KiB of an answer that the client takes
  SendBudget* send_budget = nullptr;                   // counts what clients do not take; null: nobody does
  const Clock* clock = nullptr;  // for the header Date; null: answers have none. Must outlive the server
};

class HttpServer {
 public:
  // Listens and serves. INVALID_ARGUMENT for an address that is none; FAILED_PRECONDITION for one that cannot
  // be listened on (in use, not permitted): one line each.
  static absl::StatusOr<std::unique_ptr<HttpServer>> Start(const HttpServerOptions& options,
                                                           HttpRoutes routes);
  // Stops. Answers in work are cut off and their handlers told so (OnGone). Returns when no network thread
  // runs.
  ~HttpServer();

  // Where it listens, with the true port: "127.0.0.1:7480", "[::1]:7480".
  const std::string& address() const;
  uint16_t port() const;

  // Since the start; for metrics. Any thread.
  struct Counts {
    uint64_t connections = 0;  // accepted
    uint64_t open = 0;         // now
    uint64_t requests = 0;     // answered, refused ones included
    uint64_t refused = 0;      // answered with a 4xx status by the server itself
    uint64_t slow_closed = 0;  // idle or slow, closed since others came
    uint64_t body_bytes = 0;   // of larger requests, now
  };
  Counts counts() const;

 private:
  struct Impl;
  explicit HttpServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_SERVER_H_
