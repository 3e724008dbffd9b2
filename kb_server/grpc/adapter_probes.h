// Questions to robot adapters whether they are there. Nothing waits for the answers: an adapter that says nothing holds neither a
// thread nor a place, and however many ask about it, it is asked once at a time. Thread-safe.
#ifndef DOCENT_KB_SERVER_GRPC_ADAPTER_PROBES_H_
#define DOCENT_KB_SERVER_GRPC_ADAPTER_PROBES_H_

#include <functional>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/synchronization/mutex.h"

namespace docent::server {

class AdapterProbes {
 public:
  AdapterProbes();
  // Ends the questions that are open, and waits until they have ended.
  ~AdapterProbes();
  AdapterProbes(const AdapterProbes&) = delete;
  AdapterProbes& operator=(const AdapterProbes&) = delete;

  // Calls `then` once, on a thread of gRPC's, within about a second. `gone`: surely nothing listens at the address any more; what
  // does not answer in time may be there.
  using Then = std::function<void(bool gone)>;
  void Ask(const std::string& address, Then then);

 private:
  struct Probe;
  void End(const std::string& address, bool gone);

  absl::Mutex mutex_;
  absl::flat_hash_map<std::string, std::unique_ptr<Probe>> probes_ ABSL_GUARDED_BY(mutex_);  // by address
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_ADAPTER_PROBES_H_
