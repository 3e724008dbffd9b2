// Search for another proof of a fact from facts that stay: the backward half of the backward/forward algorithm (Motik,
// Nenov, Piro, Horrocks, Incremental Update of Datalog Materialisation: the Backward/Forward Algorithm, AAAI
// 2015).
//
// A retraction asks this of each fact that it is about to take away. A fact with another proof stays, and
// what rests on it is not even looked at. The search goes from the fact through the rules to told facts; a
// fact on the way to itself is no proof of itself. It gives up after a number of steps (then the fact is
// taken away and derived again, as in delete and re-derive), so it can never cost much more than it saves.
// Only positive rules are searched. What was found out about a fact holds for the questions after it, since
// the graph only becomes smaller between them (see Forget).
// Private to this folder. Made for one Update. Writer thread only.
#ifndef DOCENT_REASONER_RULES_PROOF_SEARCH_H_
#define DOCENT_REASONER_RULES_PROOF_SEARCH_H_

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/certain_equality.h"
#include "reasoner/rules/inconsistency.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent::rules {

// The facts around a thing, kept where they are few: rules out most ways to a proof without a lookup each. Of
// a graph that does not change meanwhile.
class Surroundings {
 public:
  // False: no triple of the graph that `counts` matches. True: one may. A term that is none stands for any.
  bool MayMatch(const GraphVersion& graph, const Triple& pattern,
                absl::FunctionRef<bool(const Triple&)> counts);
  void Forget() {
    of_subject_.clear();
    of_object_.clear();
  }

 private:
  static constexpr size_t kFew = 32;
  struct Facts {
    bool all = false;
    std::vector<std::pair<TermId, TermId>>
        others;  // predicate and object; of an object: subject and predicate
  };
  absl::flat_hash_map<TermId, Facts> of_subject_, of_object_;
};

class ProofSearch {
 public:
  enum class Answer : uint8_t {
    kProven,     // follows from told facts by facts that are not in `lost`
    kUnproven,   // by positive rules certainly not, from what is in the graph now and not in `lost`
    kUndecided,  // too far to tell, or a rule that is not positive may make it, or equality
  };

  // `lost`: facts that the graph still holds, but that do not count. Grows meanwhile. `cancellation`: null: none.
  ProofSearch(RuleProgram& program, const SchemaIndex& schema, const EqualityClasses& classes,
              const GraphWriter& writer, const InconsistencyFacts& inconsistencies, TermId inferred_graph,
              const absl::flat_hash_set<Triple>& lost, Cancellation* cancellation)
      : program_(program),
        schema_(schema),
        certain_(program, classes, writer, inferred_graph, cancellation),
        writer_(writer),
        inconsistencies_(inconsistencies),
        inferred_graph_(inferred_graph),
        lost_(lost),
        cancellation_(cancellation) {}

  absl::StatusOr<Answer> Prove(const Triple& fact);
  // To be called where facts came into the graph since the last Prove, or `lost` became smaller.
  void Forget() {
    failed_.clear();
    certain_.Forget();
    surroundings_.Forget();
  }
  CertainEquality& certain() { return certain_; }

 private:
  static constexpr int kSteps = 64;      // facts looked at for one question
  static constexpr int kDepth = 24;      // rules one after the other
  static constexpr size_t kBodies = 24;  // ways of one rule to make one fact
  // Premises looked at for all questions of an Update: so many, and more for each fact that was proven. Where hardly any is, as
  // when a long chain is cut, it costs less to take away and to derive again.
  static constexpr int64_t kPremises = 200000, kPremisesOfSuccess = 1000;
  using Bodies = std::vector<std::vector<Triple>>;

  struct Maker {
    uint32_t rule, head;
    const std::vector<TermId>* row;  // of an instance of the schema; null: the rule as it is
  };

  bool IsTold(const Triple& fact) const;
  Answer Search(const Triple& fact, int depth);
  Answer SearchMaker(const Triple& fact, const Maker& maker, int depth);
  bool MayMatch(const CompiledRule& rule, absl::Span<const TermId> seed, uint32_t matched);
  Answer SearchBodies(const Bodies& bodies, int depth, bool complete);
  // The ways of a rule to make `fact`; kProven where one has told premises alone.
  Answer Collect(const CompiledRule& rule, absl::Span<const TermId> seed, uint32_t matched, Bodies& bodies);

  RuleProgram& program_;
  const SchemaIndex& schema_;
  CertainEquality certain_;
  const GraphWriter& writer_;
  const InconsistencyFacts& inconsistencies_;
  const TermId inferred_graph_;
  const absl::flat_hash_set<Triple>& lost_;
  Cancellation* const cancellation_;

  Surroundings surroundings_;
  absl::flat_hash_set<Triple> proven_;
  absl::flat_hash_set<Triple> failed_;      // have no proof in the graph as it is
  absl::flat_hash_map<Triple, bool> open_;  // on the way; true: somebody asked again
  std::vector<Triple> failures_;            // failed_ of the running question, in order
  int steps_left_ = 0;
  int64_t premises_left_ = kPremises;
  absl::Status status_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_PROOF_SEARCH_H_
