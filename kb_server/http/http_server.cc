#include "kb_server/http/http_server.h"
#include "kb_server/door/port_in_use.h"

#include "kb_server/http/http_connection.h"  // before Asio's own headers: it includes <utility>, which they forget

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <list>
#include <thread>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

namespace net = boost::asio;
using Tcp = net::ip::tcp;
using ErrorCode = boost::system::error_code;

net::awaitable<void> Serve(std::shared_ptr<HttpConnection> connection, bool turn_away) {
  if (turn_away) {
    co_await connection->TurnAway();
  } else {
    co_await connection->Run();
  }
}

}  // namespace

void HttpRoutes::Put(const std::string& method, const std::string& path, const HttpRoute& route) {
  if (method == "GET") routes_[path].emplace("HEAD", route);
  routes_[path].insert_or_assign(method, route);
}

void HttpRoutes::SetFallback(std::function<bool(const HttpRequest&)> takes, HttpHandler handler) {
  fallback_takes_ = std::move(takes);
  fallback_ = {std::move(handler)};
}

const HttpRoute* HttpRoutes::Find(const HttpRequest& request, HttpResponse* refusal) const {
  const std::string& path = request.path;
  auto methods = routes_.find(path);
  if (methods == routes_.end()) {  // the longest "/…/*" that it lies below
    size_t longest = 0;
    for (auto below = routes_.begin(); below != routes_.end(); ++below) {
      const std::string_view prefix = std::string_view(below->first).substr(0, below->first.size() - 1);
      if (!below->first.ends_with("/*") || prefix.size() <= longest || !path.starts_with(prefix)) continue;
      longest = prefix.size();
      methods = below;
    }
  }
  if (methods == routes_.end()) {
    const bool reads = request.method == "GET" || request.method == "HEAD";
    if (reads && fallback_takes_ && fallback_takes_(request)) return &fallback_;
    *refusal = TextResponse(404, absl::StrCat("there is nothing at ", path, "; there are ", Paths()));
    return nullptr;
  }
  const auto route = methods->second.find(request.method);
  if (route != methods->second.end()) return &route->second;
  std::string allowed;
  for (const auto& [name, ignored] : methods->second)
    absl::StrAppend(&allowed, allowed.empty() ? "" : ", ", name);
  if (request.method == "OPTIONS") {  // RFC 9110 section 9.3.7
    *refusal = HttpResponse();
    refusal->status = 200;
    refusal->headers.emplace_back("Allow", absl::StrCat(allowed, ", OPTIONS"));
    return nullptr;
  }
  *refusal = TextResponse(405, absl::StrCat(path, " answers only ", allowed));
  refusal->headers.emplace_back("Allow", allowed);
  return nullptr;
}

std::string HttpRoutes::Paths() const {
  std::string paths;
  for (const auto& [path, ignored] : routes_) {
    const bool is_prefix = path.ends_with("/*");
    if (path.ends_with('/') || (is_prefix && routes_.count(path.substr(0, path.size() - 2)) > 0))
      continue;  // of one that is named without them
    absl::StrAppend(&paths, paths.empty() ? "" : ", ",
                    is_prefix ? path.substr(0, path.size() - 1) + "…" : path);
  }
  return paths;
}

// Connections that wait for their clients for so long may be closed where others come.
constexpr std::chrono::seconds kSlow{5};

// The connection that is missed the least: one that waits for a request, or for the rest of its head, and of these the
// one that waits the longest; else one whose client is slow with a body or with an answer. Null: all of them work.
std::shared_ptr<HttpConnection> LeastMissed(const std::list<std::weak_ptr<HttpConnection>>& connections) {
  using Phase = HttpConnection::Phase;
  const auto slow_since = std::chrono::steady_clock::now() - kSlow;
  std::shared_ptr<HttpConnection> least;
  bool least_idle = false;
  for (const std::weak_ptr<HttpConnection>& one : connections) {
    std::shared_ptr<HttpConnection> connection = one.lock();
    if (connection == nullptr || connection->closing()) continue;
    const Phase phase = connection->phase();
    const bool idle = phase == Phase::kIdle || phase == Phase::kHead;
    const bool slow = phase != Phase::kWork && connection->since() < slow_since;
    if (!idle && !slow) continue;
    if (least != nullptr && (idle != least_idle ? least_idle : least->since() <= connection->since()))
      continue;
    least = std::move(connection);
    least_idle = idle;
  }
  return least;
}

// How many are neither gone nor told to close; those that are gone leave the list.
size_t Open(std::list<std::weak_ptr<HttpConnection>>* connections) {
  size_t open = 0;
  connections->remove_if([&open](const std::weak_ptr<HttpConnection>& one) {
    const auto connection = one.lock();
    if (connection != nullptr && !connection->closing()) ++open;
    return connection == nullptr;
  });
  return open;
}

struct HttpServer::Impl {
  Impl(const HttpServerOptions& options, HttpRoutes routes, uint16_t port)
      : shared{options, std::move(routes), HttpGuard(port, options.allowed_hosts, options.allowed_origins),
               std::make_shared<MemoryBudget>("http_bodies_bytes", options.bodies_bytes)} {}

  net::awaitable<void> AcceptLoop();
  void Stop();

  HttpShared shared;
  net::io_context context;
  // One strand for accepting and for the lists of connections.
  net::strand<net::io_context::executor_type> strand = net::make_strand(context);
  Tcp::acceptor acceptor{strand};
  std::list<std::weak_ptr<HttpConnection>> connections;
  std::list<std::weak_ptr<HttpConnection>> turned_away;  // not among `connections`
  bool stopping = false;
  std::string address;
  uint16_t port = 0;
  std::vector<std::thread> threads;
};

net::awaitable<void> HttpServer::Impl::AcceptLoop() {
  while (!stopping) {
    ErrorCode error;
    Tcp::socket socket(net::make_strand(context));
    co_await acceptor.async_accept(socket, net::redirect_error(net::use_awaitable, error));
    if (stopping || error == net::error::operation_aborted) co_return;
    if (error) {  // out of file descriptors, or the client went at once: others may be luckier in a moment
      net::steady_timer pause(strand, std::chrono::milliseconds(50));
      co_await pause.async_wait(net::redirect_error(net::use_awaitable, error));
      continue;
    }
    ++shared.connections;
    // Those turned away are bounded as well: beyond them nobody even gets an answer.
    const size_t most = shared.options.connections;
    const size_t most_turned_away = std::clamp<size_t>(most / 16, 1, 64);
    while (!stopping && shared.closing > most_turned_away) {  // their descriptors come back in a moment
      net::steady_timer pause(strand, std::chrono::milliseconds(1));
      co_await pause.async_wait(net::redirect_error(net::use_awaitable, error));
    }
    bool full = Open(&connections) >= most;
    if (const auto one = full ? LeastMissed(connections) : nullptr) {
      one->Close();
      ++shared.slow_closed;
      full = false;
    }
    if (full && Open(&turned_away) >= most_turned_away) continue;
    const auto executor = socket.get_executor();
    auto connection = std::make_shared<HttpConnection>(std::move(socket), &shared);
    (full ? turned_away : connections).push_back(connection);
    net::co_spawn(executor, Serve(std::move(connection), full), net::detached);
  }
}

void HttpServer::Impl::Stop() {
  net::post(strand, [this] {
    stopping = true;
    ErrorCode ignored;
    acceptor.close(ignored);
    for (const auto* list : {&connections, &turned_away}) {
      for (const std::weak_ptr<HttpConnection>& one : *list) {
        if (const auto connection = one.lock()) connection->Close();
      }
    }
  });
  // The threads end when no connection is left.
  for (std::thread& thread : threads) thread.join();
}

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::~HttpServer() {
  impl_->Stop();
}
const std::string& HttpServer::address() const {
  return impl_->address;
}
uint16_t HttpServer::port() const {
  return impl_->port;
}

HttpServer::Counts HttpServer::counts() const {
  return {impl_->shared.connections, impl_->shared.open,        impl_->shared.requests,
          impl_->shared.refused,     impl_->shared.slow_closed, impl_->shared.bodies->taken()};
}

absl::StatusOr<std::unique_ptr<HttpServer>> HttpServer::Start(const HttpServerOptions& options,
                                                              HttpRoutes routes) {
  const std::optional<HostAndPort> where = SplitHostAndPort(options.listen);
  if (!where || !where->port) {
    return absl::InvalidArgumentError(absl::StrCat("cannot listen for HTTP on \"", options.listen,
                                                   "\": give HOST:PORT, e.g. 127.0.0.1:7480"));
  }
  const std::string what = absl::StrCat("cannot listen for HTTP on ", options.listen);
  net::io_context
      early;  // for looking up the name and binding: the guard must know the port before anything is served
  ErrorCode error;
  const auto found = Tcp::resolver(early).resolve(where->host, std::to_string(*where->port), error);
  if (error || found.empty()) return absl::InvalidArgumentError(absl::StrCat(what, ": ", error.message()));
  const Tcp::endpoint endpoint = found.begin()->endpoint();
  Tcp::acceptor bound(early);
  bound.open(endpoint.protocol(), error);
  if (!error) bound.set_option(net::socket_base::reuse_address(true), error);
  if (!error) bound.bind(endpoint, error);
  if (!error) bound.listen(net::socket_base::max_listen_connections, error);
  if (error) {
    return absl::FailedPreconditionError(
        absl::StrCat(what, ": ", error.message(), error == net::error::address_in_use ? kPortInUse : ""));
  }
  const Tcp::endpoint listening = bound.local_endpoint();

  auto impl = std::make_unique<Impl>(options, std::move(routes), listening.port());
  impl->port = listening.port();
  const std::string host = listening.address().to_string();
  impl->address =
      absl::StrCat(listening.address().is_v6() ? absl::StrCat("[", host, "]") : host, ":", impl->port);
  impl->acceptor.assign(endpoint.protocol(), bound.release(error), error);
  if (error) return absl::FailedPreconditionError(absl::StrCat(what, ": ", error.message()));
  net::co_spawn(impl->strand, impl->AcceptLoop(), net::detached);
  for (int i = 0; i < options.threads; ++i) {
    impl->threads.emplace_back([context = &impl->context] { context->run(); });
  }
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(impl)));
}

}  // namespace docent::server
