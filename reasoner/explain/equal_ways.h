// Ways between equal things: which told pairs lead from one to the other.
//
// The graph holds every pair of a class, so most of them rest on others and each of those on others again; a way over pairs
// that stand by themselves is a proof that people can follow.
// Private to this folder. Of one version; one thread.
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

  // The names of a term, itself the first. A literal has no other.
  std::vector<TermId> NamesOf(TermId term) const;
  // The terms from `a` to `b`, each told to be equal to the next or the other way about; of two that are the same one beside it
  // as well, such as a, b, a. Empty: there is no such way. (A literal is only ever at the end of one.)
  std::vector<TermId> Way(TermId a, TermId b);
  // a owl:sameAs b stands by itself, though it is not told. False: there was a way already.
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
  absl::flat_hash_map<TermId, Node> nodes_;  // of classes that were asked about: trees of told pairs
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_EQUAL_WAYS_H_
