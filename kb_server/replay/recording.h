// The case of a run as its turns come, one after the other, from stages that take them again. One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_RECORDING_H_
#define DOCENT_KB_SERVER_REPLAY_RECORDING_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "graph/base/limits.h"
#include "graph/base/replay_limits.h"
#include "kb_server/replay/case_recorder.h"
#include "kb_server/replay/run_case.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/turn/turn.h"

namespace docent::server {

// The number at the end of a run's id.
uint64_t NumberOf(const RunId& run);

class Recording {
 public:
  // Run and stages must outlive it; the stages stand before the turn that starts the run.
  Recording(const KnownRun& run, const Stages* stages, const Limits& limits,
            const ReplayLimits& replay_limits);

  // `state`: of the stages, encoded. RESOURCE_EXHAUSTED naming the limit, here and below.
  absl::Status Begin(std::string state);
  // The next turn, which the stages have taken. FAILED_PRECONDITION: the run is of no workflow.
  absl::Status Take(const TurnResult& result);
  // After the last one.
  RunCase End(uint64_t last_turn);

 private:
  absl::Status TakeStart(const TurnResult& result);
  absl::Status Count(size_t facts);
  void TakeTimes(const Delta& delta, CaseTurn* turn);

  const KnownRun& known_;
  const Stages& stages_;
  const Limits limits_;
  const ReplayLimits replay_limits_;
  RunTree tree_;
  size_t counted_ = 0;
  RunCase case_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_RECORDING_H_
