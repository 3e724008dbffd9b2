#include "kb_server/door/descriptors.h"

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

constexpr size_t kKept = 12;  // and one in kKeptPart of all: for what is not a connection of a door
constexpr size_t kKeptPart = 16;
constexpr size_t kMost = size_t{1} << 20;  // no limit is as good as this one

}  // namespace

absl::Status RaiseDescriptorLimit() {
  rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return absl::OkStatus();
  limit.rlim_cur = limit.rlim_max;
  if (limit.rlim_cur == RLIM_INFINITY) limit.rlim_cur = kMost;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur >= kLeastDescriptors) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "this process may have ", limit.rlim_cur, " files open, and a server needs ", kLeastDescriptors,
      " at least; raise the limit, as with `ulimit -n 1024` or LimitNOFILE= of its service"));
}

size_t DescriptorLimit() {
  rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return kMost;
  return std::min<size_t>(limit.rlim_cur, kMost);
}

size_t OpenDescriptors() {
  std::error_code error;
  const std::filesystem::directory_iterator all("/proc/self/fd", error);
  return error ? 0 : static_cast<size_t>(std::distance(begin(all), end(all)));
}

ConnectionShares ShareDescriptors(size_t limit, size_t open, const Limits& limits) {
  const size_t kept = open + kKept + limit / kKeptPart;
  const size_t free = limit > kept + 2 ? limit - kept : 2;
  ConnectionShares shares;
  shares.http = std::min(limits.http_connections, free / 2);
  shares.grpc = std::min(limits.grpc_connections, free - shares.http);
  return shares;
}

}  // namespace docent::server
