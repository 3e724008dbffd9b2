// One maintenance run of docent:inferred: computes the change of the inferred facts from a change of the
// asserted facts and of the rules. Private to this folder; for the semantics see rule_engine.h. Made for one
// Update. Writer thread only.
//
// Strata are treated in order (as many as negation needs). Within a stratum:
//   1. Retract: each fact that rested on a lost triple (or on the absence of a triple that now exists) is
//      tested for another proof (proof_search.h). A fact without one is removed, and the facts that rested
//      on it are tested in turn.
//   2. Rederive: undecided facts return if a rule still makes them.
//   3. Add, in rounds: the triples that are new in a round are joined with all others by the rules that they
//      concern. New rules are evaluated whole. New schema rules come first; the other new rules are then
//      evaluated once, for the final axioms.
//
// Reports of checks are no facts for rules: they are collected, and enter or leave the graph at the end. The caller hides the
// existing ones from the writer's current().
//
// Equality is handled without rules (equality_classes.h). At the end of each round, new facts are written out
// under all names of their terms. A class that loses a pair is split into certainly equal parts, and the
// facts about its terms are tested (materialiser_equality.cc).
//
// Facts made by rules with negation are searched in the graph as it was before: the writer's own graph with
// the changes so far undone and then redone; the cost depends on the change, not on the graph.
#ifndef DOCENT_REASONER_RULES_MATERIALISER_H_
#define DOCENT_REASONER_RULES_MATERIALISER_H_

#include <array>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/base/limits.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/store/delta.h"
#include "graph/store/graph_writer.h"
#include "reasoner/matching/computed_terms.h"
#include "reasoner/rules/equality_classes.h"
#include "reasoner/rules/inconsistency.h"
#include "reasoner/rules/negation_order.h"
#include "reasoner/rules/proof_search.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent::rules {

class Materialiser {
 public:
  struct Context {
    GraphWriter& writer;
    SchemaIndex& schema;
    EqualityClasses& classes;  // of the graph before the change
    InconsistencyFacts& inconsistencies;
    const Dictionary& dictionary;
    TermId inferred_graph;
    const Limits& limits;
    size_t& inferred_so_far;  // quads inferred since the last Commit; updated here
    RuleEngine::Counters& counters;
    Cancellation* cancellation;  // null: none
    matching::ComputedTerms& computed;
  };

  // `before`: the rules of the current inferred graph; the same object as `program` if the rules did not
  // change.
  Materialiser(RuleProgram& program, RuleProgram& before, const Delta& told, const Context& context);

  absl::Status Maintain();
  // The net change of the inferred graph.
  Delta InferredChange() const;

 private:
  // A triple in the change of asserted facts.
  struct AssertedEntry {
    Triple triple;
    bool before = false;  // was asserted before
    bool now = false;
    bool inferred_before = false;
  };
  // A rule that is not positive, to evaluate with the seed of one of its triggers.
  struct Task {
    uint32_t rule;
    uint32_t trigger;
    Triple triple;
  };
  enum class Phase : uint8_t { kAdd, kTakeAway };
  // The rules that a new triple is matched with.
  enum class Scope : uint8_t {
    kAll,
    kStaying,         // not the new rules: they are evaluated whole
    kEnteringSchema,  // only the new rules about the schema
  };

  Quad InferredQuad(const Triple& t) const {
    return {t.subject, t.predicate, t.object, context_.inferred_graph};
  }
  const GraphVersion& graph() const { return context_.writer.current(); }
  sparql::RunOptions Now() const { return {.version = &graph(), .cancellation = context_.cancellation}; }
  bool IsInferred(const Triple& t) const { return graph().Contains(InferredQuad(t)); }
  bool IsPresent(const Triple& t) const {
    return graph().ContainsMatch({t.subject, t.predicate, t.object, TermId()});
  }

  void ReadAsserted();
  absl::Status SettleAsserted();
  absl::StatusOr<bool> PlaceNegation(AskAxioms ask);  // true if the order has changed
  absl::Status MaintainStratum();
  void TakeBackEarly();
  void CompareRules();
  void ToOldState();
  void ToNewState();
  // Collects the changes of all lower strata and of the asserted facts.
  void CollectChanges(int stratum);

  // materialiser_retract.cc
  absl::Status TakeAwayFromLeavingRules();
  absl::Status TakeAway(int stratum);
  absl::Status TakeAwayLost(int stratum);
  absl::Status EvaluateBefore(int stratum);
  absl::Status Propagate(int stratum);
  absl::Status Consider(const Triple& triple);
  void AddGhosts(int stratum);
  void RemoveMarked();
  absl::Status Rederive(int stratum);
  absl::StatusOr<bool> IsDerivable(const Triple& triple, int stratum);
  absl::Status RepeatChecks(int stratum);

  // materialiser_equality.cc
  bool HasOtherNames(const Triple& fact) const {
    const EqualityClasses& classes = context_.classes;
    return !classes.empty() &&
           (classes.Find(fact.subject) != nullptr || classes.Find(fact.predicate) != nullptr ||
            classes.Find(fact.object) != nullptr);
  }
  void BeginEquality();
  absl::Status WriteOutEquals();
  bool JoinNew();
  std::vector<Triple> FactsToWriteOut();
  template <typename Visit>
  bool ForEachOpenBlock(const Triple& fact, Visit visit);
  bool WriteOut(const Triple& fact);
  bool CanWriteOut(const Triple& fact);
  bool EmitEqual(const Triple& made);
  void CollectFactsWithOtherNames();
  absl::Status LoseEquals(const Triple& lost);
  void AskAboutEqual(const Triple& fact);
  absl::Status Doubt(const EqualityClasses::Class& doubted);
  void CollectFactsAbout(const EqualityClasses::Class& doubted);
  void SplitShrunk();
  absl::Status RederivePairs(int stratum);
  bool RederivePairsByName();
  absl::Status RederivePairsOf(const CompiledRule& rule, const HeadTriple& head,
                               const std::vector<TermId>* instance);
  bool IsWrittenOut(const Triple& fact);

  // materialiser_add.cc
  absl::Status Add(int stratum);
  absl::Status FirstRound(int stratum);
  absl::Status CloseSchema(int stratum);
  absl::Status DispatchRound(int stratum);
  absl::Status EndRound();
  bool InScope(uint32_t rule) const;
  // True if the running stratum may make, or test, a fact of an entangled rule. It tests only facts of its own stratum; the
  // first stratum also tests facts that the former axioms placed in a later one.
  bool MayMake(const CompiledRule& rule, const Triple& fact, Phase phase) const {
    if (program_.ordered.empty() || stratum_ < 0) return true;
    if (!program_.IsEntangled(static_cast<uint32_t>(&rule - program_.rules.data()))) return true;
    const int stratum = program_.StratumOf(fact);
    if (phase == Phase::kAdd) return stratum <= stratum_;
    return stratum == stratum_ || stratum_ == program_.first_entangled;
  }
  // The same for newly made facts; remembers a fact that belongs to a later stratum.
  bool MayEmit(const CompiledRule& rule, const Triple& triple, Phase phase);
  // Evaluates the rules of `stratum` for which `quad` is a positive match; their results go to Emit.
  // DispatchInstances: the rules with a schema part, by its solutions. DispatchRules: all others (and changes
  // of the schema itself).
  absl::Status DispatchInstances(const Quad& quad, int stratum, Phase phase);
  absl::Status DispatchRules(const Quad& quad, int stratum, Phase phase, bool also_negative);
  absl::Status FireWhole(RuleProgram& program, uint32_t rule, Phase phase);
  absl::Status FireInstances(uint32_t rule);
  absl::Status FireTask(const Task& task, Phase phase);
  // Evaluates a rule with `seed_`.
  absl::Status FireSeeded(uint32_t number, Phase phase);
  // False: end the evaluation.
  bool Emit(const CompiledRule& rule, absl::Span<const TermId> row, Phase phase);
  bool Count(const CompiledRule& rule);
  bool Collect(const CompiledRule& rule, const Triple& triple, Phase phase);
  // The same for a check and its report.
  bool EmitReport(const CompiledRule& check, absl::Span<const TermId> row, Phase phase);
  void WriteReports();
  bool TakeMade();
  bool DropPresent(const CompiledRule& rule);
  void NowInferred(const Triple& t);
  // Counts steps; CheckSteps reports too many of them, and names the rule.
  void Spend(uint64_t steps) {
    if (context_.cancellation != nullptr) context_.cancellation->Spend(steps);
  }
  absl::Status CheckSteps(const CompiledRule& rule) {
    return context_.cancellation == nullptr ? absl::OkStatus() : rule.Named(context_.cancellation->Check());
  }
  absl::Status LimitError(const CompiledRule& rule, const char* limit, size_t value) const;

  RuleProgram& program_;
  RuleProgram& before_;
  const Delta& asserted_delta_;
  const Context context_;
  ProofSearch proofs_;

  int stratum_ = -1;                     // the running one
  std::vector<AssertedEntry> asserted_;  // by triple
  std::vector<uint32_t> entering_;       // rules of program_ that are not in before_
  std::vector<bool> is_entering_;
  std::vector<uint32_t> leaving_;  // rules of before_ that are not in program_
  bool old_state_ = false;

  absl::flat_hash_set<Triple> removed_;                     // of the inferred graph, net
  std::vector<Triple> added_;                               // likewise
  absl::flat_hash_set<Triple> added_set_;                   // added_ at the beginning of the stratum
  absl::flat_hash_set<Triple> new_reports_, lost_reports_;  // facts of reports, net; in none of the above

  std::vector<Triple> lost_;            // for the running stratum: present before, not now
  std::vector<Triple> gained_;          // the opposite
  absl::flat_hash_set<Triple> marked_;  // removed in the running stratum, and ghosts
  std::vector<Triple> queue_;           // marked_, in order
  size_t ghosts_ = 0;                   // the first of queue_, which were removed before
  bool ghosts_in_graph_ = false;
  std::vector<Triple> rederivable_;        // in the running stratum and all later ones
  std::vector<Triple> unproven_;           // removed, but other facts may prove them again
  absl::flat_hash_set<Triple> postponed_;  // of rederivable_: removed, made again, and of a later stratum
  struct CheckRow {
    uint32_t rule;
    std::vector<TermId> row;
  };
  std::vector<CheckRow> check_rows_;  // solutions of checks that may no longer hold

  // Equality, if ClosesEquality(stratum_).
  std::vector<Triple> unwritten_;              // facts not yet written out under all names
  absl::flat_hash_set<Triple> unwritten_set_;  // those with other names
  bool are_unsettled_ = false;                 // equality is new: the existing classes are not written out
  std::vector<TermId> joined_;                 // members of classes that grew in this turn
  std::vector<EqualityClasses::Class> shrunk_classes_;  // classes that lost a pair, before the loss
  absl::flat_hash_set<TermId> shrunk_terms_;            // their members
  std::vector<TermId> reopened_;                        // terms whose pairs must be derived again
  absl::flat_hash_set<Triple> lost_names_;  // facts, under representatives, whose other names were tested
  absl::flat_hash_map<Triple, bool>
      is_written_out_;  // by the same key: true if the graph holds it under some name

  AxiomAnswers asked_;                // of all orders since the axioms exist
  std::vector<Triple> new_facts_;     // new in all rounds
  std::vector<Triple> round_;         // new in the last round
  std::vector<Triple> candidates_;    // for the next round
  absl::flat_hash_set<Triple> seen_;  // candidates of this stratum
  size_t compact_at_ = 0;
  absl::flat_hash_set<uint32_t> whole_;  // rules evaluated whole in this round
  Scope scope_ = Scope::kAll;
  uint32_t last_rule_ = 0;
  std::array<std::pair<Triple, const CompiledRule*>, 16>
      made_in_batch_;  // by rules, in kAdd; not examined yet
  size_t made_count_ = 0;
  std::vector<Triple> made_;  // likewise, in kTakeAway
  std::vector<Triple> scratch_;
  std::vector<TermId> seed_;
  absl::Status status_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_MATERIALISER_H_
