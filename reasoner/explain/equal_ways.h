// Paths of asserted pairs between equal things.
//
// The graph holds every pair of a class, so most pairs rest on others and those on others again. A path over
// pairs that stand by themselves is a proof that people can follow. Private to this folder. For one version;
// one thread.
#ifndef DOCENT_REASONER_EXPLAIN_EQUAL_WAYS_H_
#define DOCENT_REASONER_EXPLAIN_EQUAL_WAYS_H_

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/store/graph_version.h"

namespace docent::explain {

class EqualWays {
 public:
  EqualWays(const GraphVersion& version, TermId same_as, TermId inferred_graph)
      : version_(version), same_as_(same_as), inferred_graph_(inferred_graph) {}

  // The names of a term, itself first. A literal has no others.
  std::vector<TermId> NamesOf(TermId term) const;
  // The terms from `a` to `b`; for each step one of the two pairs is asserted as equal. If `a` and `b` are
  // the same, a neighbour is included, as in a, b, a. Empty: there is no path. (A literal is only ever at the
  // end of one.)
  std::vector<TermId> Way(TermId a, TermId b);
  // Adds a owl:sameAs b as a pair that stands by itself, although it is not asserted. False: there was a path
  // already.
  bool Connect(TermId a, TermId b);

 private:
  struct Node {
    std::vector<TermId> beside;
    TermId parent;  // itself: the root
    size_t depth = 0;
  };
  void Load(TermId term);
  void PlantTree(TermId root);

  const GraphVersion& version_;
  const TermId same_as_, inferred_graph_;
  absl::flat_hash_map<TermId, Node> nodes_;  // of the queried classes: trees of asserted pairs
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_EQUAL_WAYS_H_
