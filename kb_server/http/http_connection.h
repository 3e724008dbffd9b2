// One connection of the HTTP server: reads requests one after the other, has them checked and handled, sends
// the answers. Only http_server.cc and http_connection.cc include this.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_CONNECTION_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_CONNECTION_H_

#include <utility>  // before Asio: Boost 1.74 uses std::exchange in its coroutines without including it

#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/memory_budget.h"
#include "kb_server/http/http_guard.h"
#include "kb_server/http/http_head_reader.h"
#include "kb_server/http/http_server.h"

namespace docent::server {

// What all connections share.
struct HttpShared {
  HttpServerOptions options;
  HttpRoutes routes;
  HttpGuard guard;
  std::shared_ptr<MemoryBudget> bodies;  // an exchange may outlive the server
  std::atomic<uint64_t> connections{0};
  std::atomic<uint64_t> open{0};
  std::atomic<uint64_t> closing{0};  // of these, those that are told to close
  std::atomic<uint64_t> requests{0};
  std::atomic<uint64_t> refused{0};
  std::atomic<uint64_t> slow_closed{0};
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

  // What the connection does, and since when; any thread.
  enum class Phase : uint8_t {
    kIdle,  // waits for a request
    kHead,  // reads one
    kBody,
    kWork,  // waits for the answer
    kSend   // waits for the client to take it
  };
  bool closing() const { return closing_; }
  Phase phase() const { return phase_; }
  std::chrono::steady_clock::time_point since() const { return since_.load(); }

 private:
  using ErrorCode = boost::system::error_code;
  template <typename T>
  using Awaitable = boost::asio::awaitable<T>;

  void Enter(Phase phase);
  void CloseNow();
  // Reads, checks and answers one request; false: the connection is to be closed.
  Awaitable<bool> ServeOne();
  // False where there is no whole head: it was refused, or the client has gone or is too slow.
  Awaitable<bool> ReadHead(HttpHeadReader& reader);
  // Likewise. `memory`: counts the body.
  Awaitable<bool> ReadBody(const HttpHead& head, std::string* body, MemoryUse& memory);
  // Waits for bytes and puts them into unread_, until the stream's time is over; false: there will be none.
  Awaitable<bool> ReadMore();
  // The check that needs no body; nullopt: go on, `*route` is set.
  std::optional<HttpResponse> CheckHead(HttpHead& head, HttpRequest* request, const HttpRoute** route) const;
  // `chunks`: the client knows them (HTTP/1.1).
  Awaitable<bool> SendAnswer(HttpAnswer& answer, bool head_only, bool chunks, bool keep_alive);
  // Status line and headers; `length` nullopt: chunked, or until the end of the connection.
  std::string HeadText(const HttpResponse& response, std::optional<size_t> length, bool chunks,
                       bool keep_alive) const;
  Awaitable<bool> Send(std::string bytes);
  // Gives what the client sends to `reader`, until it goes away or the connection is closed.
  Awaitable<void> ReadUpgraded(std::shared_ptr<HttpUpgradeReader> reader, std::shared_ptr<HttpAnswer> answer);
  // After the last byte of an answer that was not HTTP: lets the client read it before the connection is closed.
  Awaitable<void> AwaitUpgradedEnd();
  // Answers without having read the whole request, then closes in a way that lets the client read the answer: what else
  // it sent is dropped, and never read as a request.
  Awaitable<void> RefuseAndClose(HttpResponse response);
  void WatchClient(std::shared_ptr<HttpAnswer> answer);
  Awaitable<void> WaitForWake();

  boost::beast::tcp_stream stream_;
  HttpShared& shared_;
  const ClientPtr client_;
  std::vector<char> buffer_;          // what is read at once
  std::string_view unread_;           // of it; the next request where the client does not wait for answers
  boost::asio::steady_timer wake_;    // never expires; cancelled to wake the coroutine
  std::atomic<bool> closing_{false};  // by Close
  std::atomic<Phase> phase_{Phase::kIdle};
  std::atomic<std::chrono::steady_clock::time_point> since_{std::chrono::steady_clock::now()};
  bool served_one_ = false;
  bool woken_ = false;
  bool closed_ = false;
  std::optional<SendBudget::Share> share_;  // of what the client has not taken
  std::shared_ptr<HttpAnswer> answer_;      // of the request in work
  HttpFields shared_with_;                  // headers of its answer, for the page of another server
  bool upgraded_ = false;                   // no longer HTTP
  bool reading_upgraded_ = false;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_CONNECTION_H_
