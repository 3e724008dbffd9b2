// Facts of a robot's presence: that it joined, with its description; that its lease ran out, or that it left. The writing side of
// robot_records.h. Values; any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_ROBOT_FACTS_H_
#define DOCENT_KB_SERVER_ROBOTS_ROBOT_FACTS_H_

#include <string>
#include <vector>

#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"
#include "workflow/rsel/part_types.h"

namespace docent::server {

struct OperationDescription {
  std::string name;
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  bool idempotent = false;
  std::vector<std::string> occupies = {};  // resources of the robot; empty: all of it
  rsel::PartTypes input_types = {};        // of parts that have one; with a well-known prefix, too
  rsel::PartTypes output_types = {};
  std::string description = {};                // for people
  std::vector<std::string> capabilities = {};  // IRIs of classes of capability; with a well-known prefix, too
};

// What a robot says of itself when it joins.
struct RobotDescription {
  std::string robot;  // IRI
  std::string type;   // IRI of a class beside docent:Robot; empty: none
  std::string label;  // empty: none
  std::string incarnation;
  std::string address;  // HOST:PORT of its adapter
  std::vector<OperationDescription> operations;
};

// Why no robot can be named so; empty: one can. What a robot tells lies in the graph of its own name: that is none of the server's
// own graphs, nor anything else that the server names.
std::string RobotNameFault(const std::string& robot);

// A description without what cannot be taken: operations without a name that can stand in documents and IRIs, or named
// twice; parts likewise; a class, a part's type or a capability that is no IRI. Types are written in full. `warnings` say what was left out, each on one line.
RobotDescription AcceptedDescription(RobotDescription description, std::vector<std::string>* warnings);

// Told by the robot itself: who it is, what it offers, where its adapter listens. Replaces what an earlier join told.
// `description` is one that AcceptedDescription gave.
WriteBatch FactsOfJoin(const RobotDescription& description, const Dictionary& dictionary,
                       const GraphVersion& version);

// Whether the graph still has what FactsOfJoin told: somebody may have cleared it.
bool HasFacts(const WriteBatch& told, const Dictionary& dictionary, const GraphVersion& version);

// The robot is docent:Offline; `seen_us` is when it last showed itself (docent:lastSeenAt; 0: not known here). The states
// that it told go, since nobody knows whether they still hold; docent:x, y and heading stay, as of then.
WriteBatch FactsOfLoss(const std::string& robot, TimeMicros seen_us, const Dictionary& dictionary,
                       const GraphVersion& version);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_ROBOT_FACTS_H_
