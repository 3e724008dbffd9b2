#include "kb_server/work/http_fetch.h"

#include <utility>  // before Asio: Boost 1.74 uses std::exchange in its coroutines without including it

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <limits>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/version.h"

namespace docent::server {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using tcp = net::ip::tcp;
using Error = boost::system::error_code;

constexpr std::chrono::milliseconds kLookAtCancellation{50};

absl::Status ToStatus(const Error& error, const char* doing, const FetchRequest& request) {
  if (error == beast::error::timeout) {
    return absl::DeadlineExceededError(
        absl::StrCat(request.url, " did not answer within ", request.timeout.count(), " ms"));
  }
  return absl::UnavailableError(absl::StrCat(request.url, ": ", doing, ": ", error.message()));
}

void TakeHead(const http::response_header<>& head, HttpResponse* response) {
  response->status = static_cast<int>(head.result_int());
  response->content_type.clear();
  for (const auto& field : head) {
    std::string name =
        absl::AsciiStrToLower(absl::string_view(field.name_string().data(), field.name_string().size()));
    std::string value(field.value().data(), field.value().size());
    if (name == "content-type") response->content_type = value;
    response->headers.emplace_back(std::move(name), std::move(value));
  }
}

// What all connections with TLS share. It is made when the first one needs it: that takes 20 ms, for the certificates of the
// system.
net::ssl::context& TlsContext() {
  static net::ssl::context* const shared = [] {
    auto* made = new net::ssl::context(net::ssl::context::tls_client);
    Error ignored;  // without certificates none is trusted
    made->set_default_verify_paths(ignored);
    made->set_verify_mode(net::ssl::verify_peer, ignored);
    return made;
  }();
  return *shared;
}

// Sends the request and reads the answer on a connected stream.
template <typename Stream>
net::awaitable<absl::Status> Exchange(Stream& stream, const FetchRequest& request, const HttpUrl& url,
                                      HttpResponse* response) {
  Error error;
  http::request<http::string_body> message;
  message.method_string(request.method);
  message.target(url.target);
  message.version(11);
  const bool default_port = url.port == (url.tls ? "443" : "80");
  const std::string host = url.host.find(':') == std::string::npos ? url.host : "[" + url.host + "]";
  message.set(http::field::host, default_port ? host : host + ":" + url.port);
  message.set(http::field::user_agent, Concat("docent/", Version()));
  message.set(http::field::connection, "close");
  for (const auto& [name, value] : request.headers) message.set(name, value);
  message.body() = request.body;
  message.prepare_payload();
  co_await http::async_write(stream, message, net::redirect_error(net::use_awaitable, error));
  if (error) co_return ToStatus(error, "sending the request", request);
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(std::numeric_limits<uint64_t>::max());  // ours is looked at below, after each piece
  co_await http::async_read_header(stream, buffer, parser, net::redirect_error(net::use_awaitable, error));
  if (!error) TakeHead(parser.get(), response);
  if (!error && !request.reads_body) co_return absl::OkStatus();
  size_t counted = 0;
  while (!error && !parser.is_done()) {
    if (parser.content_length().value_or(0) > request.max_bytes ||
        parser.get().body().size() > request.max_bytes)
      break;
    co_await http::async_read_some(stream, buffer, parser, net::redirect_error(net::use_awaitable, error));
    const size_t size = parser.get().body().size();
    if (request.count) {
      if (absl::Status room = request.count(size - std::exchange(counted, size)); !room.ok()) co_return room;
    }
  }
  if (error) co_return ToStatus(error, "reading the answer", request);
  if (!parser.is_done() || parser.get().body().size() > request.max_bytes) {
    co_return absl::ResourceExhaustedError(absl::StrCat(
        "the answer of ", request.url, " is larger than the limit remote_bytes = ", request.max_bytes));
  }
  response->body = std::move(parser.get().body());
  co_return absl::OkStatus();
}

net::awaitable<absl::Status> Run(net::io_context& context, const FetchRequest& request, const HttpUrl& url,
                                 HttpResponse* response) {
  Error error;
  tcp::resolver resolver(context);
  const auto addresses =
      co_await resolver.async_resolve(url.host, url.port, net::redirect_error(net::use_awaitable, error));
  if (error) co_return ToStatus(error, "looking up the host", request);
  beast::tcp_stream plain(context);
  plain.expires_after(request.timeout);
  co_await plain.async_connect(addresses, net::redirect_error(net::use_awaitable, error));
  if (error) co_return ToStatus(error, "connecting", request);
  if (!url.tls) co_return co_await Exchange(plain, request, url, response);
  beast::ssl_stream<beast::tcp_stream> stream(std::move(plain), TlsContext());
  SSL_set_tlsext_host_name(stream.native_handle(), url.host.c_str());
  stream.set_verify_callback(net::ssl::host_name_verification(url.host), error);
  co_await stream.async_handshake(net::ssl::stream_base::client,
                                  net::redirect_error(net::use_awaitable, error));
  if (error) co_return ToStatus(error, "agreeing on TLS", request);
  co_return co_await Exchange(stream, request, url, response);
}

}  // namespace

std::optional<HttpUrl> ParseHttpUrl(std::string_view text) {
  HttpUrl url;
  const std::string scheme = absl::AsciiStrToLower(ToAbsl(text.substr(0, text.find(':'))));
  if (scheme != "http" && scheme != "https") return std::nullopt;
  url.tls = scheme == "https";
  text.remove_prefix(scheme.size());
  if (!text.starts_with("://")) return std::nullopt;
  text.remove_prefix(3);
  const std::string_view authority = text.substr(0, text.find_first_of("/?#"));
  text.remove_prefix(authority.size());
  if (authority.find('@') != std::string_view::npos) return std::nullopt;
  const std::optional<HostAndPort> host = SplitHostAndPort(authority);
  if (!host || host->host.empty()) return std::nullopt;
  url.host = host->host;
  url.port = host->port ? absl::StrCat(*host->port) : url.tls ? "443" : "80";
  url.target = text.substr(0, text.find('#'));
  if (!url.target.starts_with('/')) url.target.insert(0, "/");
  const auto plain = [](char c) { return c > ' ' && c < 0x7F; };
  if (!std::all_of(url.target.begin(), url.target.end(), plain)) return std::nullopt;
  return url;
}

std::optional<absl::Duration> RetryAfterOf(const HttpFields& headers, absl::Time now) {
  const auto found = std::find_if(headers.begin(), headers.end(),
                                  [](const auto& field) { return field.first == "retry-after"; });
  if (found == headers.end()) return std::nullopt;
  int64_t seconds = 0;
  if (absl::SimpleAtoi(found->second, &seconds))
    return seconds < 0 ? std::nullopt : std::make_optional(absl::Seconds(seconds));
  absl::Time date;
  if (!absl::ParseTime("%a, %d %b %Y %H:%M:%S GMT", found->second, &date, nullptr)) return std::nullopt;
  return std::max(absl::ZeroDuration(), date - now);
}

absl::StatusOr<HttpResponse> Fetch(const FetchRequest& request, Cancellation* cancellation) {
  const std::optional<HttpUrl> url = ParseHttpUrl(request.url);
  if (!url) return absl::InvalidArgumentError(request.url + " is not an http or https URL");
  net::io_context context(1);
  HttpResponse response;
  absl::Status status = absl::UnknownError("no answer");
  bool done = false;
  net::co_spawn(
      context,
      [&]() -> net::awaitable<void> {
        status = co_await Run(context, request, *url, &response);
        done = true;
      },
      net::detached);
  const auto start = std::chrono::steady_clock::now();
  const auto deadline = start + request.timeout;
  const auto half_time = start + (cancellation != nullptr ? cancellation->Left() / 2 : request.timeout);
  while (true) {
    context.run_for(kLookAtCancellation);
    context.restart();
    if (done) break;
    if (cancellation != nullptr) {
      if (absl::Status cancelled = cancellation->CheckNow(); !cancelled.ok()) return cancelled;
      if (request.half_time && std::chrono::steady_clock::now() >= half_time)
        return absl::DeadlineExceededError(request.url +
                                           " did not answer within half of the time that the query had left");
    }
    // Looking up a host does not end by itself.
    if (std::chrono::steady_clock::now() >= deadline) return ToStatus(beast::error::timeout, "", request);
  }
  if (!status.ok()) return status;
  return response;
}

}  // namespace docent::server
