// Why a condition does not hold: the nearest partial matches, and the smallest sets of facts that would have to be
// told (or withdrawn) for it to hold, rules considered.
//
// A set is what a partial match of the condition lacks, and a smallest hitting set of the conflicts of its absences
// (reasoner/explain/conflict.h). Sets are looked for in the order of their size, and each is tried on a copy of the graph
// with the rules applied: it makes the condition true, and no proper subset of it does. What may be anything (a fact with
// an open variable) is tried with an example. Sets that would change what a thing is (rdf:type told, or withdrawn though
// only a rule asks for it) are named only where no set as small changes less of that; axioms (of classes, properties,
// equality) that a rule asks for only where no set of facts about things does it, of any size.
#ifndef DOCENT_REASONER_EXPLAIN_WHY_NOT_H_
#define DOCENT_REASONER_EXPLAIN_WHY_NOT_H_

#include <algorithm>
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
  bool holds = false;  // nothing to explain
  // Best first: facts about things before axioms, fewest changes, then changes of state before changes of kind.
  std::vector<Repair> repairs;
  size_t more = 0;  // sets as small as the last one that are not listed
  // False: not all sets of this size or a smaller one were looked at (without any set: not all sets), as the search
  // ended at a limit or met what it does not understand (a sum).
  bool whole = true;
  std::string failed_part;  // a path, aggregate or sub-SELECT that has no solution; empty: none known
};

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
    TermId default_graph;  // none: union
    std::vector<std::pair<std::string, std::string>> prefixes;
  };
  explicit WhyNotFinder(Parts parts);

  // `ask` does not hold on the version. At most `sets` repairs.
  absl::StatusOr<WhyNotAnswer> Find(const sparql::Query& ask, size_t sets);

 private:
  // What may be told besides facts that people tell, about things.
  struct Pass {
    bool tell_derived, tell_schema;
  };
  // A partial match, which a search for hitting sets begins with.
  struct Root {
    size_t alternative = 0;  // of the condition
    std::vector<AbsenceOf> absences;
    Examples examples;
    OpenNames names;
    std::vector<Conflict> conflicts;  // those found that last
  };
  // A set of changes: what the match of the root lacks, and ways to break conflicts.
  struct Node {
    size_t root = 0;
    Repair repair;
  };
  struct Trial {
    bool holds = false;
    std::vector<Conflict> conflicts;  // else
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
  // False: there was no time to make sure.
  absl::StatusOr<bool> Minimise(Repair& repair);
  // Half of the question's time is over: what was found is given.
  bool OutOfTime() const {
    return parts_.run.cancellation != nullptr && parts_.run.cancellation->HalfIsOver();
  }
  bool IsNew(const Repair& repair);
  void Rank(std::vector<Node>& nodes) const;
  bool IsState(const Term& predicate) const;
  SolveOptions Telling() const;
  // Sets of this size, or of more, were not all looked at.
  void LeaveOut(int size) { left_out_ = std::min(left_out_, size); }

  const Parts parts_;
  const Display display_;
  Solver solver_;
  std::unique_ptr<sparql::PreparedQuery> ask_;
  std::vector<Clause> clauses_;
  int left_out_ = Conflict::kNothing;
  bool spared_schema_ = false;
  absl::flat_hash_set<std::string> seen_;  // sets found

  // of the running pass
  Pass pass_{};
  std::vector<Root> roots_;
  std::vector<std::vector<Node>> nodes_;  // by size
  absl::flat_hash_set<std::string> pushed_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_WHY_NOT_H_
