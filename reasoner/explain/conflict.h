// Conflicts: matches that keep an absence from holding, and the changes that would break them.
//
// A conflict is one match of what must not be there, with all ways to make just this match go: a told fact under it
// withdrawn, be it one of its facts or one that they are inferred from; or facts told that an absence in it, or in a
// rule on the way, forbids. A set of changes that makes the absence hold has one of the ways of each conflict: it is a
// hitting set (Reiter, A Theory of Diagnosis from First Principles, Artificial Intelligence 32, 1987). Conflicts are
// looked for one by one, on the graph as it would be with the changes so far: a fact with two derivations has two.
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

  std::vector<Repair> ways;  // what each tells or withdraws, and how that is shown
  bool lasts = true;  // whatever else is told or withdrawn, the match stays until one of the ways is taken
  int left_out = kNothing;     // ways of so many changes, or of more, were not looked for
  bool spared_schema = false;  // axioms that a rule asks for were not taken as ways

  // Whether `repair` has one of the ways.
  bool IsHitBy(const Repair& repair) const;
};

// Adds what `way` tells and withdraws to what `repair` does. False: nothing new.
bool Join(const Repair& way, Repair& repair);

class ConflictFinder {
 public:
  struct Parts {
    const GraphVersion* base = nullptr;   // its told facts may be withdrawn
    const GraphVersion* graph = nullptr;  // where conflicts are looked for: `base`, or as that would be
    Dictionary* dictionary = nullptr;
    Prover* prover = nullptr;  // on `graph`
    const sparql::FunctionRegistry* functions = nullptr;
    sparql::RunOptions run;  // on `graph`
    const Display* display = nullptr;
    SolveOptions telling;  // what may be told: `missing` is not looked at
    int room = 0;          // changes of a way, at most
    size_t steps = 0;
  };
  explicit ConflictFinder(const Parts& parts);

  // At most `most` conflicts of these absences, open variables being what `examples` says and called as `names` says.
  // Empty: all of them hold. CANCELLED, DEADLINE_EXCEEDED.
  absl::StatusOr<std::vector<Conflict>> Find(const std::vector<AbsenceOf>& absences, const Examples& examples,
                                             const OpenNames& names, size_t most);
  size_t steps() const { return solver_.steps(); }

 private:
  // One solution of what must not be there.
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
