// Group of many conditions that differ only in one number: ASK { ?r ex:battery ?b FILTER(?b < 0.2) }, … 0.21,
// … 0.3.
//
// They share one condition, the query without that comparison and with ?b as its key variable. The group
// keeps them ordered by their numbers. Which of them hold depends only on the extreme value of ?b, so a move
// of the extreme affects only the members between its old and new value. Private to this folder. Writer
// thread only.
#ifndef DOCENT_REASONER_CONDITIONS_THRESHOLD_GROUP_H_
#define DOCENT_REASONER_CONDITIONS_THRESHOLD_GROUP_H_

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/btree_map.h"
#include "absl/container/btree_set.h"
#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/matching/number_range.h"

namespace docent::conditions {

// A query as a template and one comparison of a variable with a number.
struct ThresholdForm {
  sparql::Query shared;  // without the comparison
  std::string variable;
  matching::Comparison op = matching::Comparison::kLess;  // ?variable op constant
  Term constant;
};
// nullopt if `query` does not have exactly one such comparison in its outermost filters.
std::optional<ThresholdForm> SplitThreshold(const sparql::Query& query);

// `a op b` of SPARQL, decided on ids if possible and by the evaluator otherwise.
class NumberComparer {
 public:
  explicit NumberComparer(const Dictionary& dictionary) : dictionary_(dictionary) {}
  absl::StatusOr<bool> Compare(TermId left, matching::Comparison op, TermId right,
                               const sparql::RunOptions& run);

 private:
  const Dictionary& dictionary_;
  std::array<std::unique_ptr<sparql::PreparedExpression>, 4>
      expressions_;  // by Comparison, when first needed
};

class ThresholdGroup {
 public:
  // `above`: its members require a value above their number (> and >=); otherwise one below.
  ThresholdGroup(bool above, const Dictionary& dictionary, NumberComparer& comparer);

  static bool IsAbove(matching::Comparison op) {
    return op == matching::Comparison::kGreater || op == matching::Comparison::kGreaterOrEqual;
  }

  // `key` has become, or is no longer, a value of the variable. The next Relevel updates the levels.
  void SetKey(TermId key, bool present);
  // Its level is correct for the keys at the last Relevel.
  absl::Status AddMember(ConditionId id, matching::Comparison op, TermId constant,
                         const sparql::RunOptions& run);
  void RemoveMember(ConditionId id, TermId constant);
  bool Holds(ConditionId id, TermId constant) const;
  // True if `value` of the variable makes the member hold.
  absl::StatusOr<bool> Admits(ConditionId id, TermId constant, TermId value,
                              const sparql::RunOptions& run) const;
  bool empty() const { return members_.empty(); }

  // Updates the levels to the keys and calls `visit` with each changed one.
  absl::Status Relevel(const sparql::RunOptions& run, absl::FunctionRef<void(ConditionId, bool level)> visit);

 private:
  struct Member {
    matching::Comparison op;
    TermId constant;
    bool level = false;
  };
  using Place = std::pair<double, ConditionId>;
  using Members = absl::btree_map<Place, Member>;

  static Place PlaceOf(ConditionId id, TermId constant) { return {matching::ViewNumber(constant).value, id}; }
  double Extreme() const;
  // The first member with a number not below `low`, which must be at most settled_extreme_.
  Members::iterator FirstFrom(double low);
  absl::StatusOr<bool> LevelOf(const Place& place, const Member& member, double extreme,
                               const sparql::RunOptions& run) const;

  const bool above_;
  const Dictionary& dictionary_;
  NumberComparer& comparer_;
  Members members_;
  // The first member with a number not below settled_extreme_, if known: the next extreme is usually near.
  std::optional<Members::iterator> settled_at_;
  absl::btree_set<std::pair<double, TermId>> numbers_;  // keys that are ordered by their double
  absl::btree_set<TermId>
      irregular_;  // other numeric keys (xsd:float, numbers too long for an id): tried one by one
  bool irregular_changed_ = false;
  double settled_extreme_;  // at the last Relevel
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_THRESHOLD_GROUP_H_
