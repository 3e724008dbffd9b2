#include "kb_server/imports/import_target.h"

#include <arpa/inet.h>

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

struct Target {
  std::string host;  // without brackets
  bool v6 = false;
};

std::optional<Target> Parse(const std::string& text) {
  constexpr size_t kMostBytes = 300;
  const size_t colon = text.rfind(':');
  int port = 0;
  if (text.size() > kMostBytes || colon == std::string::npos || colon == 0) return std::nullopt;
  const std::string digits = text.substr(colon + 1);
  if (digits.empty() || !std::all_of(digits.begin(), digits.end(), absl::ascii_isdigit)) return std::nullopt;
  if (!absl::SimpleAtoi(digits, &port) || port < 1 || port > 65535) return std::nullopt;
  Target target{absl::AsciiStrToLower(text.substr(0, colon)), false};
  if (target.host.front() == '[' && target.host.back() == ']') {
    target.host = target.host.substr(1, target.host.size() - 2);
    in6_addr address;
    target.v6 = true;
    return inet_pton(AF_INET6, target.host.c_str(), &address) == 1 ? std::optional(target) : std::nullopt;
  }
  const bool plain = std::all_of(target.host.begin(), target.host.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_';
  });
  return plain ? std::optional(target) : std::nullopt;
}

bool IsLoopback(const Target& target) {
  if (target.v6) {
    in6_addr address;
    return inet_pton(AF_INET6, target.host.c_str(), &address) == 1 && IN6_IS_ADDR_LOOPBACK(&address);
  }
  in_addr address;
  if (inet_pton(AF_INET, target.host.c_str(), &address) == 1) return (ntohl(address.s_addr) >> 24) == 127;
  return target.host == "localhost";
}

}  // namespace

absl::Status CheckTarget(const std::string& target) {
  if (Parse(target)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("\"", target.substr(0, 100), "\" is not HOST:PORT, e.g. 127.0.0.1:50051"));
}

absl::Status CheckMayReach(const std::string& target, const RemoteAccess* remote) {
  if (absl::Status status = CheckTarget(target); !status.ok()) return status;
  const std::string url = absl::StrCat("http://", target, "/");
  if (IsLoopback(*Parse(target)) || (remote != nullptr && remote->IsAllowed(url))) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrCat(target,
                                                  " is neither on this machine nor among the addresses that "
                                                  "this server may reach; start it with --allow http://",
                                                  target));
}

}  // namespace docent::server
