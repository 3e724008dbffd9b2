// One connection of the HTTP server: reads requests one after the other, has them checked and handled, sends
// the answers. Only http_server.cc and http_connection.cc include this.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_CONNECTION_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_CONNECTION_H_

#include <utility>  // before Asio: Boost 1.74 uses std::exchange in its coroutines without including it

#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <memory>
#include <string>

#include "graph/base/memory_budget.h"
#include "kb_server/http/http_guard.h"
#include "kb_server/http/http_server.h"

namespace docent {

// What all connections share.
struct HttpShared {
  HttpServerOptions options;
  HttpRoutes routes;
  HttpGuard guard;
  std::shared_ptr<MemoryBudget> bodies;  // an exchange may outlive the server
  std::atomic<uint64_t> connections{0};
  std::atomic<uint64_t> open{0};
  std::atomic<uint64_t> requests{0};
  std::atomic<uint64_t> refused{0};
};

// Everything runs on the strand of the socket's executor; Close may be called from any thread.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  using Socket = boost::asio::ip::tcp::socket;

  HttpConnection(Socket socket, HttpShared* shared);
  ~HttpConnection();

  boost::asio::awaitable<void> Run();
  // Answers 503 and closes.
  boost::asio::awaitable<void> TurnAway();
  void Close();

 private:
  using ErrorCode = boost::system::error_code;
  using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;
  template <typename T>
  using Awaitable = boost::asio::awaitable<T>;

  // Reads, checks and answers one request; false: the connection is to be closed.
  Awaitable<bool> ServeOne();
  // `memory`: counts the body.
  Awaitable<bool> ReadBody(Parser& parser, MemoryUse& memory);
  // The check that needs no body; nullopt: go on, `*handler` is set.
  std::optional<HttpResponse> CheckHeader(Parser& parser, HttpRequest* request,
                                          const HttpHandler** handler) const;
  Awaitable<bool> SendAnswer(HttpAnswer& answer, bool head_only, unsigned version, bool keep_alive);
  // Status line and headers; `length` nullopt: chunked (or, for HTTP/1.0, until the end of the connection).
  std::string HeadText(const HttpResponse& response, std::optional<size_t> length, unsigned version,
                       bool keep_alive) const;
  Awaitable<bool> Send(std::string bytes);
  // Answers without having read the whole request, then closes in a way that lets the client read the answer.
  Awaitable<void> RefuseAndClose(HttpResponse response, unsigned version);
  void WatchClient(std::shared_ptr<HttpAnswer> answer);
  Awaitable<void> WaitForWake();

  boost::beast::tcp_stream stream_;
  HttpShared& shared_;
  boost::beast::flat_buffer buffer_;
  boost::asio::steady_timer wake_;  // never expires; cancelled to wake the coroutine
  bool woken_ = false;
  bool closed_ = false;
  std::shared_ptr<HttpAnswer> answer_;  // of the request in work
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_CONNECTION_H_
