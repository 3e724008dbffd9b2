// The clients of `docent-bench notify`: they follow constraints over eight connections, and each notification is held
// against the update that it must come from. gRPC's threads call in; the rest from any thread.
#ifndef DOCENT_BENCH_SUBSCRIBERS_H_
#define DOCENT_BENCH_SUBSCRIBERS_H_

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "docent/v1/context.pb.h"

namespace docent::bench {

using SteadyClock = std::chrono::steady_clock;

// Subscribe, or one SubscribeStream a connection.
enum class Streams { kOneAConstraint, kOneAConnection };

class Subscribers {
 public:
  // Follows the first `count` standing constraints; waits until each has its first answer.
  Subscribers(const std::string& address, size_t count, Streams streams);
  ~Subscribers();

  bool ready() const { return ready_; }
  // What an update does: this constraint begins to hold, or ceases to.
  struct Flip {
    size_t constraint;
    bool holds;
  };
  // Those of the updates that were due then.
  void Expect(const std::vector<Flip>& flips, SteadyClock::time_point due);
  // Until fewer than `limit` notifications are outstanding; false: not within `timeout`.
  bool WaitForFewerThan(size_t limit, absl::Duration timeout);

  struct Result {
    std::vector<double> latencies_us;
    size_t lost = 0;   // expected and not come
    size_t wrong = 0;  // come and not expected then: out of order, or twice
    SteadyClock::time_point last;
  };
  // What came since the last Take; what is outstanding is given up.
  Result Take();

 private:
  class Stream;
  class OneConstraint;
  class ManyConstraints;
  struct Expected {
    bool holds;
    SteadyClock::time_point due;
  };
  void Replied(size_t constraint, const v1::SubscribeReply& reply) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Notified(size_t constraint, bool holds, SteadyClock::time_point now)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Ended(const grpc::Status& status);

  std::vector<std::unique_ptr<Stream>> streams_;
  bool ready_ = false;
  absl::Mutex mutex_;
  std::vector<std::deque<Expected>> expected_ ABSL_GUARDED_BY(mutex_);
  size_t outstanding_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t answered_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t ended_ ABSL_GUARDED_BY(mutex_) = 0;
  bool closing_ ABSL_GUARDED_BY(mutex_) = false;
  Result result_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_SUBSCRIBERS_H_
