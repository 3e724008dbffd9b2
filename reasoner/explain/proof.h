// Proof of a fact: its assertion, or the rule and the facts from which it follows, down to asserted facts.
//
// Proofs are searched on demand, from the rules backward, on one immutable version. A proof is well-founded:
// no fact rests on itself. Each step has a proof of minimum depth, if the search for it ends within
// explain_steps; else any proof is searched (proof_goals.cc). (Facts inferred for the version always have a
// proof.)
#ifndef DOCENT_REASONER_EXPLAIN_PROOF_H_
#define DOCENT_REASONER_EXPLAIN_PROOF_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "graph/base/explain_limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "reasoner/explain/equal_ways.h"
#include "reasoner/explain/part_facts.h"
#include "reasoner/explain/report_origins.h"
#include "reasoner/explain/rule_base.h"
#include "reasoner/explain/solver.h"
#include "reasoner/rules/inconsistency.h"

namespace docent::explain {

// One assertion of a fact.
struct Told {
  Term graph;  // the named graph that holds it: its source; empty: only `by` names it ("in hall.ttl:3:5")
  uint64_t offset = 0;     // of the log record that asserted it last; 0: unknown
  TimeMicros time_us = 0;  // time of the assertion
  std::string by;          // "reading of <sensor>", "ontology world.ttl", …; empty: a plain fact
};

// A fact with its justification.
struct ProofStep {
  TermQuad fact;                                       // without graph
  std::vector<Told> told;                              // empty: inferred
  std::string rule;                                    // inferred: "guide.rules rule 1 (line 5)"
  std::vector<std::pair<std::string, Term>> bindings;  // of the rule's variables, in its order
  std::vector<size_t> premises;                        // indexes in Proof::steps, in the rule's order
  std::vector<std::string> conditions;                 // filters and absences that hold, as SPARQL
  size_t depth = 0;                                    // 0: told
};

// Each fact is in it once, however many steps rest on it.
struct Proof {
  std::vector<ProofStep> steps;
  std::vector<size_t> roots;                           // the facts in question
  std::vector<std::pair<std::string, Term>> bindings;  // of an ASK: its variables
  std::vector<std::string> conditions;                 // of an ASK: its filters and absences
};

// The leaves of a proof.
struct Support {
  std::vector<Quad> told;           // without graph
  std::vector<AbsenceOf> absences;  // of the rules applied
  bool whole = true;                // false: also rests on aggregates, or on facts made by unknown rules
};

class Prover {
 public:
  Prover(const GraphVersion& version, Dictionary& dictionary, const RuleBase& rules,
         const sparql::FunctionRegistry* functions, const sparql::RunOptions& run,
         const ExplainLimits& limits, std::vector<std::pair<std::string, std::string>> prefixes);

  // Adds the fact and its proof. nullopt: the version does not hold it. RESOURCE_EXHAUSTED: the limits
  // proof_steps or explain_facts.
  absl::StatusOr<std::optional<size_t>> Add(const Quad& fact, Proof& proof);
  // The leaves of the fact's proof of minimum depth. RESOURCE_EXHAUSTED: the limit explain_steps.
  absl::StatusOr<Support> SupportOf(const Quad& fact);
  // Further support of a solution, apart from the matches of its patterns.
  struct FurtherSupport {
    std::vector<Quad> facts;              // of paths, aggregates, LIMITs; graph: kNone if any will do
    std::vector<std::string> conditions;  // these parts, filters and absences, as SPARQL
    bool whole = true;                    // as Ground::whole, for each
  };
  absl::StatusOr<FurtherSupport> FurtherSupportOf(const Row& row);
  // Work done so far: matches, and places of paths.
  size_t steps() const {
    return solver_.steps() + part_facts_.steps() + rule_parts_.steps() +
           (of_goals_ == nullptr ? 0 : of_goals_->steps());
  }

 private:
  // A rule that may make a fact, with the variables bound by the fact.
  struct Maker {
    uint32_t clause;
    std::vector<TermId> seed;
  };
  // A way to infer a fact.
  struct Derivation {
    uint32_t clause;
    Row row;
    std::vector<Quad> facts;  // premises, also those of the parts of its body
    bool whole = true;        // as FurtherSupport::whole
  };
  struct Known {
    int proven = -1;       // minimum depth of a proof
    int refuted = -1;      // there is no proof up to this depth
    size_t best = 0;       // the derivation of that proof
    bool derived = false;  // `derivations` were searched
    std::vector<Derivation> derivations;
  };

  static constexpr size_t kDerivationsLooked = 2000;  // tried for one fact
  // True once no further derivation is looked for.
  using Enough = absl::FunctionRef<bool(const std::vector<Derivation>& found)>;
  class Goals;  // proof_goals.cc

  std::vector<Quad> ToldQuads(const Quad& fact) const;
  Known& KnownOf(const Quad& fact);  // its address is stable
  absl::StatusOr<std::vector<Maker>> MakersOf(const Quad& fact);
  absl::Status Derive(const Quad& fact, Enough enough, std::vector<Derivation>& found);
  absl::Status DeriveBy(const std::vector<Maker>& makers, const Quad& fact, Enough enough,
                        std::vector<Derivation>& found);
  // proof_equality.cc: one derivation for each rule of equality. True if there is one.
  absl::StatusOr<bool> DeriveEqual(const Quad& fact, std::vector<Derivation>& found);
  absl::StatusOr<bool> DerivePair(const Quad& pair, std::vector<Derivation>& found);
  void AddEqual(rules::EqualityRule rule, const std::vector<std::pair<const char*, TermId>>& values,
                const std::vector<Quad>& facts, std::vector<Derivation>& found);
  absl::StatusOr<bool> ConnectByRules(TermId term);
  std::optional<Quad> ToldUnderOtherNames(const Quad& fact);
  absl::Status TooManySteps() const;
  absl::StatusOr<bool> Prove(const Quad& fact, int depth);
  absl::Status Prove(const Quad& fact);
  absl::Status ProveByGoals(const Quad& fact);
  absl::StatusOr<size_t> Write(const Quad& fact, Proof& proof, absl::flat_hash_map<Quad, size_t>& placed);
  absl::StatusOr<const Derivation*> WriteStep(const Quad& fact, ProofStep& step);

  absl::StatusOr<FurtherSupport> FurtherSupportOf(const Row& row, PartFacts& parts);

  Solver& solver() { return of_goals_ == nullptr ? solver_ : *of_goals_; }

  const GraphVersion& version_;
  Dictionary& dictionary_;
  const RuleBase& rules_;
  const sparql::FunctionRegistry* const functions_;
  rules::InconsistencyFacts reports_of_checks_;
  const GraphVersionPtr seen_by_rules_;  // version_ without these
  const sparql::RunOptions rule_run_;    // on that
  const ExplainLimits limits_;
  const TermId inferred_;
  const std::vector<std::pair<std::string, std::string>> prefixes_;
  ReportOrigins reports_;
  Solver solver_;                     // of rule bodies
  std::unique_ptr<Solver> of_goals_;  // takes the place of solver_ once that is exhausted
  PartFacts part_facts_;
  PartFacts rule_parts_;  // of rule bodies
  const TermId same_as_;
  EqualWays ways_;
  absl::flat_hash_set<TermId> connected_;  // terms whose pairs from other rules are in ways_
  size_t calls_ = 0;
  size_t proven_ = 0;
  absl::flat_hash_map<Quad, std::unique_ptr<Known>> known_;  // without graph
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_PROOF_H_
