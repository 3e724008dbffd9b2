// Writer of the next graph version. Writer thread only.
// It starts from a version and changes a private copy (its own nodes in place); several may start from one.
// The writer thread may read `current()` at any time: rules and conditions read unpublished state there.
// `Freeze` makes an immutable version. `Commit` keeps the changes and is cheaper: later ones are in place.
// `Rollback` returns to the last of either. No other thread sees changes before a Freeze.
//
// Any change invalidates cursors over `current()`: collect the changes first, then make them.
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
  // Adds many quads and returns the new ones, once each, in the given order. Same effect as an Add of each,
  // but several times faster for thousands of quads: they are sorted, and each index is walked once.
  std::vector<Quad> AddAll(std::vector<Quad> quads);
  // Removes many quads, sorted for each index. Returns the number of quads removed.
  size_t RemoveAll(std::vector<Quad> quads);

  const GraphVersion& current() const { return *version_; }
  // Lets current() leave out some triples (GraphVersion::Without) as long as this exists; until then no Freeze and no
  // Rollback. Both arguments must outlive it.
  class Hiding {
   public:
    Hiding(GraphWriter& writer, const HiddenTriples& hidden) : writer_(writer) {
      writer_.version_->hidden_ = &hidden;
    }
    ~Hiding() { writer_.version_->hidden_ = nullptr; }
    Hiding(const Hiding&) = delete;
    Hiding& operator=(const Hiding&) = delete;

   private:
    GraphWriter& writer_;
  };

  // Sets the point to which Rollback returns.
  void Commit();
  // Publishes the current state as revision `revision`; the writer goes on from it.
  GraphVersionPtr Freeze(Revision revision);
  // Returns to the last Commit, frozen version or start version.
  void Rollback();

 private:
  GraphVersionPtr start_;
  std::unique_ptr<GraphVersion> version_;
  uint64_t epoch_;  // this writer may change nodes with this epoch
  // The real changes since a Commit without a later Freeze; a Rollback undoes them.
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
