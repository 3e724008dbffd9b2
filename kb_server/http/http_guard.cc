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
constexpr char kPreflightSeconds[] = "7200";  // the longest that Chromium keeps an answer
// Those that a page may read of every answer stand in the Fetch standard; these are ours, and Connect's.
constexpr char kExposedHeaders[] =
    "Docent-Revision, Location, ETag, Retry-After, Allow, Accept-Post, Content-Encoding, "
    "Connect-Content-Encoding";

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

bool IsAskedByAnotherSite(const HttpRequest& request) {
  const std::string site = request.Header("sec-fetch-site");
  return (site == "cross-site" || site == "same-site") && request.Header("origin").empty();
}

std::optional<HttpResponse> RefuseAnotherSite(const HttpRequest& request) {
  if (!IsAskedByAnotherSite(request)) return std::nullopt;
  return TextResponse(
      403,
      "a page of another site asks for this, by a link or as a part of itself; open the address "
      "yourself, or start the server with --http-origin and that page's origin and let the page "
      "fetch it");
}

HttpGuard::HttpGuard(uint16_t port, std::vector<std::string> allowed_hosts,
                     std::vector<std::string> allowed_origins)
    : port_(port), allowed_hosts_(std::move(allowed_hosts)), allowed_origins_(std::move(allowed_origins)) {}

absl::Status HttpGuard::CheckOrigin(std::string_view origin) {
  std::string_view host = origin;
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (host.size() == origin.size() && origin.starts_with(scheme)) host.remove_prefix(scheme.size());
  }
  if (host.size() != origin.size() && host.find_first_of("/?#@* ,") == std::string_view::npos &&
      SplitHostAndPort(host))
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("\"", ToAbsl(origin),
                   "\" is no origin of a web page: give scheme, host and port without a path, "
                   "such as http://localhost:5173"));
}

absl::Status HttpGuard::CheckName(std::string_view name) {
  const std::optional<HostAndPort> parts = SplitHostAndPort(name);
  if (parts && !parts->host.empty() && name.find_first_of("/?#@* ,\\\"<>") == std::string_view::npos)
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("\"", ToAbsl(name),
                   "\" is not NAME or NAME:PORT; give what a browser's address has between "
                   "http:// and the path, such as robots.example.org"));
}

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
  if (!origin.empty() && !IsAllowedOrigin(origin, host) && SharedWith(request).empty()) {
    return TextResponse(403,
                        absl::StrCat("requests from web pages of ", origin,
                                     " are refused: only pages under a name of this server may send "
                                     "them. Let one proxy serve both, and start "
                                     "the server with --http-name and the proxy's name; or start it with "
                                     "--http-origin and that origin"));
  }
  return std::nullopt;
}

HttpFields HttpGuard::SharedWith(const HttpRequest& request) const {
  const std::string origin = request.Header("origin");
  if (origin.empty() ||
      std::find(allowed_origins_.begin(), allowed_origins_.end(), origin) == allowed_origins_.end())
    return {};
  return {{"Access-Control-Allow-Origin", origin},
          {"Access-Control-Expose-Headers", kExposedHeaders},
          {"Vary", "Origin"}};
}

std::optional<HttpResponse> HttpGuard::Preflight(const HttpRequest& request) const {
  if (request.method != "OPTIONS" || request.Header("access-control-request-method").empty() ||
      SharedWith(request).empty())
    return std::nullopt;
  HttpResponse response;
  response.content_type.clear();
  response.headers = {{"Access-Control-Allow-Methods", "GET, HEAD, POST, PUT, PATCH, DELETE"},
                      {"Access-Control-Max-Age", kPreflightSeconds}};
  const std::string headers = request.Header("access-control-request-headers");
  if (!headers.empty()) response.headers.emplace_back("Access-Control-Allow-Headers", headers);
  return response;
}

}  // namespace docent::server
