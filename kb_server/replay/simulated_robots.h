// Simulated robots: how long a command takes a robot that only a simulation has, and where that is meanwhile. A command that names
// a place drives there in a straight line, one that names a text speaks it, any other takes a moment. All succeed.
// Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_REPLAY_SIMULATED_ROBOTS_H_
#define DOCENT_KB_SERVER_REPLAY_SIMULATED_ROBOTS_H_

#include <set>
#include <string>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "kb_server/replay/run_case.h"

namespace docent::server {

inline constexpr double kSimulatedSpeed = 0.6;  // m/s
inline constexpr double kSimulatedWordsPerSecond = 2.5;
inline constexpr double kSimulatedMoment = 3;  // s

// A robot's position in the hall's frame.
struct SimulatedPose {
  TimeMicros time_us = 0;
  CommandId command;
  RobotId robot;
  double x_m = 0, y_m = 0;
  std::string place;  // IRI: where it arrives with it; empty: on the way
};

struct SimulatedCommand {
  TimeMicros ends_us = 0;
  std::vector<SimulatedPose> poses;  // one a second, the last where it ends; none: it does not drive
};
// The graph has the pose of the robot, and the places.
SimulatedCommand SimulateCommand(const Decision& command, const Dictionary& dictionary,
                                 const GraphVersion& graph);

// Makes the robots of a case ready: they know where they are, and none is offline, busy, charging, out of service or held. A robot
// that never joined offers all of `operations`; where there is none and robots do not offer all of them, one more robot does.
// What was done, for people.
std::vector<std::string> ReadyRobots(const std::set<std::string>& operations, RunCase* world);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_SIMULATED_ROBOTS_H_
