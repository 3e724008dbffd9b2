// One who asks: an HTTP or gRPC connection, or a tab of /live. What is done for it counts here, so that who has more at work
// goes behind (WorkerPool), and so that it holds a share of the memory and not all of it. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_CLIENT_H_
#define DOCENT_KB_SERVER_DOOR_CLIENT_H_

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/synchronization/mutex.h"

namespace docent::server {

class Client {
 public:
  explicit Client(std::string name) : name_(std::move(name)) {}
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  // Unique among those that are there: "ipv4:127.0.0.1:50123", "http:17".
  const std::string& name() const { return name_; }

 private:
  const std::string name_;
};
// Null: the server itself.
using ClientPtr = std::shared_ptr<Client>;

// Metadata of a call within this process: the name of the client that it is made for.
inline constexpr char kClientKey[] = "docent-client";

// Those that are there, by name.
class Clients {
 public:
  // The client of that name, which is made where it is not there.
  ClientPtr Of(std::string_view name);
  // A client with a name that no other has; `kind` is its beginning.
  ClientPtr Make(std::string_view kind);
  // Those that somebody holds; for metrics.
  size_t size();

 private:
  ClientPtr Add(std::string name) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::Mutex mutex_;
  absl::flat_hash_map<std::string, std::weak_ptr<Client>> clients_ ABSL_GUARDED_BY(mutex_);
  size_t drop_gone_at_ ABSL_GUARDED_BY(mutex_) = 64;
  uint64_t last_number_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_CLIENT_H_
