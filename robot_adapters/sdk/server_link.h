// The client side of the docent server, as an adapter or sensor program needs it: blocking calls with
// deadlines that another thread can end all at once. Thread-safe.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_SERVER_LINK_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_SERVER_LINK_H_

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/fleet.grpc.pb.h"
#include "graph/rdf/term.h"

namespace docent::robot {

// The answer of a SELECT; of an ASK, `boolean`.
struct QueryAnswer {
  std::vector<std::string> variables;                  // without "?"
  std::vector<std::vector<std::optional<Term>>> rows;  // one value a variable; nullopt: unbound
  bool boolean = false;
  uint64_t revision = 0;
};

class ServerLink {
 public:
  // Does not connect yet; `address` is HOST:PORT.
  explicit ServerLink(const std::string& address);

  // Each returns what the server or gRPC says: UNAVAILABLE while there is no server, DEADLINE_EXCEEDED after
  // `timeout`, CANCELLED after Shutdown.
  absl::Status Assert(const v1::AssertRequest& request, v1::AssertReply* reply, absl::Duration timeout);
  absl::Status Join(const v1::JoinRequest& request, v1::JoinReply* reply, absl::Duration timeout);
  absl::Status Leave(const v1::LeaveRequest& request, v1::LeaveReply* reply, absl::Duration timeout);
  // A SELECT or ASK. `min_revision`: wait until the graph is at least that new.
  absl::StatusOr<QueryAnswer> Query(const std::string& sparql, absl::Duration timeout,
                                    uint64_t min_revision = 0);

  // Ends every call, now and later, with CANCELLED.
  void Shutdown();

 private:
  class Call;

  std::unique_ptr<v1::Context::Stub> context_;
  std::unique_ptr<v1::Fleet::Stub> fleet_;
  absl::Mutex mutex_;
  bool shut_down_ ABSL_GUARDED_BY(mutex_) = false;
  std::set<grpc::ClientContext*> calls_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_SERVER_LINK_H_
