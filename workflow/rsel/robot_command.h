// A command of the engine to one robot. Value; any thread.
#ifndef DOCENT_WORKFLOW_RSEL_ROBOT_COMMAND_H_
#define DOCENT_WORKFLOW_RSEL_ROBOT_COMMAND_H_

#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"

namespace docent {

struct RobotCommand {
  CommandId id;   // run/node/iteration/invoke/step/attempt@time: an adapter never does the same id twice
  RobotId robot;  // IRI
  std::string operation;
  std::vector<std::pair<std::string, Term>> arguments;  // input part → value
  std::string
      expected_incarnation;    // of the robot's adapter when this was decided; another one: outcome unknown
  Revision guard_revision;     // the facts that made the engine decide are those of this revision
  TimeMicros deadline_us = 0;  // the adapter gives up then; 0: none
  bool idempotent = false;     // may be sent again when its outcome is unknown

  friend bool operator==(const RobotCommand&, const RobotCommand&) = default;
};

}  // namespace docent

#endif  // DOCENT_WORKFLOW_RSEL_ROBOT_COMMAND_H_
