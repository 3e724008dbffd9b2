// A triple in a named graph, as ids; and a pattern of quads. Values; any thread.
#ifndef DOCENT_GRAPH_STORE_QUAD_H_
#define DOCENT_GRAPH_STORE_QUAD_H_

#include <utility>

#include "graph/rdf/term_id.h"

namespace docent {

// The graph is never "none": data written without a graph lies in docent:default.
struct Quad {
  TermId subject;
  TermId predicate;
  TermId object;
  TermId graph;

  friend constexpr auto operator<=>(const Quad&, const Quad&) = default;
  template <typename H>
  friend H AbslHashValue(H h, const Quad& q) {
    return H::combine(std::move(h), q.subject, q.predicate, q.object, q.graph);
  }
};

constexpr Quad WithoutGraph(const Quad& quad) {
  return {quad.subject, quad.predicate, quad.object, TermId()};
}

// A quad whose none ids are wildcards.
struct QuadPattern {
  TermId subject;
  TermId predicate;
  TermId object;
  TermId graph;

  constexpr bool Matches(const Quad& q) const {
    return (subject.IsNone() || subject == q.subject) && (predicate.IsNone() || predicate == q.predicate) &&
           (object.IsNone() || object == q.object) && (graph.IsNone() || graph == q.graph);
  }
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_QUAD_H_
