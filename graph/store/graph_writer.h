// The one way to make the next graph version. Writer thread only.
//
// A writer starts from a version and changes a private copy (nodes made by this writer are changed in place).
// `current()` is readable at any time by the writer thread: rules and conditions read the unpublished state
// through it. `Freeze` makes it immutable; `Commit` keeps what was done and is cheaper: later changes are made in
// place. `Rollback` goes back to the last of either. Before a Freeze nothing is visible to others. Any change makes cursors over `current()` invalid: collect what you will change, then change it.
// Several writers may start from one version; they do not see each other.
#ifndef DOCENT_GRAPH_STORE_GRAPH_WRITER_H_
#define DOCENT_GRAPH_STORE_GRAPH_WRITER_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "graph/store/delta.h"
#include "graph/store/graph_version.h"

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
  // Adds many quads and returns those that were new, once each, in the order given: what Add for each of them does, but
  // sorted and each index gone through once, which is several times faster where there are thousands.
  std::vector<Quad> AddAll(std::vector<Quad> quads);
  // Removes many quads, sorted for each index. Returns how many were there.
  size_t RemoveAll(std::vector<Quad> quads);

  const GraphVersion& current() const { return *version_; }

  // Rollback goes back to here.
  void Commit();
  // The version made so far, as revision `revision`; the writer goes on from it.
  GraphVersionPtr Freeze(Revision revision);
  // Back to the last Commit, frozen or start version.
  void Rollback();

 private:
  GraphVersionPtr start_;
  std::unique_ptr<GraphVersion> version_;
  uint64_t epoch_;  // nodes with this epoch are ours to change
  // After a Commit that no Freeze followed: the real changes since, to be taken back by a Rollback.
  struct Change {
    Quad quad;
    bool added;
  };
  void Note(const Quad& quad, bool added) {
    if (committed_) journal_.push_back({quad, added});
  }
  void TakeBack();
  bool committed_ = false;
  std::vector<Change> journal_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_GRAPH_WRITER_H_
