// Tells the server facts, in order, each until it is acknowledged: whatever happens to the network or the
// server, no batch is lost, applied twice (request ids) or overtaken by a later one.
//
// State facts (one value a property: where the robot is, what it does) that wait while the server is away are
// merged, so that the newest value is sent when it is back and the queue stays short. Other batches are kept
// as they are; when the queue is full, adding one is refused.
//
// Thread-safe. One thread sends; `Set`, `Clear` and `Tell` never wait for the network.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_FACT_SENDER_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_FACT_SENDER_H_

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "docent/v1/context.pb.h"
#include "graph/rdf/term.h"

namespace docent::robot {

struct FactSenderOptions {
  std::string source;             // IRI of who says the facts
  std::string request_id_prefix;  // unique to this process: request ids are PREFIX/1, PREFIX/2, …
  size_t queue_limit = 1024;      // 1..: batches that wait, besides the merged state batch
  absl::Duration call_timeout = absl::Seconds(10);
  absl::Duration first_retry = absl::Milliseconds(50);  // doubles with every failure
  absl::Duration last_retry = absl::Seconds(2);         // up to this
};

// A raw sensor reading.
struct Reading {
  std::string sensor;  // IRI
  Term value;
};

class FactSender {
 public:
  // Sends one batch; must return when told to stop. The real one calls Context.Assert.
  using AssertCall = std::function<absl::Status(const v1::AssertRequest&, v1::AssertReply*)>;

  FactSender(FactSenderOptions options, AssertCall call);
  ~FactSender();

  // The property of the subject has this value now. Nothing is sent when it is the value set last.
  void Set(const std::string& subject, const std::string& predicate, Term value);
  // Several properties of one subject in one batch, so that no reader sees the x of one place with the y of
  // another; nullopt: no value now. Where one is a number that is not finite (NaN of a sensor), none of them is told: that
  // is logged, and counts as refused().
  void SetAll(const std::string& subject, std::vector<std::pair<std::string, std::optional<Term>>> values);
  // The server has this value of ours from an earlier life of this program. It is withdrawn unless this life
  // has told one of its own.
  void WithdrawLeftover(const std::string& subject, const std::string& predicate, Term value);
  // The property of the subject has no value now.
  void Clear(const std::string& subject, const std::string& predicate);

  // Adds and removes facts; `readings` are raw sensor readings. RESOURCE_EXHAUSTED when queue_limit batches
  // wait; INVALID_ARGUMENT for a number that is not finite.
  absl::Status Tell(std::vector<TermQuad> add, std::vector<TermQuad> remove = {},
                    std::vector<Reading> readings = {});

  // States of this subject are told no more.
  void EndStatesOf(const std::string& subject);

  // Sends all states anew: the server may have forgotten them.
  void ResendStates();

  // Waits until everything told so far is acknowledged. False: not within the timeout, or stopped.
  bool Flush(absl::Duration timeout);

  // Ends sending after at most `linger` for what is queued.
  void Stop(absl::Duration linger);

  // Batches that the server refused for good, and states that were no measures (mistakes of this program); logged.
  uint64_t refused() const;

 private:
  using StateKey = std::pair<std::string, std::string>;  // subject, predicate
  struct Batch {
    std::map<StateKey, std::optional<Term>> states;  // nullopt: cleared
    std::vector<TermQuad> add;
    std::vector<TermQuad> remove;
    std::vector<Reading> readings;
    bool StatesOnly() const { return add.empty() && remove.empty() && readings.empty(); }
  };

  void Run();
  void PutState(StateKey key, std::optional<Term> value) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  v1::AssertRequest Build(const Batch& batch) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Refuse(const StateKey& key, const Term& value) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool SendUntilAnswered(const v1::AssertRequest& request);
  bool Interrupted() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const FactSenderOptions options_;
  const AssertCall call_;
  mutable absl::Mutex mutex_;
  std::deque<Batch> queue_ ABSL_GUARDED_BY(mutex_);
  std::map<StateKey, std::optional<Term>> told_ ABSL_GUARDED_BY(mutex_);  // newest value of each state
  std::map<StateKey, Term> sent_ ABSL_GUARDED_BY(mutex_);                 // what the server has or is getting
  std::set<std::string> ended_ ABSL_GUARDED_BY(mutex_);    // subjects whose states are told no more
  std::set<StateKey> unmeasured_ ABSL_GUARDED_BY(mutex_);  // whose newest value was no measure
  bool sending_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  uint64_t requests_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t refused_ ABSL_GUARDED_BY(mutex_) = 0;
  std::thread thread_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_FACT_SENDER_H_
