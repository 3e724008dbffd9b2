// Decisions of a turn: transitions of workflow runs, and robot commands. The log records them, and replay
// compares them. The answer to a command, CommandReport, is input (write_batch.h). Values; any thread.
#ifndef DOCENT_GRAPH_STORE_DECISIONS_H_
#define DOCENT_GRAPH_STORE_DECISIONS_H_

#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"

namespace docent {

// One state change of a run, a node of a run or an invocation of a node.
struct Transition {
  std::string subject;  // "BoothGuide-1", "BoothGuide-1/Move2Booth" or "BoothGuide-1/Move2Booth/0/showBooth"
  std::string from;     // state words of the vocabulary: "waiting", "running", …; empty: new
  std::string to;
  std::string cause;  // for people: the reason

  friend bool operator==(const Transition&, const Transition&) = default;
};

// One operation for one robot, with everything needed to send it again after a restart.
struct RobotCommand {
  CommandId id;   // run/node/iteration/invoke/step/attempt@time: an adapter executes each id at most once
  RobotId robot;  // IRI
  std::string operation;
  std::vector<std::pair<std::string, Term>> arguments;  // parameter name → value, in the operation's order
  // The adapter's incarnation at the decision; after a change the outcome is unknown. Empty: any.
  std::string expected_incarnation;
  Revision guard_revision;     // the decision is based on the facts of this revision
  TimeMicros deadline_us = 0;  // the adapter gives up at this time; 0: none
  bool idempotent = false;     // may be sent again when its outcome is unknown

  friend bool operator==(const RobotCommand&, const RobotCommand&) = default;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_DECISIONS_H_
