// Gate of the gRPC server: a call's message is let in when there is room for it, and has to arrive in time; what it takes
// then counts until the call ends.
//
// gRPC 1.51 itself reads the message of a call before anybody hears of the call, keeps as much as the client says that it has,
// and looks at its size when all of it is there. So the gate stands in the place of the services: it takes calls by their
// heads, and reads each message itself. While a message is not read, gRPC holds at most the window of its stream (64 KiB).
// Messages of streams of a client are read by their handlers; of these gRPC's own quota bounds what arrives.
// Thread-safe.
#ifndef DOCENT_KB_SERVER_GRPC_MESSAGE_GATE_H_
#define DOCENT_KB_SERVER_GRPC_MESSAGE_GATE_H_

#include <google/protobuf/descriptor.h>
#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/base/network_limits.h"

namespace docent::server {

class GatedCall;

// What is known of a method whose calls pass the gate.
struct GatedMethod {
  std::string path;  // "/docent.v1.Fleet/List"
  const google::protobuf::MethodDescriptor* descriptor;
  grpc::internal::MethodHandler* handler;  // of its service
  size_t largest_bytes;
  std::string_view limit;
};

class MessageGate {
 public:
  explicit MessageGate(const Limits& limits, const NetworkLimits& network = kNetworkLimits);
  // When the server has shut down, and all calls have ended.
  ~MessageGate();
  MessageGate(const MessageGate&) = delete;
  MessageGate& operator=(const MessageGate&) = delete;

  // A service to register in the place of `service`, which must outlive the server. The gate owns it.
  grpc::Service* Guard(grpc::Service* service, const google::protobuf::ServiceDescriptor& descriptor);
  // Lets nothing more in: what waits for room is refused. When the server begins to shut down.
  void Stop();
  // True of "/docent.v1.Fleet/List" and all other methods that take one message.
  bool TakesOne(const std::string& path) const { return paths_.contains(path); }

  // Since the start, and now; for metrics.
  size_t bytes() const { return budget_.taken(); }
  size_t arriving() const;
  size_t waiting() const;
  uint64_t late() const { return late_; }        // messages that did not arrive in time
  uint64_t refused() const { return refused_; }  // for want of room

 private:
  friend class GatedCall;
  // `call` waits for its message; its Read is called, now or later, or its Refuse.
  void Enter(GatedCall* call);
  // Its message has arrived, or will not. OK: what it takes, `bytes`, is counted until Release.
  absl::Status Leave(GatedCall* call, size_t bytes);
  void Release(size_t bytes);
  bool Admit(GatedCall* call) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Reads the messages for which there is room now.
  void LetIn();
  // Ends calls whose time is over.
  void Watch();

  const Limits limits_;
  const NetworkLimits network_;
  MemoryBudget budget_;
  std::vector<std::unique_ptr<grpc::Service>> guards_;
  absl::flat_hash_set<std::string> paths_;
  std::atomic<uint64_t> late_{0};
  std::atomic<uint64_t> refused_{0};

  mutable absl::Mutex mutex_;
  std::list<GatedCall*> arriving_ ABSL_GUARDED_BY(mutex_);  // in the order of their beginnings
  std::list<GatedCall*> waiting_ ABSL_GUARDED_BY(mutex_);   // likewise
  absl::flat_hash_map<std::string, size_t> of_peers_
      ABSL_GUARDED_BY(mutex_);  // bytes that may arrive on a connection
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_MESSAGE_GATE_H_
