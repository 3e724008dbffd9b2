// Schema index: the rules, specialised to the schema in the graph.
//
// Most rules of OWL 2 RL join a few patterns about the schema with patterns about the data:
//   ?p rdfs:domain ?c . ?x ?p ?y  →  ?x a ?c
// Evaluated for each changed triple, such a rule would cost a lookup even for properties without a domain. So
// the solutions of the schema part are kept here (an *instance* each: p = ex:worksFor, c = ex:Person), and
// the rest of the body is in a discrimination index with the instance's values (?x ex:worksFor ?y). A changed
// triple finds the instances that it concerns and no others. (Partial evaluation, as in the peers'
// "TBox-specialised" rules; here maintained while the schema changes.)
//
// A changed schema triple itself takes the general path: its rule is joined with all data.
// Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_RULES_SCHEMA_INDEX_H_
#define DOCENT_REASONER_RULES_SCHEMA_INDEX_H_

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/store/graph_version.h"
#include "reasoner/matching/pattern_index.h"
#include "reasoner/rules/rule_program.h"

namespace docent::rules {

class SchemaIndex {
 public:
  struct Instance {
    uint32_t rule = 0;
    std::vector<TermId> row;  // columns of the body that the schema part binds; the others kNone
    std::vector<matching::PatternIndex::Handle> triggers;
    std::vector<matching::PatternIndex::Handle> heads;
    absl::InlinedVector<uint32_t, 4> places;  // in the lists of the triples on which it rests
  };

  // Builds all instances of `program` in `graph`. `program` must outlive this or the next Build.
  // `cancellation` (null: none) ends it early, as an error that names the rule; the index must then be built
  // again. The same holds below.
  absl::Status Build(RuleProgram& program, const GraphVersion& graph, Cancellation* cancellation);
  // `triple` is new in `graph`. Below: `triple` was removed.
  absl::Status Gained(const Triple& triple, const GraphVersion& graph, Cancellation* cancellation);
  void Lost(const Triple& triple);

  const Instance& instance(uint32_t id) const { return instances_[id]; }
  // Calls `visit(instance)` for each instance of a rule. O(size).
  template <typename Visit>
  void ForEachInstance(uint32_t rule, Visit visit) const {
    for (const Instance& instance : instances_) {
      if (instance.rule == rule && !instance.triggers.empty()) visit(instance);
    }
  }
  // References: instance, trigger of its rule's body; instance, triple of its rule's head.
  const matching::PatternIndex& triggers() const { return triggers_; }
  const matching::PatternIndex& heads() const { return heads_; }
  size_t size() const { return instances_.size() - free_.size(); }
  // Calls `visit(id, instance)` for each. O(size).
  template <typename Visit>
  void ForEach(Visit visit) const {
    for (uint32_t id = 0; id < instances_.size(); ++id) {
      if (!instances_[id].triggers.empty()) visit(id, instances_[id]);
    }
  }
  // Increases with every change.
  uint64_t changes() const { return changes_; }

 private:
  absl::Status Find(uint32_t rule, absl::Span<const TermId> seed, uint32_t matched,
                    const sparql::RunOptions& run);
  void Add(uint32_t rule, absl::Span<const TermId> row);
  void Remove(uint32_t id);
  // The triples on which an instance rests, sorted and distinct.
  using Support = absl::InlinedVector<Triple, 4>;
  Support SupportOf(uint32_t rule, absl::Span<const TermId> row) const;

  // An instance, and the index of the triple in its support.
  struct Place {
    uint32_t instance, number;
  };
  RuleProgram* program_ = nullptr;
  std::vector<Instance> instances_;
  std::vector<uint32_t> free_;
  absl::flat_hash_map<Triple, absl::InlinedVector<Place, 1>> by_triple_;  // instances that rest on it
  absl::flat_hash_map<size_t, absl::InlinedVector<uint32_t, 1>> by_row_;  // by hash of rule and row
  matching::PatternIndex triggers_;
  matching::PatternIndex heads_;
  std::vector<TermId> seed_;
  uint64_t changes_ = 0;
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_SCHEMA_INDEX_H_
