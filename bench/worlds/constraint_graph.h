// In-process graph with the background of constraint_world.h and its constraints. One thread.
#ifndef DOCENT_BENCH_WORLDS_CONSTRAINT_GRAPH_H_
#define DOCENT_BENCH_WORLDS_CONSTRAINT_GRAPH_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/worlds/constraint_world.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/store/graph_writer.h"
#include "reasoner/conditions/standing_conditions.h"

namespace docent::bench {

class ConstraintGraph {
 public:
  // The graph before the first update, for `constraints` constraints.
  explicit ConstraintGraph(size_t constraints);

  Quad Encode(const TermQuad& fact);
  Delta Apply(bool add, const Quad& quad) {
    return add ? writer_.Apply({quad}, {}) : writer_.Apply({}, {quad});
  }
  // The constraints are updated after each Apply, as in a turn of the server.
  // Freezes the next immutable version.
  void Freeze() { writer_.Freeze(Revision(++revision_)); }
  const GraphVersion& version() const { return writer_.current(); }
  Dictionary& dictionary() { return dictionary_; }

 private:
  Dictionary dictionary_;
  const TermId graph_ = dictionary_.InternIri(kDefaultGraph);
  GraphWriter writer_{nullptr};
  uint64_t revision_ = 0;
};

// Ends the program if the text is no query.
sparql::Query ParseConstraint(const std::string& text);
using ConstraintQueries = std::vector<std::pair<sparql::Query, conditions::RegisterOptions>>;
ConstraintQueries ParseConstraints(size_t count);
// By number. Ends the program if one is refused.
std::vector<conditions::ConditionId> RegisterAll(const ConstraintQueries& queries,
                                                 const ConstraintGraph& graph,
                                                 conditions::StandingConditions& set);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_CONSTRAINT_GRAPH_H_
