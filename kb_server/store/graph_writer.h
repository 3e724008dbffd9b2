// The one way to make the next graph version. Writer thread only.
//
// A writer starts from a version and changes a private copy (nodes made by this writer are changed in place).
// `current()` is readable at any time by the writer thread: rules and constraints read the unpublished state
// through it. `Freeze` makes it immutable; `Rollback` goes back to the start. Between them nothing is visible
// to others. Any change makes cursors over `current()` invalid: collect what you will change, then change it.
// Several writers may start from one version; they do not see each other.
#ifndef DOCENT_KB_SERVER_STORE_GRAPH_WRITER_H_
#define DOCENT_KB_SERVER_STORE_GRAPH_WRITER_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "kb_server/store/delta.h"
#include "kb_server/store/graph_version.h"

namespace docent {

class GraphWriter {
 public:
  // `start` may be null: the empty graph.
  explicit GraphWriter(GraphVersionPtr start);
  GraphWriter(const GraphWriter&) = delete;
  GraphWriter& operator=(const GraphWriter&) = delete;

  // True if the graph changed.
  bool Add(const Quad& quad);
  bool Remove(const Quad& quad);
  // Adds then removes as listed, returns the net change. A quad in both lists ends up absent.
  Delta Apply(const std::vector<Quad>& add, const std::vector<Quad>& remove);
  // Fills the empty graph with these quads at once: sorts, drops repeats and builds full nodes; several times
  // faster than Add. Requires current().size() == 0.
  void BulkLoad(std::vector<Quad> quads);

  const GraphVersion& current() const { return *version_; }

  // The version made so far, as revision `revision`; the writer goes on from it.
  GraphVersionPtr Freeze(Revision revision);
  // Back to the last frozen (or start) version.
  void Rollback();

 private:
  GraphVersionPtr start_;
  std::unique_ptr<GraphVersion> version_;
  uint64_t epoch_;  // nodes with this epoch are ours to change
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_GRAPH_WRITER_H_
