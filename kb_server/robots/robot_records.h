// Robots as the graph has them: state, address, operations, pose. The reading side of robot_facts.h. Values; any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_ROBOT_RECORDS_H_
#define DOCENT_KB_SERVER_ROBOTS_ROBOT_RECORDS_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_reader.h"
#include "graph/store/graph_version.h"
#include "workflow/engine/state/ports.h"
#include "workflow/rsel/feasibility.h"

namespace docent::server {

// An invocation that a robot works for, or whose command it has yet to end.
struct RobotTaskRecord {
  RunId run;
  std::string node, operation, step;
};

struct RobotRecord {
  enum class State { kOffline, kMaintenance, kCharging, kBusy, kStandby };

  std::string robot;  // IRI
  std::string label;
  std::string address;  // of its adapter; empty: it has never joined
  std::string incarnation;
  State state = State::kOffline;
  std::optional<std::string> out_of_service;  // why, for people; nullopt: it is in service
  std::vector<std::string> operations;        // names
  std::vector<std::string> capabilities;      // IRIs of the classes that it says its operations are of
  TimeMicros last_seen_us = 0;                // of a robot that was lost; 0: not known
  std::optional<double> x_m, y_m, heading_rad;
  std::vector<std::string> regions;  // IRIs
  RunId held_by;                     // the outermost run that holds it; empty: none
  std::vector<RobotTaskRecord> held_for;
  std::vector<engine::Reservation> reservations;  // the one that counts before the others in front
  std::vector<std::string> ending_commands;       // ids of those that were cancelled and have not ended
};

// "offline", "maintenance", "charging", "busy", "standby".
std::string_view ToString(RobotRecord::State state);
// The first of these that is told of the robot; kOffline where no status is.
RobotRecord::State RobotStateOf(const GraphReader& graph, const std::string& robot);

// All robots, in order of their IRIs.
std::vector<RobotRecord> ReadRobots(const Dictionary& dictionary, const GraphVersion& version);

// IRIs of the robots that have joined and whose own graph does not say docent:Offline.
std::vector<std::string> RobotsOnline(const Dictionary& dictionary, const GraphVersion& version);

// The operations that robots offer, each once, and what they say of their inputs (in each robot's own graph).
std::vector<rsel::OfferedOperation> OfferedOperations(const Dictionary& dictionary,
                                                      const GraphVersion& version);

// Where a robot's adapter serves, and which incarnation of it.
struct AdapterAddress {
  RobotId robot;
  std::string address;  // HOST:PORT
  std::string incarnation;
};
// From the robot's own graph; from all graphs only where that has no address, so that a client cannot redirect the commands of a
// robot that has joined. Empty address: no graph has one.
AdapterAddress AdapterOf(const GraphReader& graph, const std::string& robot);
std::vector<AdapterAddress> AdapterAddresses(const Dictionary& dictionary, const GraphVersion& version);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_ROBOT_RECORDS_H_
