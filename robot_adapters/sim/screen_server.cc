#include "robot_adapters/sim/screen_server.h"

#include <utility>  // before asio: Boost 1.74 with GCC 12 needs it

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include <chrono>
#include <list>
#include <map>
#include <string_view>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/synchronization/mutex.h"

namespace docent::robot {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using tcp = asio::ip::tcp;

namespace {

constexpr std::chrono::seconds kConnectionTimeout{15};
constexpr std::chrono::milliseconds kPause{50};  // after an error of accepting
constexpr size_t kRequestBodyBytes = 1024;

// Follows the robot from page to page, and marks the words that it speaks.
constexpr char kScript[] = R"js("use strict";
const line = document.getElementById("spoken");
let change = null;
let text = "";
function words(now) {
  if (now.text !== text) {
    text = now.text;
    line.hidden = text === "";
    line.lang = now.language || "en";
    let end = 0;
    line.replaceChildren(...(text.match(/\S+\s*/g) || []).map((word) => {
      const span = document.createElement("span");
      span.textContent = word;
      span.dataset.end = end += word.length;
      return span;
    }));
  }
  const place = now.share * text.length;
  let spoken = true;
  for (const span of line.children) {
    const past = Number(span.dataset.end) <= place;
    span.className = past ? "said" : spoken ? "now" : "";
    spoken = past;
  }
}
async function look() {
  try {
    const now = await (await fetch("/-/now")).json();
    if (change !== null && now.change !== change && location.pathname === "/") return location.reload();
    change = now.change;
    words(now);
  } catch {
    // The robot is away: the page stays.
  }
  setTimeout(look, 250);
}
look();
)js";

// A JSON string (RFC 8259, section 7) of UTF-8 text.
std::string Json(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      absl::StrAppendFormat(&out, "\\u%04x", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

// What is shown and said; shared by the server's thread and the callers of Show and Say.
class Pages {
 public:
  void Put(const std::string& name, std::string html) {
    absl::MutexLock lock(&mutex_);
    pages_["/"] = html;
    pages_["/" + name] = std::move(html);
    ++changes_;
  }
  void Say(const std::string& text, const std::string& language, double share) {
    absl::MutexLock lock(&mutex_);
    text_ = text;
    language_ = language;
    share_ = share;
  }
  std::string Now() const {
    absl::MutexLock lock(&mutex_);
    return absl::StrFormat(R"({"change": %d, "text": %s, "language": %s, "share": %.3f})", changes_,
                           Json(text_), Json(language_), share_);
  }
  // False: no such page.
  bool Get(const std::string& path, std::string* html) const {
    absl::MutexLock lock(&mutex_);
    auto found = pages_.find(path);
    if (found == pages_.end()) return false;
    *html = found->second;
    return true;
  }

 private:
  mutable absl::Mutex mutex_;
  std::map<std::string, std::string> pages_ ABSL_GUARDED_BY(mutex_);
  int changes_ ABSL_GUARDED_BY(mutex_) = 0;
  std::string text_ ABSL_GUARDED_BY(mutex_), language_ ABSL_GUARDED_BY(mutex_);
  double share_ ABSL_GUARDED_BY(mutex_) = 0;
};

// This machine's own name or an address, with this port or none. Host may be missing in HTTP/1.0.
bool IsOwnHost(std::string_view host, int port) {
  const size_t colon = host.rfind(':');
  const bool has_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
  if (has_port && host.substr(colon + 1) != std::to_string(port)) return false;
  std::string name(host.substr(0, has_port ? colon : host.size()));
  if (name.size() > 2 && name.front() == '[' && name.back() == ']') name = name.substr(1, name.size() - 2);
  beast::error_code error;
  asio::ip::make_address(name, error);
  return !error || beast::iequals(name, "localhost");
}

http::response<http::string_body> Answer(const http::request_parser<http::string_body>::value_type& request,
                                         const Pages& pages, int port) {
  http::response<http::string_body> response;
  response.version(request.version());
  response.keep_alive(false);
  response.set(http::field::content_type, "text/html; charset=utf-8");
  response.set(http::field::cache_control, "no-store");
  response.set(
      "Content-Security-Policy",
      "default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'self'; connect-src 'self'");
  const auto host = request.find(http::field::host);
  const bool named = host != request.end();
  if (named ? !IsOwnHost({host->value().data(), host->value().size()}, port) : request.version() > 10) {
    response.result(named ? http::status::forbidden : http::status::bad_request);
    response.set(http::field::content_type, "text/plain; charset=utf-8");
    response.body() =
        absl::StrCat("the screen answers to localhost:", port, " and to addresses, not to this host\n");
  } else if (request.method() != http::verb::get && request.method() != http::verb::head) {
    response.result(http::status::method_not_allowed);
    response.set(http::field::allow, "GET, HEAD");
  } else if (request.target() == "/-/now") {
    response.set(http::field::content_type, "application/json");
    response.body() = pages.Now();
  } else if (request.target() == "/-/screen.js") {
    response.set(http::field::content_type, "text/javascript; charset=utf-8");
    response.body() = kScript;
  } else if (!pages.Get(std::string(request.target()), &response.body())) {
    response.result(http::status::not_found);
    response.body() = "<!DOCTYPE html><title>Not found</title><p>The screen has no such page.";
  }
  response.prepare_payload();
  if (request.method() == http::verb::head) response.body().clear();
  return response;
}

// One connection: one request, one answer.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, const Pages& pages, int port)
      : stream_(std::move(socket)), pages_(pages), port_(port) {}

  void Run() {
    stream_.expires_after(kConnectionTimeout);
    parser_.body_limit(kRequestBodyBytes);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](beast::error_code error, size_t) {
      if (!error) self->Write();
    });
  }

  void Close() { stream_.close(); }

 private:
  void Write() {
    response_ = Answer(parser_.get(), pages_, port_);
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code, size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  const Pages& pages_;
  const int port_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

class ScreenServer::Impl {
 public:
  ~Impl() {
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Listen(int port) {
    beast::error_code error;
    const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), static_cast<uint16_t>(port));
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(kWaitingLimit, error);
    if (error) {
      return absl::UnavailableError(
          absl::StrCat("cannot show the screen at 127.0.0.1:", port, ": ", error.message()));
    }
    port_ = acceptor_.local_endpoint().port();
    Accept();
    thread_ = std::thread([this] { io_.run(); });
    return absl::OkStatus();
  }

  Pages pages_;
  int port_ = 0;

 private:
  void Accept() {
    acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) return AcceptLater();
      std::erase_if(connections_, [](const auto& one) { return one.expired(); });
      if (connections_.size() >= kConnectionLimit) {
        if (const auto oldest = connections_.front().lock()) oldest->Close();
        connections_.pop_front();
      }
      const auto connection = std::make_shared<Connection>(std::move(socket), pages_, port_);
      connections_.push_back(connection);
      connection->Run();
      Accept();
    });
  }

  // Out of descriptors, or the client went at once.
  void AcceptLater() {
    pause_.expires_after(kPause);
    pause_.async_wait([this](beast::error_code error) {
      if (!error) Accept();
    });
  }

  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_};
  std::list<std::weak_ptr<Connection>> connections_;  // the oldest first
  std::thread thread_;
};

ScreenServer::ScreenServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ScreenServer::~ScreenServer() = default;

absl::StatusOr<std::unique_ptr<ScreenServer>> ScreenServer::Start(int port) {
  auto impl = std::make_unique<Impl>();
  if (absl::Status status = impl->Listen(port); !status.ok()) return status;
  return std::unique_ptr<ScreenServer>(new ScreenServer(std::move(impl)));
}

std::string ScreenServer::Show(const std::string& name, std::string html) {
  impl_->pages_.Put(name, std::move(html));
  return address() + name;
}

void ScreenServer::Say(const std::string& text, const std::string& language, double share) {
  impl_->pages_.Say(text, language, share);
}

int ScreenServer::port() const {
  return impl_->port_;
}

std::string ScreenServer::address() const {
  return absl::StrCat("http://127.0.0.1:", impl_->port_, "/");
}

}  // namespace docent::robot
