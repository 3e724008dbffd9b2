// Sum of successive changes: the net change. A quad that was added and then removed is not in it. One
// thread.
#ifndef DOCENT_GRAPH_STORE_DELTA_SUM_H_
#define DOCENT_GRAPH_STORE_DELTA_SUM_H_

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/store/delta.h"

namespace docent {

class DeltaSum {
 public:
  // Each call must report a real change of the graph, in order.
  void Added(const Quad& quad) { changes_.added.push_back(quad); }
  void Removed(const Quad& quad) { changes_.removed.push_back(quad); }
  void Add(const Delta& delta) {
    changes_.added.insert(changes_.added.end(), delta.added.begin(), delta.added.end());
    changes_.removed.insert(changes_.removed.end(), delta.removed.begin(), delta.removed.end());
  }

  // Each list in the order in which its quads were first changed: the same on every replay.
  Delta Net() const {
    if (changes_.added.empty() || changes_.removed.empty()) return changes_;
    absl::flat_hash_map<Quad, int> counts;  // a quad's changes alternate, so this ends at -1, 0 or 1
    for (const Quad& quad : changes_.added) ++counts[quad];
    for (const Quad& quad : changes_.removed) --counts[quad];
    auto keep = [&counts](const std::vector<Quad>& quads, int sign) {
      std::vector<Quad> kept;
      for (const Quad& quad : quads) {
        int& count = counts[quad];
        if (count != sign) continue;
        kept.push_back(quad);
        count = 0;  // once
      }
      return kept;
    };
    Delta net;
    net.added = keep(changes_.added, 1);
    net.removed = keep(changes_.removed, -1);
    return net;
  }

 private:
  Delta changes_;  // all changes, not the net
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_DELTA_SUM_H_
