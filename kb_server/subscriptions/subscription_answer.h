// The answer of one subscribed query as it changes: written by the thread that evaluates it, read by the clients that
// follow it, each at its own pace. It may be told of it only what has lasted for a while. Thread-safe.
#ifndef DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIPTION_ANSWER_H_
#define DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIPTION_ANSWER_H_

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/types/span.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/base/subscription_limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "kb_server/subscriptions/young_rows.h"

namespace docent::server {

// A row and how often it comes or goes: answers are bags.
struct CountedRow {
  std::vector<std::optional<Term>> values;  // one a variable; nullopt: unbound
  uint64_t count = 1;
};

// One change of an answer.
struct AnswerChange {
  uint64_t number = 0;               // from 1, by one
  Revision revision;                 // the answer after it is that of this version
  bool boolean = false;              // ASK
  std::vector<CountedRow> appeared;  // SELECT
  std::vector<CountedRow> disappeared;
};
using AnswerChangePtr = std::shared_ptr<const AnswerChange>;

// Bytes of something that all answers keep.
using KeptBytes = std::atomic<size_t>;

class SubscriptionAnswer {
 public:
  // `all_kept`: changes of the answers that limits.subscriptions_kept_bytes is for; null: this one alone. `all_wholes`: whole
  // answers as terms, which are there while they are sent; likewise.
  // `id`: unique in this life of the server. `dictionary` must outlive it. Those who follow are told of a row, and of yes,
  // when that has been the answer without a break for `at_least_us`; that it is no longer, at once.
  SubscriptionAnswer(uint64_t id, bool is_boolean, std::vector<std::string> variables,
                     const Dictionary* dictionary, const SubscriptionLimits& limits,
                     TimeMicros at_least_us = 0, std::shared_ptr<KeptBytes> all_kept = nullptr,
                     std::shared_ptr<KeptBytes> all_wholes = nullptr)
      : id_(id),
        is_boolean_(is_boolean),
        variables_(std::move(variables)),
        dictionary_(*dictionary),
        limits_(limits),
        at_least_us_(at_least_us),
        all_kept_(all_kept == nullptr ? std::make_shared<KeptBytes>(0) : std::move(all_kept)),
        all_wholes_(all_wholes == nullptr ? std::make_shared<KeptBytes>(0) : std::move(all_wholes)) {}
  ~SubscriptionAnswer();

  uint64_t id() const { return id_; }
  bool is_boolean() const { return is_boolean_; }
  const std::vector<std::string>& variables() const { return variables_; }

  // ---- the thread that evaluates -----------------------------------------------------------------------------
  // Times may go back a little from call to call, from the clock's to that of a turn before: what is told stays told.
  using Row = YoungRows::Row;
  using Rows = absl::flat_hash_map<Row, uint64_t>;
  // The id under which rows hold a computed value, until the next SetRows; there it may get another.
  TermId Local(const Term& term);
  // The answer on `revision`, which came at this time. True: there is a change to tell.
  bool SetBoolean(Revision revision, bool holds, TimeMicros now_us);
  bool SetRows(Revision revision, Rows rows, TimeMicros now_us);
  // The same by its changes: rows that came, and rows that went; a row in both is one that stayed.
  bool ChangeRows(Revision revision, absl::Span<const Row> appeared, absl::Span<const Row> disappeared,
                  TimeMicros now_us);
  // When what is there and not told will have lasted long enough; nullopt: there is nothing.
  std::optional<TimeMicros> ripens_at_us() const;
  // What those who follow are told of the query with the whole answer. Before the first of them begins.
  void SetWarning(std::string warning);
  // Tells what has by now. True: there is a change to tell.
  bool Ripen(Revision revision, TimeMicros now_us);
  // Told or not:
  size_t size() const;  // rows, each as often as it counts
  bool boolean() const;
  bool evaluated() const;
  // What it holds, about, but for whole answers that are being sent.
  size_t bytes() const;

  // ---- those who follow --------------------------------------------------------------------------------------
  std::string warning() const;
  // The whole answer as a change from nothing, with the number of the newest change (0: none yet).
  AnswerChangePtr Whole() const;
  // The number of the newest change; 0: none yet.
  uint64_t newest() const;
  // Null: it has not happened yet. OUT_OF_RANGE: it is no longer kept.
  absl::StatusOr<AnswerChangePtr> Get(uint64_t number) const;
  // The changes from `number` on as one, numbered as the last; null: none. OUT_OF_RANGE as above.
  absl::StatusOr<AnswerChangePtr> Sum(uint64_t number) const;

 private:
  CountedRow Decode(const Row& row, uint64_t count) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void ForgetWhole() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void DropOldest() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Keep(AnswerChange change) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool TellBoolean(TimeMicros now_us) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // A row's count became another: notes what there is to tell.
  void Recount(const Row& row, uint64_t had, uint64_t has, TimeMicros now_us, AnswerChange* change)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // In rows_ and young_, and in `fresh`, which are to be the rows.
  void AdoptKnownLocals(Rows* fresh) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void DropUnusedLocals() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const uint64_t id_;
  const bool is_boolean_;
  const std::vector<std::string> variables_;
  const Dictionary& dictionary_;
  const SubscriptionLimits limits_;
  const TimeMicros at_least_us_;
  const std::shared_ptr<KeptBytes> all_kept_;
  const std::shared_ptr<KeptBytes> all_wholes_;

  mutable absl::Mutex mutex_;
  bool evaluated_ ABSL_GUARDED_BY(mutex_) = false;
  std::string warning_ ABSL_GUARDED_BY(mutex_);
  Revision revision_ ABSL_GUARDED_BY(mutex_);
  bool boolean_ ABSL_GUARDED_BY(mutex_) = false;
  TimeMicros boolean_since_us_ ABSL_GUARDED_BY(mutex_) = 0;
  bool told_ ABSL_GUARDED_BY(mutex_) = false;  // what of boolean_ is told
  Rows rows_ ABSL_GUARDED_BY(mutex_);
  YoungRows young_ ABSL_GUARDED_BY(mutex_);  // those of them that are not told
  size_t size_ ABSL_GUARDED_BY(mutex_) = 0;
  static constexpr size_t kFewLocals = 1000;
  std::vector<Term> locals_ ABSL_GUARDED_BY(mutex_);
  size_t drop_locals_at_ ABSL_GUARDED_BY(mutex_) = kFewLocals;
  absl::flat_hash_map<Term, TermId> local_ids_ ABSL_GUARDED_BY(mutex_);
  struct KeptChange {
    AnswerChangePtr change;
    size_t bytes = 0;
  };
  std::deque<KeptChange> changes_ ABSL_GUARDED_BY(mutex_);
  size_t kept_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t kept_rows_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t newest_ ABSL_GUARDED_BY(mutex_) = 0;
  size_t locals_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  // Made when first asked for; a small one stays, a large one goes when it is sent.
  mutable std::weak_ptr<const AnswerChange> whole_ ABSL_GUARDED_BY(mutex_);
  mutable AnswerChangePtr small_whole_ ABSL_GUARDED_BY(mutex_);
};
using SubscriptionAnswerPtr = std::shared_ptr<SubscriptionAnswer>;

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SUBSCRIPTIONS_SUBSCRIPTION_ANSWER_H_
