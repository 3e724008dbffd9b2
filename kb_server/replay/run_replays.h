// Replays of runs of a running server: each makes past stages again, which takes memory and time. Beside the writer, on the
// thread that asks; any thread. Who asks sees to it that there are not too many at a time.
#ifndef DOCENT_KB_SERVER_REPLAY_RUN_REPLAYS_H_
#define DOCENT_KB_SERVER_REPLAY_RUN_REPLAYS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/replay_limits.h"
#include "graph/log/context_log.h"
#include "kb_server/door/query_port.h"
#include "kb_server/replay/case_player.h"
#include "kb_server/replay/case_recorder.h"
#include "kb_server/replay/play_difference.h"

namespace docent::server {

// A replay and what came of it.
struct Replayed {
  RunCase recorded;
  Play play;
  std::vector<NodeComparison> nodes;
};
// Plays a case with a document, or where `text` is empty with the one that ran, and compares. `services`: robot services in
// place of those of then (played_document.h). Where what is edited does otherwise, the case as it ran is played, too: what
// that does otherwise than it was recorded is noted in play.notes.
absl::StatusOr<Replayed> ReplayCase(RunCase recorded, const std::string& text, const std::string& name,
                                    const PlayOptions& options, const std::vector<Document>& services = {});

// What one node does at one moment.
struct Trial {
  RunCase moment;
  Play play;
};

// What a simulation is told while it runs.
struct SimulatedTelling {
  TimeMicros after_us = 0;  // the begin
  std::vector<QuadOperation> changes;
};

// A run of a document on the facts of one turn, with simulated robots.
struct SimulationRequest {
  std::string text, name;  // the document, and its name for people
  std::string flow;        // empty: the activator's; without one, the first
  NamedTerms arguments;
  std::vector<SimulatedTelling> told;
  TimeMicros lasting_us = 0;     // at most
  std::optional<uint64_t> turn;  // on the facts after it; none: of the newest, at `now_us`
  TimeMicros now_us = 0;
};
struct Simulation {
  RunCase world;
  Play play;
};

class RunReplays {
 public:
  struct Ports {
    log::ContextLog* log = nullptr;
    const QueryPort* queries = nullptr;
    const Dictionary* dictionary = nullptr;  // of its versions
    const sparql::FunctionRegistry* functions = nullptr;
    Limits limits;
    ReplayLimits replay_limits;
  };
  // Everything must outlive it.
  explicit RunReplays(const Ports& ports) : ports_(ports) {}

  // Errors as those of CaseRecorder and PlayCase.
  absl::StatusOr<Replayed> Replay(const RunId& run, const std::string& text, const std::string& name,
                                  bool assume_done, Cancellation* cancellation);
  absl::StatusOr<Trial> TryNode(const RunId& run, const std::string& node, std::optional<uint64_t> turn,
                                const std::string& text, const std::string& name, Cancellation* cancellation);
  // INVALID_ARGUMENT: the document has errors, or no such flow; NOT_FOUND, OUT_OF_RANGE: of the turn.
  absl::StatusOr<Simulation> Simulate(const SimulationRequest& request, Cancellation* cancellation);
  // The case, and what a replay of it does otherwise.
  absl::StatusOr<Replayed> Save(const RunId& run, Cancellation* cancellation);

  int timeout_ms() const { return ports_.replay_limits.replay_timeout_ms; }

 private:
  absl::StatusOr<KnownRun> Find(const RunId& run, uint64_t* newest) const;
  CaseRecorder Recorder(Cancellation* cancellation) const;
  PlayOptions Options(bool assume_done, Cancellation* cancellation) const;

  const Ports ports_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_RUN_REPLAYS_H_
