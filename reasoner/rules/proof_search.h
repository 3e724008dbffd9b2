// Search for another proof of a fact from the remaining facts: the backward half of the
// backward/forward algorithm (Motik, Nenov, Piro, Horrocks, Incremental Update of Datalog
// Materialisation: the Backward/Forward Algorithm, AAAI 2015).
//
// A retraction tests each fact that it is about to remove. A fact with another proof stays, and the
// facts that rest on it are not even examined. The search goes from the fact through the rules to
// asserted facts; a circular proof does not count. It gives up after a number of steps (then the
// fact is removed and derived again, as in delete and re-derive), so it never costs much more than
// it saves. Only positive rules are searched. Results are kept for later tests, since the graph only
// shrinks between them (see Forget). Private to this folder. Made for one Update. Writer thread
// only.
#ifndef DOCENT_REASONER_RULES_PROOF_SEARCH_H_
#define DOCENT_REASONER_RULES_PROOF_SEARCH_H_

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/certain_equality.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent::rules {

// Cache of the facts around a thing, if they are few: it excludes most proof attempts without a lookup each.
// Valid while the graph does not change.
class Surroundings {
 public:
  // False: no triple of the graph that `counts` matches. True: one may match. A kNone term stands for any.
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
        others;  // predicate and object; for an object: subject and predicate
  };
  absl::flat_hash_map<TermId, Facts> of_subject_, of_object_;
};

class ProofSearch {
 public:
  enum class Answer : uint8_t {
    kProven,     // follows from told facts by facts that are not in `lost`
    kUnproven,   // positive rules certainly do not prove it from the graph without `lost`
    kUndecided,  // too many steps; or equality or a rule that is not positive may make it
  };

  // `lost`: facts that the graph still holds, but that do not count; it may grow. `cancellation`: null: none.
  ProofSearch(RuleProgram& program, const SchemaIndex& schema, const EqualityClasses& classes,
              const GraphWriter& writer, TermId inferred_graph, const absl::flat_hash_set<Triple>& lost,
              Cancellation* cancellation)
      : program_(program),
        schema_(schema),
        certain_(program, classes, writer, inferred_graph, cancellation),
        writer_(writer),
        inferred_graph_(inferred_graph),
        lost_(lost),
        cancellation_(cancellation) {}

  absl::StatusOr<Answer> Prove(const Triple& fact);
  // Call it if facts were added since the last Prove, or `lost` has shrunk.
  void Forget() {
    failed_.clear();
    certain_.Forget();
    surroundings_.Forget();
  }
  CertainEquality& certain() { return certain_; }

 private:
  static constexpr int kSteps = 64;      // facts examined for one test
  static constexpr int kDepth = 24;      // rules in a chain
  static constexpr size_t kBodies = 24;  // derivations of one fact by one rule
  // Premises examined in all tests of an Update: a fixed number, and more for each proved fact. If few facts
  // are proved, for example when a long chain is cut, removing and deriving again costs less.
  static constexpr int64_t kPremises = 200000, kPremisesOfSuccess = 1000;
  using Bodies = std::vector<std::vector<Triple>>;

  struct Maker {
    uint32_t rule, head;
    const std::vector<TermId>* row;  // of an instance of the schema; null: the rule itself
  };

  bool IsTold(const Triple& fact) const;
  Answer Search(const Triple& fact, int depth);
  Answer SearchMaker(const Triple& fact, const Maker& maker, int depth);
  bool MayMatch(const CompiledRule& rule, absl::Span<const TermId> seed, uint32_t matched);
  Answer SearchBodies(const Bodies& bodies, int depth, bool complete);
  // The derivations of `fact` by a rule; kProven if one has asserted premises only.
  Answer Collect(const CompiledRule& rule, absl::Span<const TermId> seed, uint32_t matched, Bodies& bodies);

  RuleProgram& program_;
  const SchemaIndex& schema_;
  CertainEquality certain_;
  const GraphWriter& writer_;
  const TermId inferred_graph_;
  const absl::flat_hash_set<Triple>& lost_;
  Cancellation* const cancellation_;

  Surroundings surroundings_;
  absl::flat_hash_set<Triple> proven_;
  absl::flat_hash_set<Triple> failed_;      // have no proof in the current graph
  absl::flat_hash_map<Triple, bool> open_;  // being proved; true: needed again meanwhile
  std::vector<Triple> failures_;            // entries of failed_ from the running test, in order
  int steps_left_ = 0;
  int64_t premises_left_ = kPremises;
  absl::Status status_;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_PROOF_SEARCH_H_
