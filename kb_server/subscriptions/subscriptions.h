// Subscriptions of clients: the answer of an ASK or SELECT, and what changes in it after each turn.
//
// Off the writer: the committer hands over each durable version with what changed in it. A thread of its own brings the
// answers to that very version and keeps what changed of them in a ring under growing numbers. Answers that a
// StandingConditions can keep (subscribed_form.h says which) cost what the change touches, however many there are; the others
// are asked whole when a change can match them. Queries of the same text share all of it. What must have been the answer
// for a while is told when it has: time is that of the turns, and between them the clock's. A client holds a place in the
// ring and no memory; one that falls behind it is given the whole answer anew. A query that nobody follows any more is
// kept for a while, so that a client that lost its connection can go on.
//
// Publish from the committer's thread, PublishWhole from the writer's while nothing is committed; the rest from any.
#ifndef DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIPTIONS_H_
#define DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIPTIONS_H_

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/container/btree_set.h"
#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graph/base/clock.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/base/subscription_limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/store/delta_sum.h"
#include "graph/store/graph_version.h"
#include "kb_server/door/client.h"
#include "kb_server/subscriptions/subscription_answer.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/matching/pattern_index.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::server {

// Read by any thread for /metrics.
struct SubscriptionCounters {
  std::atomic<uint64_t> open{0};     // subscribers
  std::atomic<uint64_t> queries{0};  // different ones that are followed
  std::atomic<uint64_t> evaluations{0};
  std::atomic<uint64_t> evaluation_ns{0};
  std::atomic<uint64_t> changes{0};  // of answers
  std::atomic<uint64_t> replies{0};  // sent to clients
  std::atomic<uint64_t> resets{0};   // clients that were given the whole answer anew because they fell behind
  std::atomic<uint64_t> coalesced{
      0};  // turns looked at together with the one before: over subscription_backlog
  std::atomic<uint64_t> revision{0};  // that has been looked at
  std::atomic<uint64_t> bytes{0};     // of queries and answers, but for whole ones that are being sent
};

// What is followed.
struct SubscribedQuery {
  std::string text;
  TimeMicros at_least_us =
      0;  // a row, or yes, is told when it has been the answer for so long without a break

  friend bool operator==(const SubscribedQuery&, const SubscribedQuery&) = default;
  template <typename H>
  friend H AbslHashValue(H h, const SubscribedQuery& q) {
    return H::combine(std::move(h), q.text, q.at_least_us);
  }
};

// One who follows an answer.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  // There may be something new, or `WakeAt` has come. Quick; from any thread.
  virtual void Wake() = 0;
  // Everyone who is woken at this time has been: who sends for several may do it now.
  virtual void AllWoken() {}
  // It cannot be followed any more.
  virtual void Fail(const absl::Status& status) = 0;
};

class KnownPrefixes;

class Subscriptions {
 public:
  struct Settings {
    const Dictionary* dictionary = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    KnownPrefixes* prefixes = nullptr;  // null: the well-known ones
    const Clock* clock = nullptr;
    MemoryBudget* query_memory = nullptr;  // while queries are read; null: each is bounded alone
    Limits limits;                         // of queries
    SubscriptionLimits subscription_limits;
    sparql::DefaultGraph default_graph = sparql::DefaultGraph::kUnion;
    std::string epoch;  // of this life of the server: part of every resume token
  };
  // Everything must outlive it. Starts its thread.
  explicit Subscriptions(const Settings& settings);
  ~Subscriptions();
  Subscriptions(const Subscriptions&) = delete;
  Subscriptions& operator=(const Subscriptions&) = delete;

  // A turn is durable and visible: `delta` leads to `version` from the one before.
  void Publish(GraphVersionPtr version, const Delta& delta, TimeMicros time_us);
  // The graph is `version` now, whatever it was.
  void PublishWhole(GraphVersionPtr version);

  // Begins to follow; `done` gets the answer (from the thread that evaluates it), with an answer on some version that
  // is as new as those that were visible when this was called. INVALID_ARGUMENT, UNIMPLEMENTED (another form of
  // query, SERVICE); RESOURCE_EXHAUSTED: subscriptions_open, subscription_rows, subscriptions_bytes; DEADLINE_EXCEEDED:
  // subscription_evaluation_ms. It says whether the subscriber is still there; one that is not is closed.
  using Opened = std::function<bool(const absl::StatusOr<SubscriptionAnswerPtr>&)>;
  void Open(const SubscribedQuery& query, std::shared_ptr<Subscriber> subscriber, Opened done,
            ClientPtr client = nullptr);
  // Ends following; after it neither Wake nor Fail is called. Not from within these.
  void Close(const std::shared_ptr<Subscriber>& subscriber);
  // Calls Wake at about this time.
  void WakeAt(absl::Time time, std::weak_ptr<Subscriber> subscriber);

  const std::string& epoch() const { return settings_.epoch; }
  SubscriptionCounters& counters() { return counters_; }
  // What all queries and answers hold; for metrics.
  size_t bytes() const { return counters_.bytes + *all_wholes_; }
  // Waits until everything published so far has been looked at. For tests.
  void Drain();

 private:
  struct Turn {
    GraphVersionPtr version;
    DeltaSum changes;
    TimeMicros time_us = 0;   // of the last of those looked at together
    TimeMicros first_us = 0;  // and of the first: until then what was before it was so
    bool whole = false;
  };
  struct Opening {
    SubscribedQuery followed;
    sparql::Query query;
    std::shared_ptr<MemoryUse> memory;  // of the query
    std::shared_ptr<Subscriber> subscriber;
    Opened done;
    ClientPtr client;
  };
  struct Subscription;  // a query that is followed
  class Evaluating;

  void Run();
  void Process(Turn turn);
  void OpenNow(Opening opening);
  absl::StatusOr<Subscription*> FindOrMake(Opening* opening);
  // From the whole answer on `version_` on, its changes will be noticed.
  absl::Status Begin(Subscription& subscription);
  // The same for one that has begun before.
  void BeginAnew(Subscription& subscription);
  absl::Status Prepare(Subscription& subscription);
  // Asks the whole query. Not OK: `subscription` is gone, its subscribers know.
  absl::Status Evaluate(Subscription& subscription);
  // Gives it to a StandingConditions. False: that cannot keep it.
  bool Keep(Subscription& subscription);
  void ForgetKept();
  // What is to be said of a query that took so long; empty: nothing.
  std::string WarningOf(const Subscription& subscription, absl::Duration took) const;
  void Watch(Subscription& subscription);
  void Unwatch(Subscription& subscription);
  void Forget(Subscription& subscription);  // neither kept nor watched
  std::optional<matching::MatchPattern> MatchOf(const matching::TriggerSource& source) const;
  // Those that named a term which the dictionary has learnt since; they are no longer watched.
  std::vector<uint32_t> LearnConstants();
  // False: too much for a StandingConditions at once.
  bool UpdateKept(const Delta& delta);
  // The watched queries whose answer the change may change.
  absl::btree_set<uint32_t> Touched(const Delta& delta) const;
  absl::Status TooManyRows() const;
  bool MayTurn(matching::PatternIndex::Reference reference, bool added) const;
  void Changed(const Subscription& subscription);
  // What has lasted long enough by then is told.
  void Ripen(TimeMicros now_us);
  // After its answer may have changed: notes when it ripens next.
  void NoteRipening(Subscription& subscription);
  void WakeSubscribers();
  void WakeDue(const std::vector<std::weak_ptr<Subscriber>>& due);
  void FailAll(Subscription& subscription, const absl::Status& status);
  // Since when nobody follows it; InfiniteFuture: somebody does, or it goes.
  void NoteIdle(Subscription& subscription, absl::Time since);
  void DropIdle();
  // Notes what it and its answer hold now; for that, answers that nobody follows go, the oldest first. An error: it is too much.
  absl::Status Charge(Subscription& subscription);
  bool HasRoomFor(const Client* client, size_t bytes) const;
  void SetCharged(Subscription& subscription, size_t bytes);
  void Drop(uint32_t number);
  bool HasWork() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || !turns_.empty() || !openings_.empty();
  }

  const Settings settings_;
  SubscriptionCounters counters_;

  absl::Mutex mutex_;
  std::deque<Turn> turns_ ABSL_GUARDED_BY(mutex_);
  std::deque<Opening> openings_ ABSL_GUARDED_BY(mutex_);
  std::multimap<absl::Time, std::weak_ptr<Subscriber>> alarms_ ABSL_GUARDED_BY(mutex_);
  bool busy_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  Cancellation* evaluating_ ABSL_GUARDED_BY(mutex_) = nullptr;
  bool followed_ ABSL_GUARDED_BY(mutex_) =
      false;  // there are queries; else turns are not looked at, but for newest_
  GraphVersionPtr newest_ ABSL_GUARDED_BY(mutex_);
  TimeMicros newest_time_us_ ABSL_GUARDED_BY(mutex_) = 0;

  // Who is open, and what it follows. Held while subscribers are woken, so that Close can promise.
  absl::Mutex subscribers_mutex_;
  struct Place {
    uint32_t subscription = 0;  // number of the query
    uint32_t index = 0;         // in subscribers_of_ of it
  };
  absl::flat_hash_map<std::shared_ptr<Subscriber>, Place> subscribers_ ABSL_GUARDED_BY(subscribers_mutex_);
  std::vector<std::vector<std::shared_ptr<Subscriber>>> subscribers_of_
      ABSL_GUARDED_BY(subscribers_mutex_);  // by number
  std::vector<uint32_t> left_
      ABSL_GUARDED_BY(subscribers_mutex_);  // by their last subscriber, since it was looked at

  // Of the thread.
  GraphVersionPtr version_;
  TimeMicros time_us_ = 0;                                // of its turn
  TimeMicros now_us_ = 0;                                 // until when what is published has been looked at
  std::vector<std::unique_ptr<Subscription>> by_number_;  // by number; null: free
  std::vector<uint32_t> free_;
  absl::flat_hash_map<SubscribedQuery, uint32_t> by_query_;
  absl::btree_set<std::pair<TimeMicros, uint32_t>> ripening_;  // when, and which
  absl::btree_set<std::pair<absl::Time, uint32_t>> idle_;      // nobody follows them: since when, and which
  Dictionary names_;  // the condition set's: the dictionary, read only
  std::unique_ptr<conditions::StandingConditions> kept_;
  absl::flat_hash_map<conditions::ConditionId, uint32_t> by_constraint_;
  matching::PatternIndex watches_;  // of the others
  absl::flat_hash_set<uint32_t> volatile_;
  std::vector<uint32_t> changed_;  // of which the subscribers have not heard
  absl::Time changed_since_;
  absl::flat_hash_map<Term, std::vector<uint32_t>> awaited_;  // named by these, unknown to the dictionary
  size_t dictionary_size_ = 0;                                // that has been looked at for them
  const std::shared_ptr<KeptBytes> all_kept_ = std::make_shared<KeptBytes>(0);    // by the answers
  const std::shared_ptr<KeptBytes> all_wholes_ = std::make_shared<KeptBytes>(0);  // that are being sent
  absl::flat_hash_map<const Client*, size_t> charged_;                            // bytes by who pays
  size_t idle_bytes_ = 0;                                                         // of answers in idle_
  uint64_t next_answer_ = 1;
  absl::Time next_idle_check_ = absl::InfinitePast();
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIPTIONS_H_
