// Recorder of cases: makes a run's case from the log, by a replay of the turns of its life beside the running server, on stages
// of its own. One thread a recorder; nothing is shared with others but the log and versions.
#ifndef DOCENT_KB_SERVER_REPLAY_CASE_RECORDER_H_
#define DOCENT_KB_SERVER_REPLAY_CASE_RECORDER_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/base/replay_limits.h"
#include "graph/log/context_log.h"
#include "graph/sparql/values/function_registry.h"
#include "kb_server/door/query_port.h"
#include "kb_server/replay/run_case.h"
#include "kb_server/writer/server_state.h"

namespace docent::server {

// A run as the newest version knows it.
struct KnownRun {
  RunId run;
  std::string workflow;
  std::string flow;
  std::string parent;         // run id; empty: it is nested in none
  TimeMicros started_us = 0;  // to the millisecond
  TimeMicros ended_us = 0;    // likewise; 0: it is live
};
// NOT_FOUND: the graph has no such run, or no longer.
absl::StatusOr<KnownRun> FindRun(const Dictionary& dictionary, const GraphVersion& newest, const RunId& run,
                                 const Limits& limits);

class CaseRecorder {
 public:
  struct Ports {
    log::ContextLog* log = nullptr;
    const sparql::FunctionRegistry* functions = nullptr;
    Limits limits;
    ReplayLimits replay_limits;
    Cancellation* cancellation = nullptr;
  };
  explicit CaseRecorder(const Ports& ports) : ports_(ports) {}

  // The whole life of a run, up to `newest`. OUT_OF_RANGE: the log no longer has its begin; the oldest turn that it has is named.
  // RESOURCE_EXHAUSTED naming the limit. FAILED_PRECONDITION: a run that is nested, or of a robot service alone.
  absl::StatusOr<RunCase> Record(const KnownRun& run, uint64_t newest);

  // The moment of one node: a case of one turn, on the facts after turn `at`, whose values are the variables that the run had
  // then. Without `at`: of the turn in which the node opened last, with the variables before it, or if it never opened, of the
  // last turn of the run. OUT_OF_RANGE: the run did not exist at that turn, or as above.
  absl::StatusOr<RunCase> Moment(const KnownRun& run, const std::string& node, std::optional<uint64_t> at,
                                 uint64_t newest);
  // The world after turn `at` for a simulated run of a workflow, which need not be deployed: facts, documents and held robots. The
  // first turn is that one. OUT_OF_RANGE, RESOURCE_EXHAUSTED as above.
  absl::StatusOr<RunCase> World(const std::string& workflow, uint64_t at);

 private:
  struct Life {
    uint64_t first = 0;
    uint64_t last = 0;
  };
  absl::StatusOr<Life> FindLife(const KnownRun& run, uint64_t newest);
  // The turn of that time, within a millisecond, in which the run came into one of the states; nullopt: there is none.
  absl::StatusOr<std::optional<uint64_t>> FindTurn(const RunId& run, TimeMicros time_us, bool begins,
                                                   uint64_t newest);
  absl::StatusOr<uint64_t> FirstAtOrAfter(TimeMicros time_us, uint64_t newest);
  // The turn of the life in which the node opened last; 0: in none.
  absl::StatusOr<uint64_t> MomentOf(const KnownRun& run, const std::string& node, const Life& life);
  absl::StatusOr<RestoredState> StagesAfter(uint64_t offset, const std::string& what, Dictionary* dictionary);
  absl::Status NoLongerKept(const std::string& what);
  absl::Status CheckLength(uint64_t from, uint64_t to) const;

  const Ports ports_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_CASE_RECORDER_H_
