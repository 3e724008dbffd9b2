// Standing conditions: SPARQL ASK queries whose answer is known at every moment, and told when it changes.
//
// The comparator of the paper: a workflow node waits for a condition to rise, an activator for each new
// binding. The cost of an update depends on the conditions that it can touch, not on how many exist or how
// large the graph is:
//
//   - What does not hold watches the patterns through which it could begin to hold. A matching change is
//   bound into the
//     query and only the rest is evaluated ("delta join"). Where a pattern of it has no match at all, that
//     one alone is watched.
//   - Conditions that differ only in constants share the patterns without them: one delta join for all, whose
//   solutions say which of them rise.
//   - What holds keeps one *witness* (a solution) for each key and watches only what could break that very
//   solution.
//
// Patterns inside NOT EXISTS, MINUS, OPTIONAL, EXISTS are watched too, in the direction in which they count.
// What cannot be analysed so (sub-SELECT, aggregates, recursive paths) is evaluated whole when one of its
// patterns is touched, and NOW() or RAND() at every update: correct, slower, and visible in the counters.
//
// Levels are exact after each Update. Changes made since the last Commit are undone by Rollback. One thread:
// the one that interns into its dictionary.
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

// One solution: variable name (without "?") and value, in the query's order of variables; unbound ones are
// left out. Ids are the dictionary's: computed values are interned.
using Binding = std::vector<std::pair<std::string, TermId>>;

// What an Update changed about one condition.
struct ConditionChange {
  enum class Edge : uint8_t {
    kRose,             // did not hold, holds now
    kFell,             // held, does not hold now
    kBindingsChanged,  // holds as before, but with other key bindings (only where key variables are tracked)
  };
  ConditionId id;
  Edge edge = Edge::kRose;
  // With key variables: the bindings of the keys that began and ceased to be answers, in term order.
  std::vector<Binding> appeared;
  std::vector<Binding> disappeared;
};

struct RegisterOptions {
  // Variables whose distinct bindings are followed (an activator's). Empty: only whether it holds.
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

  // Begins to follow `ask` (form ASK; the WHERE of a SELECT is taken likewise). `now` is the version that the
  // next Update's delta starts from; the level on it is known at once and is not reported as a change.
  // INVALID_ARGUMENT for a key variable that the query does not bind or another form of query; UNIMPLEMENTED
  // for what the evaluator cannot do. Queries that are the same share their work.
  absl::StatusOr<ConditionId> Register(const sparql::Query& ask, const GraphVersion& now,
                                       const RegisterOptions& options = {});
  // Ends following; unknown ids are ignored.
  void Remove(ConditionId id);

  // `delta` leads from the version of the last Update to `version`. The changes, in order of id; they stay until the
  // next Update. An error is one of the evaluator's limits, or `cancellation`'s; the caller then rolls back.
  absl::StatusOr<absl::Span<const ConditionChange>> Update(const GraphVersion& version, const Delta& delta,
                                                           TimeMicros now_us = 0,
                                                           Cancellation* cancellation = nullptr);

  // Whether it holds as of the last Update. False for an unknown id.
  bool Holds(ConditionId id) const;
  // The key bindings as of the last Update, in term order. One empty binding for a condition without keys
  // that holds.
  std::vector<Binding> Keys(ConditionId id) const;
  // Solutions on `version` that have the values of `fixed`, with all visible variables, distinct, in term order, the
  // first `limit` of them. None where `fixed` has another variable. NOT_FOUND for an unknown id.
  absl::StatusOr<std::vector<Binding>> Solutions(ConditionId id, const GraphVersion& version,
                                                 const Binding& fixed, size_t limit, TimeMicros now_us = 0,
                                                 Cancellation* cancellation = nullptr);

  // The turn is done: what was registered, removed and learnt since the last Commit stays.
  void Commit();
  // The turn failed: back to the last Commit. Ids given since then are unknown.
  void Rollback();

  // What time costs are counted in: monotonic nanoseconds. Nothing is decided by it.
  using StopWatch = uint64_t (*)();
  void SetStopWatch(StopWatch now_ns);

  size_t size() const;  // conditions followed
  // Since construction, for /metrics.
  struct Counters {
    uint64_t updates = 0;      // calls of Update
    uint64_t candidates = 0;   // (condition, changed quad) pairs that the index found
    uint64_t evaluations = 0;  // queries or delta joins run by Update
    uint64_t changes = 0;      // edges reported
    // Of these evaluations, those that no change narrowed: what they cost grows with the graph.
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
