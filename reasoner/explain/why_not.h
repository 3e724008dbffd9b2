// Explanation of a condition that does not hold: the nearest partial matches, and the smallest sets of facts
// to assert (or withdraw) to make it hold, with the rules applied.
//
// A set consists of the missing facts of a partial match of the condition, and a smallest hitting set of the
// conflicts of its absences (reasoner/explain/conflict.h). Sets are searched in order of size. Each is tried
// on a copy of the graph with the rules applied: it makes the condition true, and no proper subset of it
// does. A fact with an open variable is tried with an example value. Sets that change the type of a thing
// (rdf:type asserted, or withdrawn only because of a rule) are listed only if no set of the same size changes
// fewer types; axioms (of classes, properties, equality) used by a rule only if no set of facts about things,
// of any size, is enough: not even the facts as the condition says them, which are tried alone where the search through
// rules found none before it ended. Sets that cannot be are left out: those that give a property more values than it has at a
// time (possible_values.h), and those that the caller forbids (shapes).
#ifndef DOCENT_REASONER_EXPLAIN_WHY_NOT_H_
#define DOCENT_REASONER_EXPLAIN_WHY_NOT_H_

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "graph/base/explain_limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/explain/conflict.h"
#include "reasoner/explain/display.h"
#include "reasoner/explain/hypothesis.h"
#include "reasoner/explain/proof.h"
#include "reasoner/explain/repair.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

struct WhyNotAnswer {
  bool holds = false;  // there is nothing to explain
  // Best first: facts about things before axioms, fewest changes, then changes of state before changes of
  // type.
  std::vector<Repair> repairs;
  size_t more = 0;  // number of sets as small as the last one that are not listed
  // False: some sets of this size or smaller were not tried (if there is no set: of any size), because the
  // search ended at a limit or met a construct that it does not support (a sum).
  bool whole = true;
  std::string failed_part;  // a path, aggregate or sub-SELECT without a solution; empty: none known
  size_t forbidden = 0;     // sets that would be enough, and that cannot be
};

// Whether changes may be made. INVALID_ARGUMENT, RESOURCE_EXHAUSTED and others: it is not known, and the question ends.
using MayChange = std::function<absl::StatusOr<bool>(const std::vector<TermQuad>& add,
                                                     const std::vector<TermQuad>& remove)>;

class WhyNotFinder {
 public:
  struct Parts {
    const GraphVersion* version = nullptr;
    Dictionary* dictionary = nullptr;
    const RuleBase* rules = nullptr;
    Hypothesis* hypothesis = nullptr;
    Prover* prover = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    sparql::RunOptions run;
    ExplainLimits limits;
    MayChange may_change;  // null: all may be made
    TermId default_graph;  // none: union
    std::vector<std::pair<std::string, std::string>> prefixes;
  };
  explicit WhyNotFinder(Parts parts);

  // Requires that `ask` does not hold on the version. At most `sets` repairs.
  absl::StatusOr<WhyNotAnswer> Find(const sparql::Query& ask, size_t sets);

 private:
  // Facts that may be asserted in addition to those that people assert about things.
  struct Pass {
    bool tell_derived, tell_schema;
    bool direct = false;  // as the condition says it, without rules
  };
  // A partial match, the start of a search for hitting sets.
  struct Root {
    size_t alternative = 0;  // of the condition
    std::vector<AbsenceOf> absences;
    Examples examples;
    OpenNames names;
    std::vector<Conflict> conflicts;  // the lasting ones found
  };
  // A set of changes: the missing facts of the root's match, and ways to break conflicts.
  struct Node {
    size_t root = 0;
    Repair repair;
  };
  struct Trial {
    bool holds = false;
    std::vector<Conflict> conflicts;  // the others
  };

  absl::Status Search(const Pass& pass, size_t sets, WhyNotAnswer& answer);
  absl::Status SearchSize(int size, size_t sets, WhyNotAnswer& answer);
  absl::Status Gather(const Clause& clause, int missing);
  absl::Status Plant(const Solution& solution);
  absl::Status Visit(const Node& node, bool expand, std::vector<Repair>& found);
  void Expand(const Node& node, const std::vector<Conflict>& conflicts);
  void Expand(const Node& node, const Conflict& conflict);
  void Push(Node node);
  const Conflict* Unhit(const Node& node) const;
  int AtLeast(const Node& node) const;
  absl::StatusOr<Trial> Try(const Node& node);
  absl::StatusOr<std::vector<Conflict>> ConflictsOn(const GraphVersion& graph, Prover& prover,
                                                    const Node& node);
  absl::StatusOr<bool> MakesTrue(const std::vector<Quad>& add, const std::vector<Quad>& remove);
  absl::StatusOr<bool> MayBe(const Repair& repair) const;
  // False: no time was left to verify it.
  absl::StatusOr<bool> Minimise(Repair& repair);
  // True after half of the question's time or steps: then the sets found so far are returned.
  bool OutOfTime() const {
    const Cancellation* cancellation = parts_.run.cancellation;
    return cancellation != nullptr &&
           (cancellation->HalfIsOver() || cancellation->steps_left() < steps_kept_);
  }
  bool IsNew(const Repair& repair);
  void Rank(std::vector<Node>& nodes) const;
  bool IsState(const Term& predicate) const;
  SolveOptions Telling() const;
  // Records that some sets of this size, or of a larger one, were not tried.
  void LeaveOut(int size) { left_out_ = std::min(left_out_, size); }

  const Parts parts_;
  const int64_t steps_kept_;  // half of the question's steps
  const Display display_;
  Solver solver_;
  std::unique_ptr<sparql::PreparedQuery> ask_;
  std::vector<Clause> clauses_;
  int left_out_ = Conflict::kNothing;
  size_t forbidden_ = 0;
  bool schema_skipped_ = false;
  absl::flat_hash_set<std::string> seen_;  // sets found

  // of the running pass
  Pass pass_{};
  std::vector<Root> roots_;
  std::vector<std::vector<Node>> nodes_;  // by size
  absl::flat_hash_set<std::string> pushed_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_WHY_NOT_H_
