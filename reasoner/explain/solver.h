// Solver: finds how a clause holds on a graph version, or which facts would make it hold.
//
// In plain mode it enumerates the solutions of the clause, each with its supporting facts. In abductive mode
// (Kakas, Kowalski, Toni, Abductive Logic Programming, J. Logic Comput. 1992) a pattern without a match may
// be taken as a missing fact, directly or through a rule whose body would give it. Absences are then left to
// the caller: each is listed with the solution, held or not (reasoner/explain/conflict.h searches the
// conflicts of those that do not hold). Patterns are treated in the order of their exact counts, so the
// search begins with rare facts.
//
// One thread. Works beside the writer: it reads an immutable version and a dictionary of the caller's own.
#ifndef DOCENT_REASONER_EXPLAIN_SOLVER_H_
#define DOCENT_REASONER_EXPLAIN_SOLVER_H_

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/condition_form.h"
#include "reasoner/explain/rule_base.h"

namespace docent::explain {

// A missing fact. A position that may have any value is an open variable; equal numbers mean the same
// variable.
struct MissingFact {
  static constexpr int kBound = -1;
  std::array<TermId, 4> terms;  // subject, predicate, object, graph (kNone: any)
  std::array<int, 4> open = {kBound, kBound, kBound, kBound};

  friend bool operator==(const MissingFact&, const MissingFact&) = default;
  friend auto operator<=>(const MissingFact&, const MissingFact&) = default;
};

// Values of the variables of a clause in a solution: the clause of the question, or of a rule.
struct Row {
  const Clause* clause = nullptr;
  std::vector<TermId> values;  // kNone: open
  std::vector<int> open;       // number of the open variable; MissingFact::kBound
};

// A filter with unbound variables.
struct OpenTest {
  const Test* test = nullptr;
  Row row;
};

// An absence of a clause, with the values of the clause's variables.
struct AbsenceOf {
  const Absence* absence = nullptr;
  Row row;
  bool open = false;  // some variables that it shares with the clause are unbound
};

// A rule that would infer a missing fact.
struct Inference {
  uint32_t rule = 0;
  MissingFact fact;

  friend bool operator==(const Inference&, const Inference&) = default;
};

struct Solution {
  Row row;
  std::vector<Quad>
      facts;  // matches of the atoms of the clause and of inference bodies; graph: kNone if any will do
  std::vector<MissingFact> missing;
  std::vector<OpenTest> tests;
  std::vector<AbsenceOf> absences;  // abductive: of the clause and of inference bodies, held or not
  std::vector<Inference> inferences;
  // Name of an open variable in the query or rule; empty: it has no name.
  absl::flat_hash_map<int, std::string> names;
};

// The values that `clause`, an alternative of an absence, takes from the enclosing clause.
std::vector<TermId> SeedOf(const Clause& clause, const Row& outer);

struct SolveOptions {
  // Otherwise absences must hold and no fact may be missing.
  bool abductive = false;
  // The exact number of missing facts.
  int missing = 0;
  // Null: only direct facts.
  const RuleBase* rules = nullptr;
  int rule_depth = 4;
  // Also take facts as missing that only rules make.
  bool tell_derived = false;
  // Also take axioms in rule bodies as missing: one axiom would make many facts true.
  bool tell_schema = false;
};

class Solver {
 public:
  // All arguments must outlive the solver. `steps`: its total amount of work.
  Solver(const GraphVersion& version, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
         const sparql::RunOptions& run, size_t steps);
  ~Solver();

  // Calls `visit` with each solution that agrees with `seed` (by the clause's variables; empty: no binding),
  // until it returns false. The same solution may come more than once. CANCELLED or DEADLINE_EXCEEDED. Not
  // re-entrant.
  absl::Status Solve(const Clause& clause, absl::Span<const TermId> seed, const SolveOptions& options,
                     absl::FunctionRef<bool(const Solution&)> visit);
  // The steps are used up: there may be further solutions.
  bool exhausted() const { return exhausted_; }
  size_t steps() const { return steps_; }
  // Counts work done elsewhere for the same question.
  void Spend(size_t steps) {
    steps_ += steps;
    exhausted_ = exhausted_ || steps_ > step_limit_;
  }
  // Allows the same number of steps again.
  void Refresh() {
    steps_ = 0;
    exhausted_ = false;
  }
  // A fact of the schema was not taken as missing because SolveOptions::tell_schema is false.
  bool schema_skipped() const { return schema_skipped_; }
  // The last Solve met patterns that it could not take as missing because of SolveOptions::missing.
  bool missing_limit_reached() const { return missing_limit_reached_; }
  // A rule was not followed: it might use a fact already missing, or is deeper than SolveOptions::rule_depth.
  bool rules_skipped() const { return rules_skipped_; }
  // The last Solve, in abductive mode, met a part: its facts were not taken as missing (0: no such part, 1),
  // or at most one of them (2: a path with a gap).
  int missing_in_parts() const { return missing_in_parts_; }
  // A part without a solution although everything before it held; null: none.
  const Part* failed_part() const { return failed_part_; }

  // True if the filter passes with these values of its clause's variables.
  bool Holds(const OpenTest& test, absl::Span<const TermId> values);

 private:
  struct Frame {
    const Clause* clause;
    int base;    // index of its first variable among the cells
    int parent;  // the goal that it would infer; -1: none
    int depth;   // number of rules above it
    uint32_t rule;
  };
  struct Goal {
    int frame;
    const Atom* atom;
    int chain;  // the goal that this goal's rule would infer; -1
    bool done = false;
    Quad match;  // if done by a fact
    bool matched = false;
  };
  struct Pending {
    enum class Kind : uint8_t { kTest, kAssignment, kTable, kPart } kind;
    int frame;
    size_t index;
    bool done = false;
  };
  struct Undo {
    enum class Kind : uint8_t { kValue, kLink, kGoal, kPending } kind;
    int index;
  };

  int Root(int cell) const;
  TermId Value(int cell) const { return values_[Root(cell)]; }
  TermId TermOf(const AtomTerm& term, int base) const;
  bool Bind(int cell, TermId value);
  bool Alias(int a, int b);
  bool Unify(const AtomTerm& a, int a_base, const AtomTerm& b, int b_base);
  bool BindQuad(const Atom& atom, int base, const Quad& quad);
  size_t Mark() const { return trail_.size(); }
  void Rewind(size_t mark);
  QuadPattern PatternOf(const Goal& goal) const;

  void PushFrame(const Clause& clause, int parent, int depth, uint32_t rule);
  void PopFrame();
  bool Step();
  bool StepAtom(int goal);
  bool TryMatches(int goal);
  bool TryRules(int goal, bool room);
  bool TryMissing(int goal);
  bool TryMissingAlready(int goal);
  bool TryTable(int pending);
  bool TryPart(int pending);
  bool IsReached(const Pending& pending) const;
  bool Settle();
  bool SettleOne(Pending& pending, bool& changed);
  // `values`: in the order of Test::variables.
  bool Holds(const Test& test, const Clause& clause, absl::Span<const TermId> values);
  bool Leaf();
  bool IsTellable(const Goal& goal) const;
  bool MayServe(uint32_t clause);
  bool RestsOn(uint32_t clause, TermId predicate);
  bool IsGivenAxiom(const Goal& goal) const;
  bool IsInOwnChain(int goal) const;
  MissingFact FactOf(const Atom& atom, int base) const;
  Row RowOf(const Frame& frame) const;
  std::vector<AbsenceOf> Absences() const;
  bool IsMatched(const AbsenceOf& of);
  absl::StatusOr<std::vector<std::vector<TermId>>> RowsOf(const Part& part, int base);
  sparql::PreparedExpression* Prepared(const sparql::Expression& e, const std::vector<std::string>& names);

  const GraphVersion& version_;
  Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  const sparql::RunOptions run_;
  const size_t step_limit_;
  size_t steps_ = 0;
  bool exhausted_ = false;
  bool schema_skipped_ = false;
  absl::Status status_;
  const Part* failed_part_ = nullptr;
  absl::flat_hash_map<const sparql::Expression*, std::unique_ptr<sparql::PreparedExpression>> expressions_;
  absl::flat_hash_map<std::string, std::unique_ptr<sparql::PreparedQuery>> parts_;
  std::unique_ptr<Solver> inner_;  // for absences

  // of the running Solve
  SolveOptions options_;
  const absl::FunctionRef<bool(const Solution&)>* visit_ = nullptr;
  std::vector<TermId> values_;
  std::vector<int> links_;
  std::vector<Frame> frames_;
  std::vector<Goal> goals_;
  std::vector<Pending> pending_;
  std::vector<Undo> trail_;
  std::vector<int> missing_;                                   // goals
  absl::flat_hash_map<TermId, std::vector<bool>> resting_on_;  // RuleBase::RestingOn, as asked so far
  bool missing_limit_reached_ = false;
  bool rules_skipped_ = false;
  int missing_in_parts_ = 0;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_SOLVER_H_
