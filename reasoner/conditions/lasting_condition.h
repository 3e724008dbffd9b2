// A condition of which some parts must have held for a while: "a visitor is at the booth (for at least 5 s) and a
// robot is free".
//
// It is told which solutions the whole and its parts have, and counts the time of each binding of a part's
// variables. A solution of the whole is *open* while every part's binding in it has held for the part's time
// without a break. What is told outside are the open solutions, projected to the key variables.
//
// It reads no clock: time comes with the calls and does not decrease. Time is looked at by Settle alone, so what
// ends before the Settle at or after its time never opens. Writer thread only.
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
    std::vector<std::string> variables;  // what tells its solutions apart
    TimeMicros at_least_us = 0;
  };
  LastingCondition(std::vector<std::string> keys, std::vector<Part> parts);
  LastingCondition(const LastingCondition&) = delete;
  LastingCondition& operator=(const LastingCondition&) = delete;

  // What tells solutions of the whole apart: the keys and the variables of all parts.
  const std::vector<std::string>& variables() const { return variables_; }

  // The whole has, or has no longer, a solution with these values of variables(). Saying it twice does no harm.
  void SetWhole(const Binding& solution, bool present);
  // Likewise of a part with its variables; its time begins at `now_us`.
  void SetPart(size_t part, const Binding& binding, bool present, TimeMicros now_us);

  // What is open now, against the Settle before.
  struct Changes {
    bool rose = false;
    bool fell = false;
    std::vector<Binding> appeared;  // of the keys, in no particular order
    std::vector<Binding> disappeared;
    bool any() const { return rose || fell || !appeared.empty() || !disappeared.empty(); }
  };
  Changes Settle(TimeMicros now_us);

  // As of the last Settle.
  bool holds() const { return !open_.empty(); }
  // Whether the times of all parts are full for this solution.
  bool Admits(const Binding& solution) const;
  // When Settle has something to do next, if nothing else changes.
  std::optional<TimeMicros> NextDeadline() const;

  // The turn is done; or back to the last Commit.
  void Commit() { undo_.clear(); }
  void Rollback();

  // How long the bindings of the parts have held, for a snapshot, in no particular order.
  struct Since {
    uint32_t part = 0;
    Binding binding;
    TimeMicros since_us = 0;
    bool full = false;  // its time is full
  };
  std::vector<Since> Times() const;
  // Puts back the time of a binding that is present. The next Settle opens what it opens.
  void SetTime(const Since& since);

 private:
  using Row = absl::InlinedVector<TermId, 4>;  // none: unbound
  struct Time {
    TimeMicros since_us = 0;
    bool full = false;
  };
  struct PartState {
    std::vector<std::string> variables;
    TimeMicros at_least_us = 0;
    std::vector<size_t> columns;  // of variables_
    absl::flat_hash_map<Row, Time> times;
    absl::btree_set<std::pair<TimeMicros, Row>> waiting;    // when the time will be full
    absl::flat_hash_map<Row, absl::btree_set<Row>> wholes;  // solutions of the whole with this binding
  };
  struct Undo {
    static constexpr size_t kWhole = SIZE_MAX;
    size_t part = kWhole;
    Row row;
    std::optional<Time> time;  // of a part's binding, before
    std::optional<bool> open;  // of a solution of the whole, before
  };

  static Row RowOf(const Binding& binding, const std::vector<std::string>& variables);
  static Row Project(const Row& whole, const std::vector<size_t>& columns);
  Binding BindingOf(const Row& row, const std::vector<std::string>& variables) const;
  bool AllFull(const Row& whole) const;
  // The only places that change anything; nullopt: it is not there.
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
  absl::btree_set<Row> stale_;             // solutions that Settle has to look at
  absl::btree_map<Row, bool> before_;  // keys that changed since the last Settle → whether they were open
  std::vector<Undo> undo_;
  bool undoing_ = false;
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_LASTING_CONDITION_H_
