// Triples that a view of a graph leaves out, in whatever graphs they are: see GraphVersion::Without and
// GraphWriter::Hiding. Immutable while it is used; then any thread.
#ifndef DOCENT_GRAPH_STORE_HIDDEN_TRIPLES_H_
#define DOCENT_GRAPH_STORE_HIDDEN_TRIPLES_H_

#include "graph/store/quad.h"

namespace docent {

class HiddenTriples {
 public:
  virtual ~HiddenTriples() = default;
  // False: no match of `pattern` is hidden. Asked once for each scan, so it looks at the ids only.
  virtual bool MayHide(const QuadPattern& pattern) const = 0;
  // Asked for each match of a pattern that MayHide.
  virtual bool Hides(const Quad& quad) const = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_HIDDEN_TRIPLES_H_
