// Certain equality during retraction: which terms are certainly equal, and which facts certainly hold under
// other names.
//
// Terms are certainly equal if asserted pairs connect them, or pairs proved by rules other than those of
// equality. Pairs that only equality wrote out do not count, since they may rest on a lost fact. Used by
// ProofSearch. Private to this folder. Made for one Update. Writer thread only.
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
  // `classes`: the equality classes before the change; they must be unchanged when a term is first queried.
  CertainEquality(const RuleProgram& program, const EqualityClasses& classes, const GraphWriter& writer,
                  TermId inferred_graph, Cancellation* cancellation)
      : program_(program),
        classes_(classes),
        writer_(writer),
        inferred_graph_(inferred_graph),
        cancellation_(cancellation) {}

  // True if equality may make the fact from others.
  bool MayMake(const Triple& fact) const;
  // True if a fact that is asserted, or was passed to Note, states the same under certainly equal names.
  bool Proves(const Triple& fact);
  // Records that the fact has a proof.
  void Note(const Triple& fact);
  // Drops cached results, because the classes may have changed.
  void Forget() {
    loaded_.clear();
    not_told_.clear();
  }
  // The class of `member`, split into parts of certainly equal terms.
  std::vector<EqualityClasses::Class> PartsOf(TermId member);

 private:
  static constexpr size_t kManyNames = 1 << 16;  // for a fact with more names no asserted one is searched

  void Load(TermId term);
  bool IsTold(const Triple& fact) const;
  bool IsSaid(const Triple& key);

  const RuleProgram& program_;
  const EqualityClasses& classes_;
  const GraphWriter& writer_;
  const TermId inferred_graph_;
  Cancellation* const cancellation_;  // null: steps are not counted
  EqualityClasses certain_;
  absl::flat_hash_set<TermId> loaded_;    // members of classes whose asserted pairs are in certain_
  absl::flat_hash_set<Triple> proven_;    // under representatives of certain_
  absl::flat_hash_set<Triple> not_told_;  // likewise, valid until certain_ changes
};

// The fact with each term replaced by the representative of its class. Facts that equality makes of each
// other get the same result.
Triple UnderRepresentatives(const EqualityClasses& classes, const Triple& fact);
// Calls `visit` with the fact under all names of its terms, including itself, until it returns false; returns
// true if it never did. kMade: all facts that equality makes of this one. kMakers: the facts of which
// equality may make it, without literal subjects.
enum class NamesOf : uint8_t { kMade, kMakers };
bool ForEachName(const EqualityClasses& classes, const Triple& fact, NamesOf which,
                 absl::FunctionRef<bool(const Triple&)> visit);
// Objects under which equality may have derived `fact`: its own object, and for a literal the classes that it
// names.
std::vector<TermId> ObjectsThatMake(const EqualityClasses& classes, TermId object);
// The number of these facts.
size_t CountNames(const EqualityClasses& classes, const Triple& fact);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_CERTAIN_EQUALITY_H_
