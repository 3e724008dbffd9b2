// One maintenance of docent:inferred: from a change of the told facts to a change of the inferred ones.
// Private to this folder; the semantics stand in rule_engine.h. Made for one Update. Writer thread only.
//
// Strata are treated in order; within one:
//   1. overdelete: in the graph as it was before, every inferred triple that a rule made from a lost triple
//   (or because a
//      triple was absent that is there now) is marked, and what was made from those, and so on; then all are
//      taken out
//   2. re-derive: of those, what a rule still makes comes back
//   3. add: rules are seeded with each new (or returned) triple, and with each lost one where they negate it
// "The graph as it was" is the writer's own graph with the changes so far undone and then done again: both
// are as long as the change, not as the graph.
#ifndef DOCENT_REASONER_RULES_MATERIALISER_H_
#define DOCENT_REASONER_RULES_MATERIALISER_H_

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "kb_server/base/limits.h"
#include "kb_server/store/delta.h"
#include "kb_server/store/graph_writer.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_program.h"

namespace docent {

class Materialiser {
 public:
  // `inferred_so_far`: quads inferred since the last Commit, counted on here.
  Materialiser(RuleProgram& program, GraphWriter& writer, const Delta& told, TermId inferred_graph,
               const Limits& limits, size_t& inferred_so_far, RuleEngine::Counters& counters);

  // The inferred graph follows `told`.
  absl::Status Maintain();
  // The inferred graph is computed anew.
  absl::Status Rebuild();
  // The change of the inferred graph, net.
  Delta InferredChange() const;

 private:
  // Evaluate `rule` with the seed that `triple` gives for `trigger`.
  struct Task {
    uint32_t rule;
    uint32_t trigger;
    Triple triple;
  };
  struct Stratum {
    std::vector<Task> added;          // may make something new
    std::vector<Task> lost;           // may have lost its support
    std::vector<Triple> rederivable;  // taken out by a lower stratum, may be made by this one
  };
  struct ToldChange {
    int added = 0;
    int removed = 0;
    bool before = false;
    bool now = false;
  };

  Quad InferredQuad(const Triple& t) const { return {t.subject, t.predicate, t.object, inferred_graph_}; }
  bool IsInferred(const Triple& t) const { return writer_.current().Contains(InferredQuad(t)); }
  size_t ToldGraphs(const Triple& t) const;
  bool ToldNow(const Triple& t) const;
  bool ToldBefore(const Triple& t) const;
  bool InferredBefore(const Triple& t) const;
  void CollectToldChanges();

  void ToOldState();
  void ToNewState();
  void Change(const Triple& t, bool add);

  // Tasks for all rules of strata `from` and higher that match `triple`.
  void Announce(const Triple& triple, bool gained, int from);
  void AnnounceWithin(const Triple& triple, int stratum, std::vector<Task>& tasks);
  void AnnounceHigher(int stratum);
  absl::Status Overdelete(int stratum);
  absl::Status Rederive(int stratum);
  absl::StatusOr<bool> IsDerivable(const Triple& triple, int stratum);
  absl::Status Add(int stratum);
  // The heads that `rule` makes from `seed` in the writer's current graph, into made_: kAdd those that are
  // not inferred yet, kOverdelete those that are.
  enum class Phase : uint8_t { kAdd, kOverdelete };
  absl::Status Fire(uint32_t rule, absl::Span<const TermId> seed, Phase phase);
  absl::Status Infer(const Triple& triple, uint32_t rule, int stratum);
  absl::Status LimitError(uint32_t rule, const char* limit, size_t value) const;

  RuleProgram& program_;
  GraphWriter& writer_;
  const Delta& told_;
  const TermId inferred_graph_;
  const Limits& limits_;
  size_t& inferred_so_far_;
  RuleEngine::Counters& counters_;

  absl::flat_hash_map<Triple, ToldChange> told_changes_;
  absl::flat_hash_map<Triple, bool> changes_;  // of the inferred graph, net: added or removed
  std::vector<Stratum> strata_;
  absl::flat_hash_set<Triple> overdeleted_;
  std::vector<Triple> touched_;                  // in the running stratum
  absl::flat_hash_map<Triple, bool> announced_;  // to all higher strata: gained or lost
  std::vector<Triple> made_;
  std::vector<TermId> seed_;
};

}  // namespace docent

#endif  // DOCENT_REASONER_RULES_MATERIALISER_H_
