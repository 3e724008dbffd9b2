#include "kb_server/grpc/grpc_listener.h"

#include <fcntl.h>
#include <grpc/grpc.h>
#include <grpc/support/alloc.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "kb_server/door/port_in_use.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

constexpr absl::Duration kPause = absl::Milliseconds(50);  // after an error
constexpr absl::Duration kClosing =
    absl::Seconds(1);  // is waited for gRPC to close what it was told to close
constexpr absl::Duration kScanPause = absl::Milliseconds(200);
constexpr int kUnansweredMs =
    20000;  // what was sent to a peer and is not taken by its system: the connection ends

// The socket that lies under a descriptor; nullopt: none.
std::optional<uint64_t> InodeOf(int fd) {
  struct stat found;
  if (fstat(fd, &found) != 0 || !S_ISSOCK(found.st_mode)) return std::nullopt;
  return found.st_ino;
}

int PortOf(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
  if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
  return 0;
}

void SetPort(addrinfo* address, uint16_t port) {
  if (address->ai_family == AF_INET) {
    reinterpret_cast<sockaddr_in*>(address->ai_addr)->sin_port = htons(port);
  } else if (address->ai_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(address->ai_addr)->sin6_port = htons(port);
  }
}

// A socket that listens on `address`; what was accepted has its options. -1, and errno: there is none.
int ListenOn(const addrinfo& address) {
  const int fd = socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &kUnansweredMs, sizeof(kUnansweredMs));
  if (bind(fd, address.ai_addr, address.ai_addrlen) == 0 && listen(fd, SOMAXCONN) == 0) return fd;
  const int error = errno;
  close(fd);
  errno = error;
  return -1;
}

// The number after `key` in the text of gRPC's channelz, `"key":"12"` or `"key":12`; 0 where there is none.
int64_t NumberOf(std::string_view json, std::string_view key) {
  size_t at = json.find(key);
  if (at == std::string_view::npos) return 0;
  at += key.size();
  const size_t begin = json.find_first_of("0123456789", at);
  if (begin == std::string_view::npos) return 0;
  const size_t end = std::min(json.find_first_not_of("0123456789", begin), json.size());
  int64_t number = 0;
  (void)absl::SimpleAtoi(absl::string_view(json.data() + begin, end - begin), &number);
  return number;
}

// Calls `use` with the text of each object that a page of channelz lists by `id_key`; pages follow each other.
template <typename Page, typename Use>
void ForEachId(std::string_view id_key, const Page& page, const Use& use) {
  for (int64_t start = 0;;) {
    char* const text = page(start);
    if (text == nullptr) return;
    const std::string json(text);
    gpr_free(text);
    for (size_t at = json.find(id_key); at != std::string::npos; at = json.find(id_key, at + 1)) {
      const int64_t id = NumberOf(std::string_view(json).substr(at), id_key);
      use(id);
      start = std::max(start, id + 1);
    }
    if (json.find(id_key) == std::string::npos || json.find("\"end\":true") != std::string::npos) return;
  }
}

}  // namespace

// gRPC counts the streams of each connection for its channelz, which is on unless a program says otherwise.
absl::flat_hash_set<int> PeerPortsWithCalls() {
  absl::flat_hash_set<int> ports;
  const auto look_at_socket = [&ports](int64_t id) {
    char* const text = grpc_channelz_get_socket(id);
    if (text == nullptr) return;
    const std::string json(text);
    gpr_free(text);
    const int64_t open = NumberOf(json, "\"streamsStarted\"") - NumberOf(json, "\"streamsSucceeded\"") -
                         NumberOf(json, "\"streamsFailed\"");
    const size_t remote = json.find("\"remote\"");
    if (open <= 0 || remote == std::string::npos) return;
    ports.insert(static_cast<int>(NumberOf(std::string_view(json).substr(remote), "\"port\"")));
  };
  ForEachId(
      "\"serverId\"", [](int64_t start) { return grpc_channelz_get_servers(start); },
      [&](int64_t server) {
        ForEachId(
            "\"socketId\"",
            [server](int64_t start) { return grpc_channelz_get_server_sockets(server, start, 0); },
            look_at_socket);
      });
  return ports;
}

absl::StatusOr<std::unique_ptr<GrpcListener>> GrpcListener::Listen(const std::string& address,
                                                                   size_t connections) {
  std::unique_ptr<GrpcListener> listener(new GrpcListener(connections));
  if (absl::Status status = listener->Bind(address); !status.ok()) return status;
  return listener;
}

absl::Status GrpcListener::Bind(const std::string& address) {
  const std::string what = absl::StrCat("cannot listen on ", address, " for gRPC: ");
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos)
    return absl::InvalidArgumentError(absl::StrCat(what, "it is not HOST:PORT"));
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), address.substr(colon + 1).c_str(), &hints, &found);
  if (code != 0) return absl::InvalidArgumentError(absl::StrCat(what, gai_strerror(code)));
  int error = EADDRNOTAVAIL;
  for (addrinfo* one = found; one != nullptr; one = one->ai_next) {
    if (port_ != 0) SetPort(one, port_);  // all addresses of a name have the same one
    const int fd = ListenOn(*one);
    if (fd < 0) {
      error = errno;
      if (error == EADDRINUSE || error == EACCES) break;
      continue;  // such as IPv6 where there is none
    }
    error = 0;
    listening_.push_back(fd);
    sockaddr_storage bound{};
    socklen_t size = sizeof(bound);
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &size) == 0) {
      port_ = static_cast<uint16_t>(PortOf(bound));
    }
  }
  freeaddrinfo(found);
  if (error == EADDRINUSE || error == EACCES || listening_.empty()) {
    return absl::UnavailableError(absl::StrCat(what, strerror(error), error == EADDRINUSE ? kPortInUse : ""));
  }
  stop_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  return stop_ >= 0 ? absl::OkStatus() : absl::UnavailableError(absl::StrCat(what, strerror(errno)));
}

GrpcListener::~GrpcListener() {
  Stop();
  for (const int fd : listening_) close(fd);
  if (stop_ >= 0) close(stop_);
}

void GrpcListener::AddTo(grpc::ServerBuilder* builder) {
  using Type = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  acceptor_ =
      builder->experimental().AddExternalConnectionAcceptor(Type::FROM_FD, grpc::InsecureServerCredentials());
}

void GrpcListener::Start() {
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "grpc-listener");
    Loop();
  });
}

void GrpcListener::Stop() {
  if (!thread_.joinable()) return;
  eventfd_write(stop_, 1);
  thread_.join();
}

absl::Status GrpcListener::status() const {
  absl::MutexLock lock(&mutex_);
  return status_;
}

size_t GrpcListener::open() {
  absl::MutexLock lock(&mutex_);
  ForgetClosed();
  return connections_.size() + closing_.size();
}

void GrpcListener::Loop() {
  std::vector<pollfd> waited;
  for (const int fd : listening_) waited.push_back({fd, POLLIN, 0});
  waited.push_back({stop_, POLLIN, 0});
  while (true) {
    if (poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) absl::SleepFor(kPause);
    if (waited.back().revents != 0) return;
    for (size_t i = 0; i + 1 < waited.size(); ++i) {
      if (waited[i].revents != 0) AcceptAll(waited[i].fd);
    }
  }
}

void GrpcListener::AcceptAll(int listening) {
  while (true) {
    const int fd = accept4(listening, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd >= 0) {
      Take(fd);
      continue;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) return;
    if (errno == EINTR || errno == ECONNABORTED) continue;
    // Out of descriptors or memory, whoever has them: it is tried again in a moment.
    const std::string reason = absl::StrCat("the gRPC port accepts nothing at the moment: ", strerror(errno));
    {
      absl::MutexLock lock(&mutex_);
      if (status_.ok()) spdlog::error(reason);
      status_ = absl::UnavailableError(reason);
    }
    absl::SleepFor(kPause);
    return;
  }
}

void GrpcListener::AwaitClosing() {
  for (absl::Time end = absl::Now() + kClosing; absl::Now() < end; absl::SleepFor(absl::Milliseconds(1))) {
    absl::MutexLock lock(&mutex_);
    if (closing_.size() < some()) return;
    ForgetClosed();
    if (closing_.size() < some()) return;
  }
}

void GrpcListener::Take(int fd) {
  ++accepted_;
  AwaitClosing();
  sockaddr_storage peer{};
  socklen_t size = sizeof(peer);
  const bool known = getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &size) == 0;
  const std::optional<uint64_t> inode = InodeOf(fd);
  {
    absl::MutexLock lock(&mutex_);
    status_ = absl::OkStatus();
    if (!known || !inode || !HasRoom()) {
      if (known) ++refused_;
      close(fd);
      return;
    }
    connections_.push_back({fd, *inode, PortOf(peer)});
  }
  grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters parameters;
  parameters.fd = fd;
  acceptor_->HandleNewConnection(&parameters);
}

bool GrpcListener::HasRoom() {
  if (connections_.size() < limit_) return true;
  ForgetClosed();
  if (connections_.size() < limit_) return true;
  if (closing_.size() < some()) CloseIdle(some());
  return connections_.size() < limit_;
}

void GrpcListener::ForgetClosed() {
  const auto gone = [](const Connection& one) { return InodeOf(one.fd) != one.inode; };
  std::erase_if(connections_, gone);
  std::erase_if(closing_, gone);
}

void GrpcListener::CloseIdle(size_t count) {
  const absl::Time now = absl::Now();
  if (now < next_scan_) return;
  const absl::flat_hash_set<int> busy = PeerPortsWithCalls();
  std::vector<std::pair<uint32_t, size_t>> idle;  // milliseconds, place
  for (size_t i = 0; i < connections_.size(); ++i) {
    if (busy.contains(connections_[i].peer_port)) continue;
    tcp_info info{};
    socklen_t size = sizeof(info);
    if (getsockopt(connections_[i].fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) continue;
    idle.emplace_back(info.tcpi_last_data_recv, i);
  }
  std::stable_sort(idle.begin(), idle.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (idle.size() > count) idle.resize(count);
  if (idle.empty()) next_scan_ = now + kScanPause;
  std::vector<bool> closed(connections_.size());
  for (const auto& [ms, place] : idle) {
    // The descriptor may be another file's at any time; a copy of it is one thing.
    const int copy = fcntl(connections_[place].fd, F_DUPFD_CLOEXEC, 0);
    const bool same = copy >= 0 && InodeOf(copy) == connections_[place].inode;
    if (same) shutdown(copy, SHUT_RDWR);
    if (copy >= 0) close(copy);
    if (!same) continue;
    closed[place] = true;
    closing_.push_back(connections_[place]);
    ++closed_idle_;
  }
  size_t place = 0;
  std::erase_if(connections_, [&](const Connection&) { return closed[place++]; });
}

}  // namespace docent::server
