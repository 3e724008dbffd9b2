// Clients of `docent-bench notify`: they follow constraints over eight connections, and match each
// notification with the update that causes it. gRPC's threads call in; the other functions from any thread.
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

// Subscribe for each constraint, or one SubscribeStream for each connection.
enum class Streams { kOneAConstraint, kOneAConnection };

class Subscribers {
 public:
  // Follows the first `count` constraints; waits until each has its first answer.
  Subscribers(const std::string& address, size_t count, Streams streams);
  ~Subscribers();

  bool ready() const { return ready_; }
  // The effect of an update: this constraint begins or ceases to hold.
  struct Flip {
    size_t constraint;
    bool holds;
  };
  // Registers the expected flips of updates that were due at `due`.
  void Expect(const std::vector<Flip>& flips, SteadyClock::time_point due);
  // Waits until fewer than `limit` notifications are outstanding; false: `timeout` passed.
  bool WaitForFewerThan(size_t limit, absl::Duration timeout);

  struct Result {
    std::vector<double> latencies_us;
    size_t lost = 0;   // expected but not received
    size_t wrong = 0;  // received but not expected: out of order, or repeated
    SteadyClock::time_point last;
  };
  // The notifications since the last Take; outstanding ones are given up.
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
