// The part of the graph of which a world is made (run_case.h): what neither rules nor runs made. One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_WORLD_FACTS_H_
#define DOCENT_KB_SERVER_REPLAY_WORLD_FACTS_H_

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/replay_limits.h"
#include "kb_server/replay/run_case.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/turn/turn.h"

namespace docent::server {

class WorldFacts {
 public:
  // Both must outlive it; `own` may be null: no graph is the run's own.
  WorldFacts(const Stages* stages, const RunTree* own, const ReplayLimits& limits);

  // RESOURCE_EXHAUSTED naming replay_facts: these are too many.
  absl::StatusOr<std::vector<TermQuad>> All(const std::set<Quad>& but = {});
  // When those of All end that have a lifetime, the first in front.
  std::vector<std::pair<TimeMicros, TermQuad>> Lifetimes();
  // What stands for this turn alone, or as long as something waits with it: events with their facts, times that occur.
  std::set<Quad> Passing() const;
  // Tells those of them that All has.
  std::vector<QuadOperation> Telling(const std::set<Quad>& facts);

  // Robots that runs other than the own hold.
  const Holds& holds() const { return holds_; }
  void ReadHolds();

 private:
  bool IsOfWorld(TermId graph);
  absl::Status Count(size_t more);
  TermQuad Decode(const Quad& quad) const;

  const Stages& stages_;
  const RunTree* const own_;
  const ReplayLimits limits_;
  size_t counted_ = 0;
  Holds holds_;
};

// Since when what the activator of a workflow waits for has held, where that counts (ext:for).
std::vector<HeldSince> HeldSinceOf(const Stages& stages, const std::string& workflow);

// Rules, robot services and workflows that the stages have, but for the workflow `but`.
std::vector<Document> DocumentsOf(const Stages& stages, const std::string& but);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_WORLD_FACTS_H_
