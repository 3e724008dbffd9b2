// Limits of replays of recorded runs, and of runs saved as tests. As in limits.h, an error at a limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_REPLAY_LIMITS_H_
#define DOCENT_GRAPH_BASE_REPLAY_LIMITS_H_

#include <cstddef>

namespace docent {

struct ReplayLimits {
  size_t replay_turns = 200000;    // turns of the life of one run that is replayed
  size_t replay_facts = 500000;    // facts of the graph before that run, and changes of facts in its life
  int replay_timeout_ms = 120000;  // time of one replay
  size_t saved_run_bytes = 256u << 20;  // file of a saved run
};

inline constexpr ReplayLimits kReplayLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_REPLAY_LIMITS_H_
