// Net change of one stage: a quad is in at most one of the two lists, and applying the change again has no
// effect.
#ifndef DOCENT_GRAPH_STORE_DELTA_H_
#define DOCENT_GRAPH_STORE_DELTA_H_

#include <vector>

#include "graph/store/quad.h"

namespace docent {

struct Delta {
  std::vector<Quad> added;    // absent from the version before, present in the new one
  std::vector<Quad> removed;  // present in the version before, absent from the new one

  bool empty() const { return added.empty() && removed.empty(); }
  size_t size() const { return added.size() + removed.size(); }
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_DELTA_H_
