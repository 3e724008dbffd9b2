#include "kb_server/http/http_guard.h"

#include <arpa/inet.h>

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

constexpr uint16_t kHttpPort = 80, kHttpsPort = 443;

bool IsLoopback(const std::string& host) {
  if (host == "localhost") return true;
  in_addr v4;
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6;
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

bool IsAddress(const std::string& host) {
  in6_addr any;
  return inet_pton(AF_INET, host.c_str(), &any) == 1 || inet_pton(AF_INET6, host.c_str(), &any) == 1;
}

}  // namespace

HttpGuard::HttpGuard(uint16_t port, std::vector<std::string> allowed_hosts)
    : port_(port), allowed_hosts_(std::move(allowed_hosts)) {}

bool HttpGuard::IsOwnName(const HostAndPort& asked, uint16_t default_port) const {
  const uint16_t port = asked.port.value_or(default_port);
  if (IsLoopback(asked.host) && port == port_) return true;
  return std::any_of(allowed_hosts_.begin(), allowed_hosts_.end(), [&](const std::string& allowed) {
    const std::optional<HostAndPort> entry = SplitHostAndPort(allowed);
    return entry && entry->host == asked.host && (!entry->port || *entry->port == port);
  });
}

// Without a port is what some clients and proxies send whatever the port is; RFC 9110 section 7.2 has it mean port 80, but
// the connection came here, and a name of this machine cannot be made to point elsewhere.
bool HttpGuard::IsAllowedHost(std::string_view host) const {
  const std::optional<HostAndPort> asked = SplitHostAndPort(host);
  if (!asked) return false;
  return IsOwnName(*asked, port_) || IsOwnName(*asked, kHttpPort) ||
         (IsAddress(asked->host) && asked->port.value_or(port_) == port_);
}

bool HttpGuard::IsAllowedOrigin(std::string_view origin, std::string_view host) const {
  const bool secure = origin.starts_with("https://");
  if (!secure && !origin.starts_with("http://")) return false;
  origin.remove_prefix(secure ? 8 : 7);
  if (!secure && absl::EqualsIgnoreCase(ToAbsl(origin), ToAbsl(host))) return true;
  const std::optional<HostAndPort> asked = SplitHostAndPort(origin);
  return asked && IsOwnName(*asked, secure ? kHttpsPort : kHttpPort);
}

std::string HttpGuard::OwnName() const {
  return absl::StrCat("localhost:", port_);
}

std::optional<HttpResponse> HttpGuard::Refuse(const HttpRequest& request) const {
  const std::string host = request.Header("host");
  if (host.empty()) return TextResponse(400, "the request has no Host");
  if (!IsAllowedHost(host)) {
    return TextResponse(
        403, absl::StrCat("this server does not answer to the host name ", host, ". Use localhost:", port_,
                          " or its address, or start it with --http-name and that name"));
  }
  const std::string origin = request.Header("origin");
  if (!origin.empty() && !IsAllowedOrigin(origin, host)) {
    return TextResponse(403, absl::StrCat("requests from web pages of ", origin,
                                          " are refused: only pages under a name of this server may send "
                                          "them. Let one proxy serve both, and start "
                                          "the server with --http-name and the proxy's name"));
  }
  return std::nullopt;
}

}  // namespace docent::server
