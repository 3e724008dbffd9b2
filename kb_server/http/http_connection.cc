#include "kb_server/http/http_connection.h"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/status.hpp>
#include <cerrno>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "graph/base/text.h"
#include "kb_server/http/http_body.h"
#include "kb_server/http/http_body_reader.h"

namespace docent::server {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr size_t kReadBytes = 16u << 10;   // at once
constexpr size_t kPieceBytes = 64u << 10;  // written at once, each with the write timeout
constexpr size_t kDrainBytes = 4u << 20;   // read and dropped after a refusal, at most
constexpr std::chrono::seconds kDrainTime{2};
constexpr std::chrono::milliseconds kDrainLook{10};
// A client that vanished without a word is noticed after about two minutes of silence.
constexpr int kKeepAliveIdleSeconds = 60, kKeepAliveEverySeconds = 15, kKeepAliveProbes = 4;
constexpr int kSwitchingProtocols = 101, kNotModified = 304;

void ProbeSilence(int socket) {
  const int on = 1;
  setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof(on));
  setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &kKeepAliveIdleSeconds, sizeof(int));
  setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &kKeepAliveEverySeconds, sizeof(int));
  setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &kKeepAliveProbes, sizeof(int));
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
    : stream_(std::move(socket)),
      shared_(*shared),
      client_(shared->options.clients == nullptr ? nullptr : shared->options.clients->Make("http")),
      buffer_(kReadBytes),
      wake_(stream_.get_executor()) {
  wake_.expires_at(net::steady_timer::time_point::max());
  ErrorCode ignored;
  stream_.socket().set_option(net::ip::tcp::no_delay(true), ignored);
  ProbeSilence(stream_.socket().native_handle());
  ++shared_.open;
}

HttpConnection::~HttpConnection() {
  if (answer_) answer_->SetGone();
  if (closing_) --shared_.closing;
  --shared_.open;
}

void HttpConnection::Enter(Phase phase) {
  since_ = std::chrono::steady_clock::now();
  phase_ = phase;
}

void HttpConnection::Close() {
  if (!closing_.exchange(true)) ++shared_.closing;
  net::post(stream_.get_executor(), [self = shared_from_this()] { self->CloseNow(); });
}

void HttpConnection::CloseNow() {
  closed_ = true;
  woken_ = true;
  wake_.cancel();
  ErrorCode ignored;
  stream_.socket().close(ignored);
}

net::awaitable<void> HttpConnection::Run() {
  share_.emplace(shared_.options.send_budget, [weak = weak_from_this()](const absl::Status&) {
    std::shared_ptr<HttpConnection> self = weak.lock();
    if (self == nullptr) return;
    const auto executor = self->stream_.get_executor();
    net::post(executor,
              [self = std::move(self)] { self->CloseNow(); });  // which may be its end, on its own thread
  });
  while (!closed_) {
    const bool go_on = co_await ServeOne();
    if (answer_) answer_->SetGone();
    answer_.reset();
    if (!go_on) break;
    Enter(Phase::kIdle);
  }
  ErrorCode ignored;
  stream_.socket().shutdown(Socket::shutdown_both, ignored);
  stream_.socket().close(ignored);
}

net::awaitable<void> HttpConnection::TurnAway() {
  co_await RefuseAndClose(TextResponse(
      503,
      absl::StrCat("too many connections: the limit http_connections is ", shared_.options.connections)));
  ErrorCode ignored;
  stream_.socket().close(ignored);
}

net::awaitable<bool> HttpConnection::ServeOne() {
  shared_with_.clear();
  HttpHeadReader reader({shared_.options.header_bytes, shared_.options.header_fields});
  if (!co_await ReadHead(reader)) co_return false;
  HttpHead& head = reader.head();
  std::shared_ptr<MemoryUse> body_memory(new MemoryUse(SIZE_MAX, shared_.bodies.get()),
                                         [budget = shared_.bodies](MemoryUse* use) { delete use; });
  HttpRequest request;
  const HttpRoute* route = nullptr;
  std::optional<HttpResponse> refusal = CheckHead(head, &request, &route);
  shared_with_ = shared_.guard.SharedWith(request);
  if (refusal && head.has_body()) {
    co_await RefuseAndClose(*std::move(refusal));
    co_return false;
  }
  if (!refusal && !co_await ReadBody(head, &request.body, *body_memory)) co_return false;
  const bool head_only = request.method == "HEAD";
  Enter(Phase::kWork);
  answer_ = std::make_shared<HttpAnswer>();
  answer_->CountIn(&*share_);
  answer_->OnProgress([this, weak = weak_from_this(), executor = stream_.get_executor()] {
    net::post(executor, [this, weak] {
      const auto self = weak.lock();
      if (!self) return;
      woken_ = true;
      wake_.cancel();
    });
  });
  if (refusal) {
    if (refusal->status >= 400) ++shared_.refused;
    HttpExchange(std::move(request), answer_).Respond(*std::move(refusal));
  } else {
    WatchClient(answer_);
    route->handler(
        std::make_shared<HttpExchange>(std::move(request), answer_, std::move(body_memory), client_));
  }
  ++shared_.requests;
  const bool sent = co_await SendAnswer(*answer_, head_only, head.minor_version > 0, head.keep_alive);
  if (upgraded_) co_await AwaitUpgradedEnd();
  ErrorCode ignored;
  stream_.socket().cancel(ignored);  // the watch
  co_return sent&& head.keep_alive && !upgraded_;
}

net::awaitable<bool> HttpConnection::ReadHead(HttpHeadReader& reader) {
  const bool first = !served_one_;
  served_one_ = true;
  stream_.expires_after(first || !unread_.empty() ? shared_.options.header_timeout
                                                  : shared_.options.idle_timeout);
  while (true) {
    const bool idle = !reader.begun();
    const HttpHeadReader::State state = reader.Read(&unread_);
    if (state == HttpHeadReader::State::kDone) break;
    if (state == HttpHeadReader::State::kRefused) {
      co_await RefuseAndClose(std::move(reader.refusal()));
      co_return false;
    }
    if (idle && reader.begun()) Enter(Phase::kHead);
    if (idle && reader.begun() && !first) stream_.expires_after(shared_.options.header_timeout);
    if (!co_await ReadMore()) co_return false;
  }
  stream_.expires_never();
  co_return true;
}

net::awaitable<bool> HttpConnection::ReadMore() {
  ErrorCode error;
  const size_t bytes =
      co_await stream_.async_read_some(net::buffer(buffer_), net::redirect_error(net::use_awaitable, error));
  unread_ = std::string_view(buffer_.data(), bytes);
  co_return !error;
}

net::awaitable<bool> HttpConnection::ReadBody(const HttpHead& head, std::string* body, MemoryUse& memory) {
  HttpBodyReader reader(head, {shared_.options.body_bytes, shared_.options.header_bytes});
  if (head.expects_continue && reader.state() == HttpBodyReader::State::kMore && unread_.empty()) {
    if (!co_await Send("HTTP/1.1 100 Continue\r\n\r\n")) co_return false;
  }
  Enter(Phase::kBody);
  stream_.expires_after(shared_.options.body_timeout);
  std::optional<HttpResponse> refusal;
  while (reader.state() == HttpBodyReader::State::kMore) {
    if (unread_.empty() && !co_await ReadMore()) co_return false;
    const size_t before = body->size();
    reader.Read(&unread_, body);
    if (memory.Add(body->size() - before)) continue;
    refusal = TextResponse(503, std::string(shared_.bodies->Refusal().message()));
    refusal->headers.emplace_back("Retry-After", "1");
    std::string().swap(*body);
    memory.Release(memory.used());
    memory.Settle();
    break;
  }
  if (reader.state() == HttpBodyReader::State::kRefused) refusal = std::move(reader.refusal());
  stream_.expires_never();
  if (refusal) co_await RefuseAndClose(*std::move(refusal));
  co_return !refusal;
}

std::optional<HttpResponse> HttpConnection::CheckHead(HttpHead& head, HttpRequest* request,
                                                      const HttpRoute** route) const {
  request->method = std::move(head.method);
  request->headers = std::move(head.fields);
  if (request->Header("host").empty() &&
      head.minor_version == 0) {  // may be missing, and no browser is that old
    request->headers.emplace_back("host", shared_.guard.OwnName());
  }
  const std::string target = TakeHost(head.target, &request->headers);
  if (std::optional<HttpResponse> refusal = shared_.guard.Refuse(*request)) return refusal;
  if (std::optional<HttpResponse> preflight = shared_.guard.Preflight(*request)) return preflight;
  if (!target.starts_with('/')) return TextResponse(400, "the request target must be a path");
  const size_t question = target.find('?');
  const std::optional<std::string> path = PercentDecode(target.substr(0, question), false);
  absl::StatusOr<HttpFields> parameters;
  if (question != std::string_view::npos) {
    parameters = ParseForm(target.substr(question + 1), shared_.options.parameters);
  } else {
    parameters.emplace();
  }
  if (!path) return TextResponse(400, "the request target has a broken %-escape");
  if (!parameters.ok()) {
    return TextResponse(400, absl::StrCat("the request target: ", parameters.status().message()));
  }
  request->path = *path;
  request->raw_path = target.substr(0, question);
  request->parameters = *std::move(parameters);

  HttpResponse refusal;
  *route = shared_.routes.Find(*request, &refusal);
  if (*route == nullptr) return refusal;
  if ((*route)->any_encoding) return std::nullopt;
  return RefuseEncoding(request->Header("content-encoding"));
}

std::string HttpConnection::HeadText(const HttpResponse& response, std::optional<size_t> length, bool chunks,
                                     bool keep_alive) const {
  const auto reason = http::obsolete_reason(static_cast<http::status>(response.status));
  std::string head = Concat("HTTP/1.1 ", std::to_string(response.status), " ",
                            std::string_view(reason.data(), reason.size()), "\r\n");
  if (!response.content_type.empty()) absl::StrAppend(&head, "Content-Type: ", response.content_type, "\r\n");
  if (response.status == kNotModified || response.status == kSwitchingProtocols) {
    // No body, and no length of one: RFC 9110 section 8.6.
  } else if (length) {
    absl::StrAppend(&head, "Content-Length: ", *length, "\r\n");
  } else if (chunks) {
    head += "Transfer-Encoding: chunked\r\n";
  }
  if (shared_.options.clock != nullptr)
    absl::StrAppend(&head, "Date: ", HttpDate(shared_.options.clock->Now()), "\r\n");
  for (const HttpFields* fields : {&response.headers, &shared_with_}) {
    for (const auto& [name, value] : *fields) absl::StrAppend(&head, name, ": ", value, "\r\n");
  }
  // Whatever a browser makes of a text that came from the graph, it is not a page of ours.
  head += "X-Content-Type-Options: nosniff\r\n";
  const bool upgraded = response.status == kSwitchingProtocols;
  if (!keep_alive && !upgraded) {
    head += "Connection: close\r\n";
  } else if (!chunks && !upgraded) {
    head += "Connection: keep-alive\r\n";
  }
  return head + "\r\n";
}

net::awaitable<bool> HttpConnection::SendAnswer(HttpAnswer& answer, bool head_only, bool chunks,
                                                bool keep_alive) {
  bool streamed = false;
  while (true) {
    HttpAnswer::Progress progress = answer.Take();
    const size_t counted = progress.bytes();
    std::string bytes;
    if (progress.head) {
      streamed = progress.streamed;
      if (progress.upgraded != nullptr) {
        upgraded_ = true;
        reading_upgraded_ = true;
        chunks = false;
        net::co_spawn(stream_.get_executor(), ReadUpgraded(std::move(progress.upgraded), answer_),
                      net::detached);
      }
      const bool lasting = keep_alive && (!streamed || chunks);
      bytes = HeadText(*progress.head,
                       streamed ? std::nullopt : std::optional<size_t>(progress.head->body.size()), chunks,
                       lasting);
      if (!streamed && !head_only) bytes += progress.head->body;
    }
    if (!head_only) bytes += streamed && chunks ? ChunkOf(progress.data) : progress.data;
    if (progress.aborted) co_return false;
    if (progress.ended && streamed && chunks && !head_only) bytes += "0\r\n\r\n";
    progress.data.clear();
    const bool sent = bytes.empty() || co_await Send(std::move(bytes));
    share_->Release(counted);
    if (!sent) {
      answer.SetGone();
      co_return false;
    }
    // A HEAD request is answered as soon as its head is known.
    if (progress.ended || (progress.head && head_only)) co_return chunks || !streamed;
    co_await WaitForWake();
    if (closed_) co_return false;
  }
}

net::awaitable<void> HttpConnection::ReadUpgraded(std::shared_ptr<HttpUpgradeReader> reader,
                                                  std::shared_ptr<HttpAnswer> answer) {
  const auto self = shared_from_this();
  ErrorCode error;
  while (!error && !closed_) {
    if (!unread_.empty()) reader->OnBytes(std::exchange(unread_, {}));
    // Not by the stream, whose time limits are those of the answer.
    const size_t bytes = co_await stream_.socket().async_read_some(
        net::buffer(buffer_), net::redirect_error(net::use_awaitable, error));
    unread_ = std::string_view(buffer_.data(), bytes);
  }
  reading_upgraded_ = false;
  answer->SetGone();
  closed_ = true;
  woken_ = true;
  wake_.cancel();
}

net::awaitable<void> HttpConnection::AwaitUpgradedEnd() {
  ErrorCode ignored;
  stream_.socket().shutdown(Socket::shutdown_send, ignored);
  net::steady_timer pause(stream_.get_executor());
  for (auto waited = std::chrono::milliseconds(0); reading_upgraded_ && waited < kDrainTime;
       waited += kDrainLook) {
    pause.expires_after(kDrainLook);
    co_await pause.async_wait(net::redirect_error(net::use_awaitable, ignored));
  }
}

net::awaitable<bool> HttpConnection::Send(std::string bytes) {
  for (size_t at = 0; at < bytes.size(); at += kPieceBytes) {
    ErrorCode error;
    Enter(Phase::kSend);
    stream_.expires_after(shared_.options.write_timeout);
    const net::const_buffer piece(bytes.data() + at, std::min(kPieceBytes, bytes.size() - at));
    co_await net::async_write(stream_, piece, net::redirect_error(net::use_awaitable, error));
    if (error) co_return false;
  }
  Enter(Phase::kWork);
  stream_.expires_never();
  co_return true;
}

net::awaitable<void> HttpConnection::RefuseAndClose(HttpResponse response) {
  ++shared_.refused;
  ++shared_.requests;
  const std::string head = HeadText(response, response.body.size(), true, false);
  if (!co_await Send(head + response.body)) co_return;
  // Closing with unread data would reset the connection and might take the answer away from the client.
  ErrorCode error;
  stream_.socket().shutdown(Socket::shutdown_send, error);
  const auto until = std::chrono::steady_clock::now() + kDrainTime;
  unread_ = {};
  Enter(Phase::kIdle);
  for (size_t drained = 0; !error && drained < kDrainBytes && std::chrono::steady_clock::now() < until;) {
    stream_.expires_after(kDrainTime);
    drained += co_await stream_.async_read_some(net::buffer(buffer_),
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

}  // namespace docent::server
