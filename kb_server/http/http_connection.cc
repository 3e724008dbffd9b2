#include "kb_server/http/http_connection.h"

#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <cerrno>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "graph/base/text.h"

namespace docent {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr size_t kPieceBytes = 64u << 10;  // written at once, each with the write timeout
constexpr size_t kDrainBytes = 4u << 20;   // read and dropped after a refusal, at most
constexpr std::chrono::seconds kDrainTime{2};

std::string_view View(beast::string_view text) {
  return {text.data(), text.size()};
}

// The refusal for a request that could not be read; nullopt where nobody is there to read an answer.
// `has_target`: its first line was read.
std::optional<HttpResponse> RefusalOf(const boost::system::error_code& error,
                                      const HttpServerOptions& options, bool has_target) {
  if (error == http::error::body_limit) {
    return TextResponse(413, absl::StrCat("the request body is larger than the limit http_body_bytes = ",
                                          options.body_bytes));
  }
  const bool long_header = error == http::error::header_limit || error == http::error::buffer_overflow;
  if (long_header && !has_target) {  // RFC 9112 section 3
    return TextResponse(414, absl::StrCat("the request line is longer than ", options.header_bytes,
                                          " bytes; POST a long query instead"));
  }
  if (long_header) {
    return TextResponse(431,
                        absl::StrCat("the request header is larger than ", options.header_bytes, " bytes"));
  }
  if (error.category() == make_error_code(http::error::bad_method).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message) {
    return TextResponse(400, absl::StrCat("this is not an HTTP/1.1 request: ", error.message()));
  }
  return std::nullopt;
}

// RFC 9110 section 5.6.7: "Sun, 06 Nov 1994 08:49:37 GMT".
std::string HttpDate(TimeMicros now_us) {
  return absl::FormatTime("%a, %d %b %Y %H:%M:%S GMT", absl::FromUnixMicros(now_us), absl::UTCTimeZone());
}

// RFC 9112 section 3.2.2: a target with a scheme, as proxies get it, names the host itself; the header Host counts for
// nothing then. Cuts scheme and host off; of a target without a path "/" is left (RFC 9110 section 4.2.3).
std::string TakeHost(std::string_view target, HttpFields* headers) {
  constexpr std::string_view kScheme = "http://";
  if (!absl::StartsWithIgnoreCase(ToAbsl(target), ToAbsl(kScheme))) return std::string(target);
  target.remove_prefix(kScheme.size());
  const size_t end = std::min(target.find_first_of("/?"), target.size());
  for (auto& [name, value] : *headers) {
    if (name == "host") value = target.substr(0, end);
  }
  target.remove_prefix(end);
  return Concat(target.starts_with('/') ? "" : "/", target);
}

std::string ChunkOf(std::string_view data) {
  return data.empty() ? std::string() : Concat(absl::StrFormat("%x\r\n", data.size()), data, "\r\n");
}

}  // namespace

HttpConnection::HttpConnection(Socket socket, HttpShared* shared)
    : stream_(std::move(socket)), shared_(*shared), wake_(stream_.get_executor()) {
  wake_.expires_at(net::steady_timer::time_point::max());
  ErrorCode ignored;
  stream_.socket().set_option(net::ip::tcp::no_delay(true), ignored);
  ++shared_.open;
}

HttpConnection::~HttpConnection() {
  if (answer_) answer_->SetGone();
  --shared_.open;
}

void HttpConnection::Close() {
  net::post(stream_.get_executor(), [self = shared_from_this()] {
    self->closed_ = true;
    self->woken_ = true;
    self->wake_.cancel();
    ErrorCode ignored;
    self->stream_.socket().close(ignored);
  });
}

net::awaitable<void> HttpConnection::Run() {
  while (!closed_) {
    const bool go_on = co_await ServeOne();
    if (answer_) answer_->SetGone();
    answer_.reset();
    if (!go_on) break;
  }
  ErrorCode ignored;
  stream_.socket().shutdown(Socket::shutdown_both, ignored);
  stream_.socket().close(ignored);
}

net::awaitable<void> HttpConnection::TurnAway() {
  co_await RefuseAndClose(
      TextResponse(503, absl::StrCat("too many connections: the limit http_connections is ",
                                     shared_.options.connections)),
      11);
  ErrorCode ignored;
  stream_.socket().close(ignored);
}

net::awaitable<bool> HttpConnection::ServeOne() {
  Parser parser;
  parser.header_limit(shared_.options.header_bytes);
  parser.body_limit(shared_.options.body_bytes);
  ErrorCode error;
  stream_.expires_after(shared_.options.idle_timeout);
  co_await http::async_read_header(stream_, buffer_, parser, net::redirect_error(net::use_awaitable, error));
  if (error) {
    std::optional<HttpResponse> refusal = RefusalOf(error, shared_.options, !parser.get().target().empty());
    if (refusal) co_await RefuseAndClose(*std::move(refusal), 11);
    co_return false;
  }
  const unsigned version = parser.get().version();
  std::shared_ptr<MemoryUse> body_memory(new MemoryUse(SIZE_MAX, shared_.bodies.get()),
                                         [budget = shared_.bodies](MemoryUse* use) { delete use; });
  HttpRequest request;
  const HttpHandler* handler = nullptr;
  std::optional<HttpResponse> refusal = CheckHeader(parser, &request, &handler);
  if (refusal) {
    if (!parser.is_done()) {
      co_await RefuseAndClose(*std::move(refusal), version);
      co_return false;
    }
  } else if (!co_await ReadBody(parser, *body_memory)) {
    co_return false;
  }
  const bool keep_alive = parser.keep_alive();
  const bool head_only = request.method == "HEAD";
  answer_ = std::make_shared<HttpAnswer>();
  answer_->OnProgress([this, weak = weak_from_this(), executor = stream_.get_executor()] {
    net::post(executor, [this, weak] {
      const auto self = weak.lock();
      if (!self) return;
      woken_ = true;
      wake_.cancel();
    });
  });
  if (refusal) {
    ++shared_.refused;
    HttpExchange(std::move(request), answer_).Respond(*std::move(refusal));
  } else {
    request.body = std::move(parser.get().body());
    WatchClient(answer_);
    (*handler)(std::make_shared<HttpExchange>(std::move(request), answer_, std::move(body_memory)));
  }
  ++shared_.requests;
  const bool sent = co_await SendAnswer(*answer_, head_only, version, keep_alive);
  ErrorCode ignored;
  stream_.socket().cancel(ignored);  // the watch
  co_return sent&& keep_alive;
}

net::awaitable<bool> HttpConnection::ReadBody(Parser& parser, MemoryUse& memory) {
  const auto expect = parser.get().find(http::field::expect);
  if (expect != parser.get().end() && beast::iequals(expect->value(), "100-continue") && !parser.is_done()) {
    if (!co_await Send("HTTP/1.1 100 Continue\r\n\r\n")) co_return false;
  }
  ErrorCode error;
  std::optional<HttpResponse> refusal;
  stream_.expires_after(shared_.options.body_timeout);
  for (size_t counted = 0; !parser.is_done() && !error && !refusal;) {
    co_await http::async_read_some(stream_, buffer_, parser, net::redirect_error(net::use_awaitable, error));
    const size_t now = parser.get().body().size();
    if (!memory.Add(now - counted)) {
      refusal = TextResponse(503, std::string(shared_.bodies->Refusal().message()));
      refusal->headers.emplace_back("Retry-After", "1");
      std::string().swap(parser.get().body());
      memory.Reset();
    }
    counted = now;
  }
  stream_.expires_never();
  if (!error && !refusal) co_return true;
  if (error) refusal = RefusalOf(error, shared_.options, true);
  if (refusal) co_await RefuseAndClose(*std::move(refusal), parser.get().version());
  co_return false;
}

std::optional<HttpResponse> HttpConnection::CheckHeader(Parser& parser, HttpRequest* request,
                                                        const HttpHandler** handler) const {
  const auto& message = parser.get();
  request->method = View(message.method_string());
  bool second_host = false;
  for (const auto& field : message) {
    std::string name = absl::AsciiStrToLower(ToAbsl(View(field.name_string())));
    if (name == "host" && !request->Header("host").empty()) second_host = true;
    request->headers.emplace_back(std::move(name), View(field.value()));
  }
  if (second_host) return TextResponse(400, "the request has more than one Host header");
  if (message.version() < 11 &&
      request->Header("host").empty()) {  // may be missing, and no browser is that old
    request->headers.emplace_back("host", shared_.guard.OwnName());
  }
  const std::string target = TakeHost(View(message.target()), &request->headers);
  if (std::optional<HttpResponse> refusal = shared_.guard.Refuse(*request)) return refusal;
  if (!target.starts_with('/')) return TextResponse(400, "the request target must be a path");
  const size_t question = target.find('?');
  const std::optional<std::string> path = PercentDecode(target.substr(0, question), false);
  std::optional<HttpFields> parameters;
  if (question != std::string_view::npos) {
    parameters = ParseForm(target.substr(question + 1));
  } else {
    parameters.emplace();
  }
  if (!path || !parameters) return TextResponse(400, "the request target has a broken %-escape");
  request->path = *path;
  request->raw_path = target.substr(0, question);
  request->parameters = *std::move(parameters);

  const std::string encoding = request->Header("content-encoding");
  if (!encoding.empty() && !absl::EqualsIgnoreCase(encoding, "identity")) {
    return TextResponse(
        415, absl::StrCat("send the body as it is: a Content-Encoding of ", encoding, " is not read"));
  }

  HttpResponse refusal;
  *handler = shared_.routes.Find(request->method, request->path, &refusal);
  if (*handler == nullptr) return refusal;
  if (parser.content_length() && *parser.content_length() > shared_.options.body_bytes) {
    return RefusalOf(http::error::body_limit, shared_.options, true);
  }
  return std::nullopt;
}

std::string HttpConnection::HeadText(const HttpResponse& response, std::optional<size_t> length,
                                     unsigned version, bool keep_alive) const {
  const beast::string_view reason = http::obsolete_reason(static_cast<http::status>(response.status));
  std::string head = Concat("HTTP/1.1 ", std::to_string(response.status), " ", View(reason), "\r\n");
  if (!response.content_type.empty()) absl::StrAppend(&head, "Content-Type: ", response.content_type, "\r\n");
  if (length) {
    absl::StrAppend(&head, "Content-Length: ", *length, "\r\n");
  } else if (version >= 11) {
    head += "Transfer-Encoding: chunked\r\n";
  }
  if (shared_.options.clock != nullptr)
    absl::StrAppend(&head, "Date: ", HttpDate(shared_.options.clock->Now()), "\r\n");
  for (const auto& [name, value] : response.headers) absl::StrAppend(&head, name, ": ", value, "\r\n");
  // Whatever a browser makes of a text that came from the graph, it is not a page of ours.
  head += "X-Content-Type-Options: nosniff\r\n";
  if (!keep_alive) {
    head += "Connection: close\r\n";
  } else if (version < 11) {
    head += "Connection: keep-alive\r\n";
  }
  return head + "\r\n";
}

net::awaitable<bool> HttpConnection::SendAnswer(HttpAnswer& answer, bool head_only, unsigned version,
                                                bool keep_alive) {
  bool streamed = false;
  while (true) {
    HttpAnswer::Progress progress = answer.Take();
    std::string bytes;
    if (progress.head) {
      streamed = progress.streamed;
      const bool lasting = keep_alive && (!streamed || version >= 11);
      bytes = HeadText(*progress.head,
                       streamed ? std::nullopt : std::optional<size_t>(progress.head->body.size()), version,
                       lasting);
      if (!streamed && !head_only) bytes += progress.head->body;
    }
    if (!head_only) bytes += streamed && version >= 11 ? ChunkOf(progress.data) : progress.data;
    if (progress.aborted) co_return false;
    if (progress.ended && streamed && version >= 11 && !head_only) bytes += "0\r\n\r\n";
    if (!bytes.empty() && !co_await Send(std::move(bytes))) {
      answer.SetGone();
      co_return false;
    }
    // A HEAD request is answered as soon as its head is known.
    if (progress.ended || (progress.head && head_only)) co_return version >= 11 || !streamed;
    co_await WaitForWake();
    if (closed_) co_return false;
  }
}

net::awaitable<bool> HttpConnection::Send(std::string bytes) {
  for (size_t at = 0; at < bytes.size(); at += kPieceBytes) {
    ErrorCode error;
    stream_.expires_after(shared_.options.write_timeout);
    const net::const_buffer piece(bytes.data() + at, std::min(kPieceBytes, bytes.size() - at));
    co_await net::async_write(stream_, piece, net::redirect_error(net::use_awaitable, error));
    if (error) co_return false;
  }
  stream_.expires_never();
  co_return true;
}

net::awaitable<void> HttpConnection::RefuseAndClose(HttpResponse response, unsigned version) {
  ++shared_.refused;
  ++shared_.requests;
  const std::string head = HeadText(response, response.body.size(), version, false);
  if (!co_await Send(head + response.body)) co_return;
  // Closing with unread data would reset the connection and might take the answer away from the client.
  ErrorCode error;
  stream_.socket().shutdown(Socket::shutdown_send, error);
  const auto until = std::chrono::steady_clock::now() + kDrainTime;
  buffer_.consume(buffer_.size());
  for (size_t drained = 0; !error && drained < kDrainBytes && std::chrono::steady_clock::now() < until;) {
    stream_.expires_after(kDrainTime);
    drained += co_await stream_.async_read_some(buffer_.prepare(kPieceBytes),
                                                net::redirect_error(net::use_awaitable, error));
  }
}

// While the answer is being made nothing else reads from the socket: an end of the stream is noticed here, so
// that a query that nobody waits for is given up.
void HttpConnection::WatchClient(std::shared_ptr<HttpAnswer> answer) {
  stream_.socket().async_wait(Socket::wait_read, [self = shared_from_this(), answer](const ErrorCode& error) {
    if (error || !self->stream_.socket().is_open()) return;
    char byte;
    const ssize_t got = recv(self->stream_.socket().native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    const bool gone = got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    if (!gone) return;  // the next request came early; the end is then noticed when sending
    answer->SetGone();
    if (self->answer_ == answer) {
      self->closed_ = true;
      self->woken_ = true;
      self->wake_.cancel();
    }
  });
}

net::awaitable<void> HttpConnection::WaitForWake() {
  if (!woken_) {
    ErrorCode ignored;
    co_await wake_.async_wait(net::redirect_error(net::use_awaitable, ignored));
  }
  woken_ = false;
}

}  // namespace docent
