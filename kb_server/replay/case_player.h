// Player of cases: lives the life of a recorded run again with a document, on the recorded facts and answers, without robots.
//
// Rules, conditions and the workflow engine are the server's own, on stages of the replay's own, and each recorded turn is a turn
// (kb_server/turn/turn.h). Only the one run lives: what other runs told and which robots they held is as recorded. So are the
// facts that came of the commands of the recorded run (a robot that arrives), also where the played run sends others.
// Timers of the run fire between the recorded turns when they are due. A simulation is the same with a case that was never
// recorded: simulated robots answer. One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_CASE_PLAYER_H_
#define DOCENT_KB_SERVER_REPLAY_CASE_PLAYER_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/base/replay_limits.h"
#include "graph/sparql/values/function_registry.h"
#include "kb_server/replay/run_case.h"
#include "kb_server/replay/simulated_robots.h"
#include "workflow/cawl/ast.h"

namespace docent::server {

// What a node, or the activator, waits for when a replay ends.
struct PlayedWait {
  std::string node;     // path; kActivator: the activator
  std::string ask;      // SPARQL
  std::string missing;  // facts that it needs, or that stand in its way, for people; empty: not known
};
inline constexpr char kActivator[] = "activator";
// The next alternative of the condition of one node: what it waits for, and what it lacks, of all of them.
void AddAlternative(const PlayedWait& wait, std::string* waits_for, std::string* missing);

struct Play {
  Course course;
  // Why it ended before the run did: "there is no recorded report of …"; empty: the run has ended, or the recorded one had not
  // either.
  std::string stopped;
  std::string stopped_node;  // path
  uint64_t stopped_turn = 0;
  std::vector<PlayedWait> waits;
  std::string pending;               // why the invocation that waits first, if one does, has no robot
  std::vector<std::string> notes;    // what the replay cannot tell, for people
  std::vector<SimulatedPose> poses;  // of a simulation
};

// A simulation lasts no longer.
inline constexpr TimeMicros kLongestSimulation = 24 * 3600 * 1'000'000LL;

struct PlayOptions {
  const sparql::FunctionRegistry* functions = nullptr;
  Limits limits;
  ReplayLimits replay_limits;
  Cancellation* cancellation = nullptr;  // required
  // A command without a recorded report is taken to have succeeded at once; else the replay ends there.
  bool assume_done = false;
  // Not 0: the case is a simulation. Simulated robots answer (simulated_robots.h), the turns behind the first one are asserted
  // facts, and it goes on until the run has ended, nothing more can happen or this time has come. A run of the activator's
  // flow takes the values with which that fires; where it does not fire, the run is started all the same.
  TimeMicros simulated_until_us = 0;
};

// INVALID_ARGUMENT: the document is of another workflow, or has not the flow that was asked for; or a recorded turn or document
// cannot be. RESOURCE_EXHAUSTED naming the limit; CANCELLED, DEADLINE_EXCEEDED.
absl::StatusOr<Play> PlayCase(const RunCase& recorded, const cawl::DocumentPtr& document,
                              const PlayOptions& options);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_CASE_PLAYER_H_
