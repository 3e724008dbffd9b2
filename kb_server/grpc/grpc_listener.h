// Listener of the gRPC port: accepts connections and hands them to the gRPC server.
//
// gRPC 1.51's own listener takes as many connections as there are file descriptors, and never accepts again after one
// accept has failed. This one takes so many, closes the ones that are idle the longest where another comes, and goes on
// after every error. One thread of its own accepts; the other methods may be called from any thread.
#ifndef DOCENT_KB_SERVER_GRPC_GRPC_LISTENER_H_
#define DOCENT_KB_SERVER_GRPC_GRPC_LISTENER_H_

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace docent::server {

class GrpcListener {
 public:
  // Binds and listens; nothing is accepted before Start. `address`: "host:port", "[v6]:port"; port 0 takes a free one.
  // INVALID_ARGUMENT, FAILED_PRECONDITION (in use, not allowed): one line each. At most `connections` at one time.
  static absl::StatusOr<std::unique_ptr<GrpcListener>> Listen(const std::string& address, size_t connections);
  ~GrpcListener();
  GrpcListener(const GrpcListener&) = delete;
  GrpcListener& operator=(const GrpcListener&) = delete;

  // Makes the server that `builder` builds take its connections from here.
  void AddTo(grpc::ServerBuilder* builder);
  // When that server is built.
  void Start();
  // Accepts nothing more. Before the server shuts down.
  void Stop();

  uint16_t port() const { return port_; }
  // OK, or why it accepts nothing at the moment.
  absl::Status status() const;

  // For metrics.
  size_t open();
  uint64_t accepted() const { return accepted_; }
  uint64_t closed_idle() const { return closed_idle_; }
  uint64_t refused() const { return refused_; }

 private:
  // A socket that gRPC owns. gRPC tells nobody when it closes one: then the descriptor is another file's, or none's.
  struct Connection {
    int fd;
    uint64_t inode;
    int peer_port;
  };

  explicit GrpcListener(size_t connections) : limit_(connections) {}
  absl::Status Bind(const std::string& address);
  void Loop();
  // Until nobody waits, or there is an error.
  void AcceptAll(int listening);
  void Take(int fd);
  // Descriptors of connections that were told to close come back in a moment.
  void AwaitClosing();
  bool HasRoom() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ForgetClosed() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Of connections without a call, those that have sent nothing for the longest time.
  void CloseIdle(size_t count) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  // At once, since to look for idle ones takes a while.
  size_t some() const { return limit_ / 16 + 1; }

  const size_t limit_;
  uint16_t port_ = 0;
  std::vector<int> listening_;
  int stop_ = -1;  // an eventfd
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
  std::thread thread_;
  std::atomic<uint64_t> accepted_{0};
  std::atomic<uint64_t> closed_idle_{0};
  std::atomic<uint64_t> refused_{0};

  mutable absl::Mutex mutex_;
  std::vector<Connection> connections_ ABSL_GUARDED_BY(mutex_);
  std::vector<Connection> closing_ ABSL_GUARDED_BY(mutex_);              // gRPC has not closed them yet
  absl::Time next_scan_ ABSL_GUARDED_BY(mutex_) = absl::InfinitePast();  // for idle ones
  absl::Status status_ ABSL_GUARDED_BY(mutex_);
};

// Ports from which a peer has a call under way now at a gRPC server of this process.
absl::flat_hash_set<int> PeerPortsWithCalls();

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_GRPC_LISTENER_H_
