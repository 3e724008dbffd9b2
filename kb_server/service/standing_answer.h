// The answer of one standing query as it changes: written by the thread that evaluates it, read by the clients that
// follow it, each at its own pace. Thread-safe.
#ifndef DOCENT_KB_SERVER_SERVICE_STANDING_ANSWER_H_
#define DOCENT_KB_SERVER_SERVICE_STANDING_ANSWER_H_

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
#include "kb_server/base/ids.h"
#include "kb_server/base/subscription_limits.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/rdf/term.h"

namespace docent {

// A row and how often it comes or goes: answers are bags.
struct CountedRow {
  std::vector<std::optional<Term>> values;  // one a variable; nullopt: unbound
  uint64_t count = 1;
};

// One change of an answer.
struct AnswerChange {
  uint64_t number = 0;  // from 1, by one
  Revision revision;    // the answer after it is that of this version
  bool boolean = false;                // ASK
  std::vector<CountedRow> appeared;    // SELECT
  std::vector<CountedRow> disappeared;
};
using AnswerChangePtr = std::shared_ptr<const AnswerChange>;

class StandingAnswer {
 public:
  // `id`: unique in this life of the server. `dictionary` must outlive it.
  StandingAnswer(uint64_t id, bool is_boolean, std::vector<std::string> variables, const Dictionary* dictionary,
                 const SubscriptionLimits& limits)
      : id_(id), is_boolean_(is_boolean), variables_(std::move(variables)), dictionary_(*dictionary), limits_(limits) {}

  uint64_t id() const { return id_; }
  bool is_boolean() const { return is_boolean_; }
  const std::vector<std::string>& variables() const { return variables_; }

  // ---- the thread that evaluates -----------------------------------------------------------------------------
  using Row = absl::InlinedVector<TermId, 4>;
  using Rows = absl::flat_hash_map<Row, uint64_t>;
  // The id under which rows hold a computed value, until the next SetRows; there it may get another.
  TermId Local(const Term& term);
  // The answer on `revision`. True: it differs from the one before.
  bool SetBoolean(Revision revision, bool holds);
  bool SetRows(Revision revision, Rows rows);
  // The same by its changes: rows that came, and rows that went; a row in both is one that stayed.
  bool ChangeRows(Revision revision, absl::Span<const Row> appeared, absl::Span<const Row> disappeared);
  size_t size() const;  // rows, each as often as it counts
  bool boolean() const;
  bool evaluated() const;

  // ---- those who follow --------------------------------------------------------------------------------------
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
  void Keep(AnswerChange change) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void AdoptKnownLocals() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void DropUnusedLocals() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const uint64_t id_;
  const bool is_boolean_;
  const std::vector<std::string> variables_;
  const Dictionary& dictionary_;
  const SubscriptionLimits limits_;

  mutable absl::Mutex mutex_;
  bool evaluated_ ABSL_GUARDED_BY(mutex_) = false;
  Revision revision_ ABSL_GUARDED_BY(mutex_);
  bool boolean_ ABSL_GUARDED_BY(mutex_) = false;
  Rows rows_ ABSL_GUARDED_BY(mutex_);
  size_t size_ ABSL_GUARDED_BY(mutex_) = 0;
  static constexpr size_t kFewLocals = 1000;
  std::vector<Term> locals_ ABSL_GUARDED_BY(mutex_);
  size_t drop_locals_at_ ABSL_GUARDED_BY(mutex_) = kFewLocals;
  absl::flat_hash_map<Term, TermId> local_ids_ ABSL_GUARDED_BY(mutex_);
  std::deque<AnswerChangePtr> changes_ ABSL_GUARDED_BY(mutex_);
  size_t kept_rows_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t newest_ ABSL_GUARDED_BY(mutex_) = 0;
  mutable AnswerChangePtr whole_ ABSL_GUARDED_BY(mutex_);  // made when first asked for
};
using StandingAnswerPtr = std::shared_ptr<StandingAnswer>;

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_STANDING_ANSWER_H_
