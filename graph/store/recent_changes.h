// Record of the newest changes of the graph. It tells whether the data read by work beside the writer, on an
// older version, has changed since. Bounded; writer thread only.
#ifndef DOCENT_GRAPH_STORE_RECENT_CHANGES_H_
#define DOCENT_GRAPH_STORE_RECENT_CHANGES_H_

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/store/delta.h"

namespace docent {

// A pattern of quads that were read, or searched without a match. nullopt stands for any term.
struct ReadPattern {
  std::optional<Term> subject, predicate, object, graph;
  friend bool operator==(const ReadPattern&, const ReadPattern&) = default;
};

class RecentChanges {
 public:
  // `quad_limit`: how many changed quads are remembered.
  explicit RecentChanges(size_t quad_limit = 100000) : quad_limit_(quad_limit) {}

  // The change from the version before to `revision`; revisions grow one by one.
  void Add(Revision revision, const Delta& delta);
  // True if a quad that matches one of `reads` was added or removed after `since`. Also true if the record
  // does not reach back that far.
  bool Touched(Revision since, const std::vector<ReadPattern>& reads, const Dictionary& dictionary) const;
  void Clear();

 private:
  struct Change {
    Revision revision;
    Delta delta;
  };
  const size_t quad_limit_;
  std::deque<Change> changes_;
  size_t quads_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_RECENT_CHANGES_H_
