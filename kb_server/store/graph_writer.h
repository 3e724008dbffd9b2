// The one way to make the next graph version. Writer thread only.
//
// A writer starts from a version and changes a private copy (nodes made by this writer are changed in place).
// `current()` is readable at any time by the writer thread: rules and constraints read the unpublished state
// through it. `Freeze` makes it immutable; `Rollback` goes back to the start. Between them nothing is visible to others.
#ifndef DOCENT_KB_SERVER_STORE_GRAPH_WRITER_H_
#define DOCENT_KB_SERVER_STORE_GRAPH_WRITER_H_

#include <vector>

#include "kb_server/store/delta.h"
#include "kb_server/store/graph_version.h"

namespace docent {

class GraphWriter {
 public:
  explicit GraphWriter(GraphVersionPtr start);

  // True if the graph changed.
  bool Add(const Quad& quad);
  bool Remove(const Quad& quad);
  // Adds then removes as listed, returns the net change.
  Delta Apply(const std::vector<Quad>& add, const std::vector<Quad>& remove);
  // Replaces the empty graph by these quads at once: sorts and builds full nodes. Requires current().size() == 0.
  void BulkLoad(std::vector<Quad> quads);

  const GraphVersion& current() const { return version_; }

  // The version made so far, as revision `revision`; the writer goes on from it.
  GraphVersionPtr Freeze(Revision revision);
  // Back to the last frozen (or start) version.
  void Rollback();

 private:
  GraphVersionPtr start_;
  GraphVersion version_;
  uint64_t epoch_;  // nodes with this epoch are ours to change
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_GRAPH_WRITER_H_
