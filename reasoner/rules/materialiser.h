// One maintenance of docent:inferred: from a change of the told facts, and of the rules, to a change of the
// inferred facts. Private to this folder; the semantics stand in rule_engine.h. Made for one Update. Writer
// thread only.
//
// Strata are treated in order (there are as many as negation needs); within one:
//   1. take away: what rested on a lost triple (or on the absence of one that is there now) is asked for
//   another
//      proof (proof_search.h); what has none goes, and what rested on it is asked in its turn
//   2. what was too far to tell comes back if a rule still makes it
//   3. add: in rounds, the triples that are new in a round are joined with all others by the rules that they
//   concern. Rules that are new are evaluated whole; those of the schema before the others, which are then
//   evaluated for the axioms as they come to be, once.
//
// Equality is no matter of rules (equality_classes.h): at the end of each round, what is new is written out under all names
// of its terms; a class that loses a pair falls apart into what is surely equal, and what its terms' facts rested on is
// asked about (materialiser_equality.cc).
//
// What a rule of negation made is found in the graph as it was before: the writer's own graph with the
// changes so far undone and then done again; both are as long as the change, not as the graph.
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
    EqualityClasses& classes;  // of the graph as it was before
    InconsistencyFacts& inconsistencies;
    const Dictionary& dictionary;
    TermId inferred_graph;
    const Limits& limits;
    size_t& inferred_so_far;  // quads inferred since the last Commit, counted on here
    RuleEngine::Counters& counters;
    Cancellation* cancellation;  // null: none
  };

  // `before`: the rules that the inferred graph follows now; the same object as `program` where they did not
  // change.
  Materialiser(RuleProgram& program, RuleProgram& before, const Delta& told, const Context& context);

  absl::Status Maintain();
  // The change of the inferred graph, net.
  Delta InferredChange() const;

 private:
  // A triple that the told change is about.
  struct ToldEntry {
    Triple triple;
    bool before = false;  // told
    bool now = false;
    bool inferred_before = false;
  };
  // A rule that is not positive, to be evaluated with the seed of one of its triggers.
  struct Task {
    uint32_t rule;
    uint32_t trigger;
    Triple triple;
  };
  enum class Phase : uint8_t { kAdd, kTakeAway };
  // Which rules a new triple is shown to.
  enum class Scope : uint8_t {
    kAll,
    kStaying,         // not those that are new: they are evaluated whole
    kEnteringSchema,  // those that are new and speak of the schema alone
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

  void ReadTold();
  absl::Status SettleTold();
  absl::StatusOr<bool> PlaceNegation(AskAxioms ask);  // whether the order is another one
  absl::Status MaintainStratum();
  void TakeBackEarly();
  void CompareRules();
  void ToOldState();
  void ToNewState();
  // What all lower strata and the told change come to.
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
  void SplitDoubted();
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
  // Whether a fact of an entangled rule is made, or asked about, in the running stratum. Made are also those of earlier ones:
  // they follow from reports, since checks are not entangled with what they match. Asked about are those of this stratum
  // alone, and in the first also those that lay in a later one by the axioms before.
  bool MayMake(const CompiledRule& rule, const Triple& fact, Phase phase) const {
    if (program_.ordered.empty() || stratum_ < 0) return true;
    if (!program_.IsEntangled(static_cast<uint32_t>(&rule - program_.rules.data()))) return true;
    const int stratum = program_.StratumOf(fact);
    if (phase == Phase::kAdd) return stratum <= stratum_;
    return stratum == stratum_ || of_report_ || stratum_ == program_.first_entangled;
  }
  // The same of what is made now; a fact that is put off is remembered.
  bool MayEmit(const CompiledRule& rule, const Triple& triple, Phase phase);
  // Rules of `stratum` that `quad` concerns as a positive match are evaluated; what they make goes to Emit.
  // The first those with a schema part by its solutions, the second all others (and changes of the schema
  // itself).
  absl::Status DispatchInstances(const Quad& quad, int stratum, Phase phase);
  absl::Status DispatchRules(const Quad& quad, int stratum, Phase phase, bool also_negative);
  absl::Status FireWhole(RuleProgram& program, uint32_t rule, Phase phase);
  absl::Status FireInstances(uint32_t rule);
  absl::Status FireTask(const Task& task, Phase phase);
  // A rule with `seed_`.
  absl::Status FireSeeded(uint32_t number, Phase phase);
  // False: stop.
  bool Emit(const CompiledRule& rule, absl::Span<const TermId> row, Phase phase);
  bool Collect(const CompiledRule& rule, const Triple& triple, Phase phase);
  bool TakeMade();
  bool DropPresent(const CompiledRule& rule);
  void NowInferred(const Triple& t);
  // So many steps were made; CheckSteps says where that were too many, and names the rule.
  void Spend(uint64_t steps) {
    if (context_.cancellation != nullptr) context_.cancellation->Spend(steps);
  }
  absl::Status CheckSteps(const CompiledRule& rule) {
    return context_.cancellation == nullptr ? absl::OkStatus() : rule.Named(context_.cancellation->Check());
  }
  absl::Status LimitError(const CompiledRule& rule, const char* limit, size_t value) const;

  RuleProgram& program_;
  RuleProgram& before_;
  const Delta& told_delta_;
  const Context context_;
  ProofSearch proofs_;

  int stratum_ = -1;                // that runs
  bool of_report_ = false;          // what is lost is, whose consequences are asked about
  std::vector<ToldEntry> told_;     // by triple
  std::vector<uint32_t> entering_;  // rules of program_ that before_ does not have
  std::vector<bool> is_entering_;
  std::vector<uint32_t> leaving_;  // rules of before_ that program_ does not have
  bool old_state_ = false;

  absl::flat_hash_set<Triple> removed_;    // of the inferred graph, net
  std::vector<Triple> added_;              // likewise
  absl::flat_hash_set<Triple> added_set_;  // added_ as of the beginning of the stratum

  std::vector<Triple> lost_;            // to the running stratum: present before, not now
  std::vector<Triple> gained_;          // the other way about
  absl::flat_hash_set<Triple> marked_;  // taken away in the running stratum, and ghosts
  std::vector<Triple> queue_;           // marked_, in order
  size_t ghosts_ = 0;                   // the first of queue_ that were gone already
  bool ghosts_in_graph_ = false;
  std::vector<Triple> rederivable_;      // in the running stratum and all after it
  std::vector<Triple> unproven_;         // taken away, but not for what may come back
  absl::flat_hash_set<Triple> put_off_;  // of rederivable_: taken away, made again, and of a later stratum
  struct CheckRow {
    uint32_t rule;
    std::vector<TermId> row;
  };
  std::vector<CheckRow> check_rows_;  // solutions of checks that may be gone

  // Equality, where ClosesEquality(stratum_).
  std::vector<Triple> unwritten_;                // of the graph, and not under all names yet
  absl::flat_hash_set<Triple> unwritten_set_;    // those that have other names
  bool are_unsettled_ = false;                   // the classes that there were, where equality is new
  std::vector<TermId> joined_;                   // members of classes that became larger in this turn
  std::vector<EqualityClasses::Class> doubted_;  // classes that lost a pair, as they were
  absl::flat_hash_set<TermId> doubted_terms_;    // their members
  std::vector<TermId> reopened_;                 // terms whose pairs are to be derived again
  absl::flat_hash_set<Triple>
      lost_names_;  // facts, under representatives, whose other names were asked about
  absl::flat_hash_map<Triple, bool>
      is_written_out_;  // by the same: whether the graph holds it under some name

  AxiomAnswers asked_;                // by all orders since the axioms were there
  std::vector<Triple> came_;          // in all rounds
  std::vector<Triple> round_;         // new in the last round
  std::vector<Triple> candidates_;    // for the next
  absl::flat_hash_set<Triple> seen_;  // candidates of this stratum
  size_t compact_at_ = 0;
  absl::flat_hash_set<uint32_t> whole_;  // rules evaluated whole in this round
  Scope scope_ = Scope::kAll;
  uint32_t last_rule_ = 0;
  std::array<std::pair<Triple, const CompiledRule*>, 16> made_now_;  // by rules, in kAdd; not looked at yet
  size_t made_count_ = 0;
  std::vector<Triple> made_;  // likewise, in kTakeAway
  std::vector<Triple> scratch_;
  std::vector<TermId> seed_;
  absl::Status status_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_MATERIALISER_H_
