// Host and Origin checks: the defence against web pages of other sites that make a visitor's browser
// talk to a server on its own machine (cross-site requests, DNS rebinding). Immutable; any thread.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_GUARD_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_GUARD_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

// True where a browser says that the page of another site asks (Sec-Fetch-Site), without an Origin that HttpGuard could look
// at: a link, a picture or a frame there may name any address here. What does work for its asker refuses it.
bool IsAskedByAnotherSite(const HttpRequest& request);
// The refusal of such a request, 403; nullopt: it is none.
std::optional<HttpResponse> RefuseAnotherSite(const HttpRequest& request);

class HttpGuard {
 public:
  // `port`: the one the server listens on. `allowed_hosts`: "name" (any port) or "name:port", beside the
  // loopback names with `port` or without one, which are always allowed. `allowed_origins`: of pages of other servers that
  // may send requests and read the answers (CORS), "https://app.example.org".
  HttpGuard(uint16_t port, std::vector<std::string> allowed_hosts,
            std::vector<std::string> allowed_origins = {});

  // INVALID_ARGUMENT for what no browser sends as Origin: anything but scheme, host and port.
  static absl::Status CheckOrigin(std::string_view origin);
  // INVALID_ARGUMENT for what is neither NAME nor NAME:PORT, and would never be a request's Host.
  static absl::Status CheckName(std::string_view name);

  // nullopt: go on. Otherwise the refusal: 400 for a request without Host, 403 for a Host or Origin that is not
  // allowed.
  std::optional<HttpResponse> Refuse(const HttpRequest& request) const;
  // The answer to a browser that asks whether a page of another server may send a request (CORS preflight); nullopt: it is
  // another request. Of requests that are not refused.
  std::optional<HttpResponse> Preflight(const HttpRequest& request) const;
  // What lets the page of another server read the answer; nothing for requests of others.
  HttpFields SharedWith(const HttpRequest& request) const;
  // The host of requests that need not name one.
  std::string OwnName() const;

 private:
  // "localhost:7480", "[::1]:7480", "127.0.0.1:7480", or a configured one. `default_port`: where `asked` has none.
  bool IsOwnName(const HostAndPort& asked, uint16_t default_port) const;
  // One of its own names, or an address: who rebinds a name cannot send that.
  bool IsAllowedHost(std::string_view host) const;
  // The page of a server of one of these names, or of what the request itself calls this server; "null" is not.
  bool IsAllowedOrigin(std::string_view origin, std::string_view host) const;

  const uint16_t port_;
  const std::vector<std::string> allowed_hosts_;
  const std::vector<std::string> allowed_origins_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_GUARD_H_
