// A condition with parts that must have held for a while: "a visitor is at the booth (for at least 5 s) and a
// robot is free".
//
// The caller reports the solutions of the whole and of its parts; this class measures the time of each
// binding of a part's variables. A solution of the whole is *open* while every part's binding in it has held
// without a break for the part's time. The result is the open solutions, projected to the key variables.
//
// It reads no clock: the calls pass the time, which does not decrease. Only Settle compares times, so a
// binding that ends before the Settle at or after its time never opens. Writer thread only.
#ifndef DOCENT_REASONER_CONDITIONS_LASTING_CONDITION_H_
#define DOCENT_REASONER_CONDITIONS_LASTING_CONDITION_H_

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/btree_map.h"
#include "absl/container/btree_set.h"
#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "graph/base/clock.h"
#include "reasoner/conditions/standing_conditions.h"

namespace docent::conditions {

class LastingCondition {
 public:
  struct Part {
    std::vector<std::string> variables;  // they distinguish its solutions
    TimeMicros at_least_us = 0;
  };
  LastingCondition(std::vector<std::string> keys, std::vector<Part> parts);
  LastingCondition(const LastingCondition&) = delete;
  LastingCondition& operator=(const LastingCondition&) = delete;

  // The variables that distinguish solutions of the whole: the keys and the variables of all parts.
  const std::vector<std::string>& variables() const { return variables_; }

  // The whole has gained or lost a solution with these values of variables(). Repeated calls are harmless.
  void SetWhole(const Binding& solution, bool present);
  // The same for a part and its variables; the time of a new binding begins at `now_us`.
  void SetPart(size_t part, const Binding& binding, bool present, TimeMicros now_us);

  // Changes of the open solutions since the Settle before.
  struct Changes {
    bool rose = false;
    bool fell = false;
    std::vector<Binding> appeared;  // bindings of the keys, in no particular order
    std::vector<Binding> disappeared;
    bool any() const { return rose || fell || !appeared.empty() || !disappeared.empty(); }
  };
  Changes Settle(TimeMicros now_us);

  // As of the last Settle.
  bool holds() const { return !open_.empty(); }
  // True if the times of all parts have passed for this solution.
  bool Admits(const Binding& solution) const;
  // As of the last Settle: when the first solution will be open if nothing else changes. nullopt: one is open, there is none, or
  // there are too many to look at each.
  std::optional<TimeMicros> OpensAt() const;
  // The time of the next Settle that is needed if nothing else changes.
  std::optional<TimeMicros> NextDeadline() const;

  // Commit at the end of a turn; Rollback returns to the last Commit.
  void Commit() { undo_.clear(); }
  void Rollback();

  // How long the bindings of the parts have held, for a snapshot; in no particular order.
  struct Since {
    uint32_t part = 0;
    Binding binding;
    TimeMicros since_us = 0;
    bool full = false;  // its time has passed
  };
  std::vector<Since> Times() const;
  // Restores the time of a present binding. The next Settle opens the solutions that are due.
  void SetTime(const Since& since);

 private:
  using Row = absl::InlinedVector<TermId, 4>;  // kNone: unbound
  struct Time {
    TimeMicros since_us = 0;
    bool full = false;
  };
  struct PartState {
    std::vector<std::string> variables;
    TimeMicros at_least_us = 0;
    std::vector<size_t> columns;  // of variables_
    absl::flat_hash_map<Row, Time> times;
    absl::btree_set<std::pair<TimeMicros, Row>> waiting;    // by the time at which they become full
    absl::flat_hash_map<Row, absl::btree_set<Row>> wholes;  // binding → solutions of the whole with it
  };
  struct Undo {
    static constexpr size_t kWhole = SIZE_MAX;
    size_t part = kWhole;
    Row row;
    std::optional<Time> time;  // old value of a part's binding
    std::optional<bool> open;  // old value of a solution of the whole
  };

  static Row RowOf(const Binding& binding, const std::vector<std::string>& variables);
  static Row Project(const Row& whole, const std::vector<size_t>& columns);
  Binding BindingOf(const Row& row, const std::vector<std::string>& variables) const;
  bool AllFull(const Row& whole) const;
  // Only these functions change state; nullopt: removes the entry.
  void PutTime(size_t part, const Row& row, std::optional<Time> time);
  void PutWhole(const Row& row, std::optional<bool> open);
  void CountOpen(const Row& whole, int by);
  void WholesAreStale(size_t part, const Row& row);

  std::vector<std::string> variables_;
  const std::vector<std::string> keys_;
  std::vector<size_t> key_columns_;
  std::vector<PartState> parts_;
  absl::flat_hash_map<Row, bool> wholes_;  // solution → open
  absl::flat_hash_map<Row, int> open_;     // key → open solutions with it
  absl::btree_set<Row> stale_;             // solutions for Settle to check
  absl::btree_map<Row, bool> before_;      // keys changed since the last Settle → were they open
  std::vector<Undo> undo_;
  bool undoing_ = false;
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_LASTING_CONDITION_H_
