// Changes one after the other, added up to what they are net: what was added and then removed did not happen.
// One thread.
#ifndef DOCENT_KB_SERVER_STORE_DELTA_SUM_H_
#define DOCENT_KB_SERVER_STORE_DELTA_SUM_H_

#include "absl/container/flat_hash_map.h"
#include "kb_server/store/delta.h"

namespace docent {

class DeltaSum {
 public:
  // Each call must tell of a real change of the graph, in order.
  void Added(const Quad& quad) { Count(quad, 1); }
  void Removed(const Quad& quad) { Count(quad, -1); }
  void Add(const Delta& delta) {
    for (const Quad& quad : delta.removed) Removed(quad);
    for (const Quad& quad : delta.added) Added(quad);
  }

  Delta Net() const {
    Delta net;
    for (const auto& [quad, count] : counts_) (count > 0 ? net.added : net.removed).push_back(quad);
    return net;
  }

 private:
  void Count(const Quad& quad, int by) {
    auto [it, inserted] = counts_.try_emplace(quad, by);
    if (!inserted && (it->second += by) == 0) counts_.erase(it);
  }
  absl::flat_hash_map<Quad, int> counts_;  // +1 added, -1 removed
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_DELTA_SUM_H_
