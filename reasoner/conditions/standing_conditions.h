// Standing conditions: SPARQL ASK queries whose answer is always known, and reported when it changes.
//
// They are the comparator of the paper: a workflow node waits for a condition to rise, an activator for each
// new binding. The cost of an update depends on the conditions that it can affect, not on the number of
// conditions or the size of the graph:
//
//   - A condition that does not hold watches the patterns through which it could begin to hold. A matching
//     change is bound into the query, and only the rest is evaluated ("delta join"). If one of its patterns
//     has no match at all, only that pattern is watched.
//   - Conditions that differ only in constants share the patterns without them: one delta join for all,
//     whose solutions tell which of them rise.
//   - A condition that holds keeps one *witness* (a solution) for each key, and watches only the changes
//     that could break that solution.
//
// Patterns inside NOT EXISTS, MINUS, OPTIONAL, EXISTS are watched too, in the direction that matters. Queries
// that cannot be analysed in this way (sub-SELECT, aggregates, recursive paths) are evaluated whole when one
// of their patterns is touched, and queries with NOW() or RAND() at every update: correct, slower, and
// visible in the counters.
//
// Levels are exact after each Update. Rollback undoes the changes since the last Commit. One thread: the one
// that interns into its dictionary.
#ifndef DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_H_
#define DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_H_

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/delta.h"
#include "graph/store/graph_version.h"

namespace docent::conditions {

// Never reused within one StandingConditions.
class ConditionId {
 public:
  constexpr ConditionId() = default;
  constexpr explicit ConditionId(uint64_t value) : value_(value) {}
  constexpr uint64_t value() const { return value_; }
  friend constexpr auto operator<=>(ConditionId, ConditionId) = default;
  template <typename H>
  friend H AbslHashValue(H h, ConditionId id) {
    return H::combine(std::move(h), id.value_);
  }

 private:
  uint64_t value_ = 0;
};

// One solution: variable name (without "?") and value, in the query's order of variables; unbound variables
// are left out. Ids are the dictionary's: computed values are interned.
using Binding = std::vector<std::pair<std::string, TermId>>;

// The change of one condition by an Update.
struct ConditionChange {
  enum class Edge : uint8_t {
    kRose,             // did not hold, holds now
    kFell,             // held, does not hold now
    kBindingsChanged,  // holds as before, but with other key bindings (only with key variables)
  };
  ConditionId id;
  Edge edge = Edge::kRose;
  // With key variables: the key bindings that became and ceased to be answers, in term order.
  std::vector<Binding> appeared;
  std::vector<Binding> disappeared;
  // It has more key bindings than are kept, and is not followed any more: to be removed.
  bool overflowed = false;
};

struct RegisterOptions {
  // Variables whose distinct bindings are followed (by an activator). Empty: only whether it holds.
  std::vector<std::string> key_variables;
  TimeMicros now_us = 0;                 // NOW()
  Cancellation* cancellation = nullptr;  // of the evaluation that gives the first level; null: none
};

class StandingConditions {
 public:
  // `dictionary` interns the constants of queries and computed key values. Both must outlive the set.
  explicit StandingConditions(Dictionary& dictionary, const sparql::FunctionRegistry* functions = nullptr);
  ~StandingConditions();
  StandingConditions(const StandingConditions&) = delete;
  StandingConditions& operator=(const StandingConditions&) = delete;

  // From now on at most so many key bindings are kept of one condition, or as many as the graph has facts, whichever is more;
  // also the solutions that Solutions looks at. At first: any number.
  void LimitMatches(size_t most);

  // Begins to follow `ask` (form ASK; the WHERE of a SELECT is also accepted). `now` is the version from
  // which the next Update's delta starts; the level on it is known at once and is not reported as a change.
  // INVALID_ARGUMENT for a key variable that the query does not bind or another form of query; UNIMPLEMENTED
  // for queries that the evaluator does not support. Equal queries share their work.
  absl::StatusOr<ConditionId> Register(const sparql::Query& ask, const GraphVersion& now,
                                       const RegisterOptions& options = {});
  // Stops following; unknown ids are ignored.
  void Remove(ConditionId id);

  // `delta` leads from the version of the last Update to `version`. Returns the changes in order of id, valid
  // until the next Update. An error is one of the evaluator's limits, or `cancellation`'s; the caller then
  // rolls back.
  absl::StatusOr<absl::Span<const ConditionChange>> Update(const GraphVersion& version, const Delta& delta,
                                                           TimeMicros now_us = 0,
                                                           Cancellation* cancellation = nullptr);

  // True if it held at the last Update. False for an unknown id.
  bool Holds(ConditionId id) const;
  // True if it has more key bindings than are kept (LimitMatches). It is not followed any more.
  bool Overflowed(ConditionId id) const;
  // True if a change of a quad with this subject and predicate may change its answer (of types: with this object, too); whatever
  // the object, since a property may have one value only. True for an unknown id.
  bool MayChange(ConditionId id, const Quad& quad) const;
  // The key bindings at the last Update, in term order. A condition without keys that holds has one empty
  // binding.
  std::vector<Binding> Keys(ConditionId id) const;
  // Solutions on `version` with the values of `fixed`: all visible variables, distinct, in term order, the
  // first `limit` of them. None if `fixed` has another variable. NOT_FOUND for an unknown id; RESOURCE_EXHAUSTED beyond
  // LimitMatches.
  absl::StatusOr<std::vector<Binding>> Solutions(ConditionId id, const GraphVersion& version,
                                                 const Binding& fixed, size_t limit, TimeMicros now_us = 0,
                                                 Cancellation* cancellation = nullptr);

  // The turn succeeded: keeps registrations, removals and changes since the last Commit.
  void Commit();
  // The turn failed: returns to the last Commit. Ids given since then become unknown.
  void Rollback();

  // The clock for measuring costs, in monotonic nanoseconds. No decision depends on it.
  using StopWatch = uint64_t (*)();
  void SetStopWatch(StopWatch now_ns);

  size_t size() const;  // conditions followed
  // Since construction, for /metrics.
  struct Counters {
    uint64_t updates = 0;      // calls of Update
    uint64_t candidates = 0;   // (condition, changed quad) pairs found by the index
    uint64_t evaluations = 0;  // queries or delta joins run by Update
    uint64_t changes = 0;      // changes reported
    // Those of the evaluations that no change narrowed: their cost grows with the graph.
    uint64_t whole_evaluations = 0;
    uint64_t whole_ns = 0;  // by the stop watch; 0 without one
  };
  const Counters& counters() const;
  uint64_t candidates() const { return counters().candidates; }
  uint64_t evaluations() const { return counters().evaluations; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_H_
