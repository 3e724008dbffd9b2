// Net change of one stage: a quad stands in at most one of the two lists, and applying it twice does
// nothing.
#ifndef DOCENT_GRAPH_STORE_DELTA_H_
#define DOCENT_GRAPH_STORE_DELTA_H_

#include <vector>

#include "graph/store/quad.h"

namespace docent {

struct Delta {
  std::vector<Quad> added;    // were not in the version before, are in it now
  std::vector<Quad> removed;  // were in the version before, are not in it now

  bool empty() const { return added.empty() && removed.empty(); }
  size_t size() const { return added.size() + removed.size(); }
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_DELTA_H_
