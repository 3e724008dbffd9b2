// Which terms are surely equal while facts are taken away, and what is surely true under their other names.
//
// Certain is what told pairs connect, and pairs that another rule than those of equality proves; never what equality alone
// wrote out, since that may rest on what is lost. ProofSearch asks it.
// Private to this folder. Made for one Update. Writer thread only.
#ifndef DOCENT_REASONER_RULES_CERTAIN_EQUALITY_H_
#define DOCENT_REASONER_RULES_CERTAIN_EQUALITY_H_

#include <cstdint>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "graph/base/cancellation.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/equality_classes.h"
#include "reasoner/rules/rule_program.h"

namespace docent::rules {

class CertainEquality {
 public:
  // `classes`: all that was equal before; they must be as they were whenever a term is asked about for the first time.
  CertainEquality(const RuleProgram& program, const EqualityClasses& classes, const GraphWriter& writer,
                  TermId inferred_graph, Cancellation* cancellation)
      : program_(program),
        classes_(classes),
        writer_(writer),
        inferred_graph_(inferred_graph),
        cancellation_(cancellation) {}

  // Equality may make the fact of others.
  bool MayMake(const Triple& fact) const;
  // A fact that is told, or that Note knows, says it under names that are certainly equal to its own.
  bool Proves(const Triple& fact);
  // The fact has a proof.
  void Note(const Triple& fact);
  // The classes may have others now.
  void Forget() {
    loaded_.clear();
    not_told_.clear();
  }
  // The terms of the class of `member` as far as they are certainly equal: the parts into which the class falls.
  std::vector<EqualityClasses::Class> PartsOf(TermId member);

 private:
  static constexpr size_t kManyNames = 1 << 16;  // of a fact with more no told one is looked for

  void Load(TermId term);
  bool IsTold(const Triple& fact) const;
  bool IsSaid(const Triple& key);

  const RuleProgram& program_;
  const EqualityClasses& classes_;
  const GraphWriter& writer_;
  const TermId inferred_graph_;
  Cancellation* const cancellation_;  // null: steps are not counted
  EqualityClasses certain_;
  absl::flat_hash_set<TermId> loaded_;    // members of classes whose told pairs certain_ has
  absl::flat_hash_set<Triple> proven_;    // under representatives of certain_
  absl::flat_hash_set<Triple> not_told_;  // likewise, as long as certain_ stays as it is
};

// The fact with each term replaced by the representative of its class: facts that equality makes of each other have the same.
Triple UnderRepresentatives(const EqualityClasses& classes, const Triple& fact);
// Calls `visit` with the fact under all names of its terms, itself among them, until it returns false; whether it never did.
// kMade are all that equality makes of the fact; kMakers are those that it may be made of, since nothing
// follows from a literal.
enum class NamesOf : uint8_t { kMade, kMakers };
bool ForEachName(const EqualityClasses& classes, const Triple& fact, NamesOf which,
                 absl::FunctionRef<bool(const Triple&)> visit);
// The objects whose names `fact` may have been made of: its own, and where that is a literal the classes that it names.
std::vector<TermId> ObjectsThatMake(const EqualityClasses& classes, TermId object);
// How many these are.
size_t CountNames(const EqualityClasses& classes, const Triple& fact);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_CERTAIN_EQUALITY_H_
