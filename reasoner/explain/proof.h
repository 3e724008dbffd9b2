// Why a fact holds: who told it, or by which rule and from which facts it follows, down to what was told.
//
// Proofs are looked for on demand, from the rules backward, on one immutable version. A proof is well-founded: no
// fact rests on itself, and each step is shown with a proof of the smallest depth. (Facts that were inferred when the
// version was made always have one.)
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

namespace docent::explain {

// One telling of a fact.
struct Told {
  Term graph;  // the named graph that holds it: its source; empty: `by` alone says it ("in hall.ttl:3:5")
  uint64_t offset = 0;     // of the log record that told it last; 0: not looked up or not found
  TimeMicros time_us = 0;  // when
  std::string by;          // "reading of <sensor>", "ontology world.ttl", …; empty: a plain fact
};

// A fact with what it rests on.
struct ProofStep {
  TermQuad fact;                                       // without graph
  std::vector<Told> told;                              // empty: inferred
  std::string rule;                                    // inferred: "guide.rules rule 1 (line 5)"
  std::vector<std::pair<std::string, Term>> bindings;  // of the rule's variables, in its order
  std::vector<size_t> premises;                        // indexes in Proof::steps, in the rule's order
  std::vector<std::string> conditions;                 // filters and absences that hold, as SPARQL
  size_t depth = 0;                                    // 0: told
};

// A fact stands in it once, however many steps rest on it.
struct Proof {
  std::vector<ProofStep> steps;
  std::vector<size_t> roots;                           // what was asked for
  std::vector<std::pair<std::string, Term>> bindings;  // of an ASK: its variables
  std::vector<std::string> conditions;                 // of an ASK: its filters and absences
};

// The leaves of a proof.
struct Support {
  std::vector<Quad> told;           // without graph
  std::vector<AbsenceOf> absences;  // of the rules applied
  bool whole = true;  // false: also on aggregates, or on what rules made that are not known here
};

class Prover {
 public:
  Prover(const GraphVersion& version, Dictionary& dictionary, const RuleBase& rules,
         const sparql::FunctionRegistry* functions, const sparql::RunOptions& run,
         const ExplainLimits& limits, std::vector<std::pair<std::string, std::string>> prefixes);

  // Adds the fact and what it rests on. nullopt: the version does not hold it. RESOURCE_EXHAUSTED: the limits
  // explain_steps or explain_facts.
  absl::StatusOr<std::optional<size_t>> Add(const Quad& fact, Proof& proof);
  // What the fact's proof rests on in the end. Errors as of Add.
  absl::StatusOr<Support> SupportOf(const Quad& fact);
  // What a solution rests on besides the matches of its patterns.
  struct Besides {
    std::vector<Quad> facts;              // of paths, aggregates, LIMITs; graph: none where any will do
    std::vector<std::string> conditions;  // these, filters and absences, as SPARQL
    bool whole = true;                    // as Ground::whole, for each
  };
  absl::StatusOr<Besides> BesidesOf(const Row& row);
  // What it did so far: matches, and places of paths.
  size_t steps() const { return solver_.steps() + part_facts_.steps(); }

 private:
  // A rule that may make a fact, with the values of its variables that the fact gives.
  struct Maker {
    uint32_t clause;
    std::vector<TermId> seed;
  };
  // A way to infer a fact.
  struct Derivation {
    uint32_t clause;
    Row row;
    std::vector<Quad> facts;  // those of the parts of its body, too
    bool whole = true;        // as Besides::whole
  };
  struct Known {
    int proven = -1;       // the smallest depth of a proof
    int refuted = -1;      // there is none up to this depth
    size_t best = 0;       // the derivation of that proof
    bool derived = false;  // whether `derivations` were looked for
    std::vector<Derivation> derivations;
  };

  std::vector<Quad> ToldQuads(const Quad& fact) const;
  absl::StatusOr<std::vector<Maker>> MakersOf(const Quad& fact);
  absl::Status Derive(const Quad& fact, Known& known);
  absl::Status DeriveBy(const std::vector<Maker>& makers, const Quad& fact, Known& known);
  // proof_equality.cc: by the rules of equality, one way each. Whether there is one.
  absl::StatusOr<bool> DeriveEqual(const Quad& fact, Known& known);
  absl::StatusOr<bool> DerivePair(const Quad& pair, Known& known);
  void AddEqual(rules::EqualityRule rule, const std::vector<std::pair<const char*, TermId>>& values,
                const std::vector<Quad>& facts, Known& known);
  absl::StatusOr<bool> ConnectByRules(TermId term);
  std::optional<Quad> ToldUnderOtherNames(const Quad& fact);
  absl::StatusOr<bool> Prove(const Quad& fact, int depth);
  absl::Status Prove(const Quad& fact);
  absl::StatusOr<size_t> Write(const Quad& fact, Proof& proof, absl::flat_hash_map<Quad, size_t>& placed);

  const GraphVersion& version_;
  Dictionary& dictionary_;
  const RuleBase& rules_;
  const ExplainLimits limits_;
  const TermId inferred_;
  const std::vector<std::pair<std::string, std::string>> prefixes_;
  ReportOrigins reports_;
  Solver solver_;
  PartFacts part_facts_;
  const TermId same_as_;
  EqualWays ways_;
  absl::flat_hash_set<TermId> connected_;  // terms whose pairs by other rules ways_ has
  size_t calls_ = 0;
  size_t proven_ = 0;
  absl::flat_hash_map<Quad, std::unique_ptr<Known>> known_;  // without graph
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_PROOF_H_
