// Conflicts: matches that keep an absence from holding, and the changes that would break them.
//
// A conflict is one match of a forbidden pattern, with all ways to break just this match. A way withdraws an
// asserted fact (one of the match's facts, or one from which they are inferred), or asserts facts that an
// absence in the match, or in a rule on the way, forbids. A set of changes makes the absence hold if it
// contains one way of each conflict: it is a hitting set (Reiter, A Theory of Diagnosis from First
// Principles, Artificial Intelligence 32, 1987). Conflicts are searched one by one, on the graph with the
// changes so far: a fact with two derivations gives two conflicts.
//
// One thread.
#ifndef DOCENT_REASONER_EXPLAIN_CONFLICT_H_
#define DOCENT_REASONER_EXPLAIN_CONFLICT_H_

#include <limits>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/display.h"
#include "reasoner/explain/proof.h"
#include "reasoner/explain/repair.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

struct Conflict {
  static constexpr int kNothing = std::numeric_limits<int>::max();

  std::vector<Repair> ways;     // the changes of each, and their display form
  bool lasts = true;            // only one of the ways can break the match, whatever other changes are made
  int left_out = kNothing;      // ways with this many changes, or more, were not searched
  bool schema_skipped = false;  // axioms in rule bodies were not used as ways

  // True if `repair` contains one of the ways.
  bool IsHitBy(const Repair& repair) const;
};

// Adds the changes of `way` to `repair`. False: nothing new.
bool Join(const Repair& way, Repair& repair);

class ConflictFinder {
 public:
  struct Parts {
    const GraphVersion* base = nullptr;   // its asserted facts may be withdrawn
    const GraphVersion* graph = nullptr;  // where conflicts are searched: `base`, or `base` with changes
    Dictionary* dictionary = nullptr;
    Prover* prover = nullptr;  // on `graph`
    const sparql::FunctionRegistry* functions = nullptr;
    sparql::RunOptions run;  // on `graph`
    const Display* display = nullptr;
    SolveOptions telling;  // which facts may be asserted; `missing` is ignored
    int room = 0;          // maximum changes of a way
    size_t steps = 0;
  };
  explicit ConflictFinder(const Parts& parts);

  // At most `most` conflicts of these absences; open variables have the values in `examples` and the names in
  // `names`. Empty: all absences hold. CANCELLED, DEADLINE_EXCEEDED.
  absl::StatusOr<std::vector<Conflict>> Find(const std::vector<AbsenceOf>& absences, const Examples& examples,
                                             const OpenNames& names, size_t most);
  size_t steps() const { return solver_.steps(); }

 private:
  // One solution of a forbidden pattern.
  struct Match {
    const AbsenceOf* of = nullptr;
    Row row;
    std::vector<Quad> facts;
  };

  absl::StatusOr<std::vector<Match>> MatchesOf(const std::vector<AbsenceOf>& absences, size_t most);
  absl::Status Break(const Match& match, const std::string& absence, int depth, Conflict& conflict);
  absl::Status Fill(const AbsenceOf& of, const std::string& absence, int depth, Conflict& conflict);
  void Withdraw(const Quad& told, const Quad& fact, const std::string& absence, Conflict& conflict);

  const Parts parts_;
  Solver solver_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_CONFLICT_H_
