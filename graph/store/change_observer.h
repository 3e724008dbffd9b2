// Who likes to know of a change of the graph a little before it is made. Writer thread only.
#ifndef DOCENT_GRAPH_STORE_CHANGE_OBSERVER_H_
#define DOCENT_GRAPH_STORE_CHANGE_OBSERVER_H_

#include "graph/store/quad.h"

namespace docent {

// Told of each quad that a GraphWriter is asked to put in or out one by one, by its Rollback too: time to bring into the cache
// what will be looked at afterwards. It decides nothing and must not use the writer. Loads of many quads are not told.
class ChangeObserver {
 public:
  // Before any index is changed, whether or not the graph will.
  virtual void BeforeChange(const Quad& quad, bool added) = 0;
  // Only if the graph changes, with half of the indexes still to be changed. What BeforeChange has asked of memory is most
  // likely there.
  virtual void DuringChange(const Quad& quad, bool added) = 0;

 protected:
  ~ChangeObserver() = default;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_CHANGE_OBSERVER_H_
