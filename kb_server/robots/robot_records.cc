#include "kb_server/robots/robot_records.h"

#include <algorithm>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/robots/measures.h"
#include "kb_server/robots/service_state.h"

namespace docent::server {
namespace {

std::vector<std::string> RobotIris(const GraphReader& graph) {
  return graph.Subjects(kRdfType, Term::Iri(DocentIri("Robot")));
}

void ReadHold(const GraphReader& graph, const std::string& robot, RobotRecord* out) {
  if (auto run = RunOfIri(graph.Object(robot, DocentIri("heldBy")))) out->held_by = *std::move(run);
  for (const Term& invocation : graph.Objects(robot, DocentIri("heldFor"))) {
    const std::string& iri = invocation.lexical;
    const std::string node = graph.Object(iri, DocentIri("ofNode"));
    out->held_for.push_back({RunOfIri(graph.Object(node, DocentIri("ofRun"))).value_or(RunId()),
                             graph.Object(node, DocentIri("nodeName")),
                             graph.Object(iri, DocentIri("operation")),
                             graph.Object(iri, DocentIri("step"))});
  }
  for (const Term& command : graph.Objects(robot, DocentIri("endingCommand")))
    out->ending_commands.push_back(command.lexical);
}

RobotRecord ReadRobot(const GraphReader& graph, const std::string& robot) {
  RobotRecord out;
  out.robot = robot;
  out.label = graph.Object(robot, Concat(kRdfsNs, "label"));
  out.address = graph.Object(robot, DocentIri("adapterAddress"));
  out.incarnation = graph.Object(robot, DocentIri("incarnation"));
  out.state = RobotStateOf(graph, robot);
  out.out_of_service = OutOfServiceReason(graph, robot);
  ReadHold(graph, robot, &out);
  for (const Term& operation : graph.Objects(robot, DocentIri("offers")))
    out.operations.push_back(OperationOfIri(operation.lexical).value_or(operation.lexical));
  out.last_seen_us = MicrosOfDateTime(graph.Object(robot, DocentIri("lastSeenAt")));
  const auto measure = [&](const char* local) {
    return MeasureOf(local, graph.Objects(robot, DocentIri(local)));
  };
  out.x_m = measure("x");
  out.y_m = measure("y");
  out.heading_rad = measure("heading");
  for (const Term& region : graph.Objects(robot, DocentIri("isAt"))) out.regions.push_back(region.lexical);
  return out;
}

}  // namespace

std::string_view ToString(RobotRecord::State state) {
  switch (state) {
    case RobotRecord::State::kOffline:
      return "offline";
    case RobotRecord::State::kMaintenance:
      return "maintenance";
    case RobotRecord::State::kCharging:
      return "charging";
    case RobotRecord::State::kBusy:
      return "busy";
    case RobotRecord::State::kStandby:
      return "standby";
  }
  return "";
}

RobotRecord::State RobotStateOf(const GraphReader& graph, const std::string& robot) {
  using State = RobotRecord::State;
  static constexpr std::pair<const char*, State> kStates[] = {{"Offline", State::kOffline},
                                                              {"Maintenance", State::kMaintenance},
                                                              {"Charging", State::kCharging},
                                                              {"Busy", State::kBusy},
                                                              {"Standby", State::kStandby}};
  const std::vector<Term> told = graph.Objects(robot, DocentIri("status"));
  for (const auto& [local, state] : kStates) {
    if (std::find(told.begin(), told.end(), Term::Iri(DocentIri(local))) != told.end()) return state;
  }
  return State::kOffline;
}

std::vector<RobotRecord> ReadRobots(const Dictionary& dictionary, const GraphVersion& version) {
  const GraphReader graph(dictionary, version);
  std::vector<RobotRecord> robots;
  for (const std::string& robot : RobotIris(graph)) robots.push_back(ReadRobot(graph, robot));
  return robots;
}

std::vector<std::string> RobotsOnline(const Dictionary& dictionary, const GraphVersion& version) {
  const GraphReader graph(dictionary, version);
  std::vector<std::string> robots = RobotIris(graph);
  std::erase_if(robots, [&graph](const std::string& robot) {
    return graph.Object(robot, DocentIri("adapterAddress")).empty() ||
           graph.Object(robot, DocentIri("status")) == DocentIri("Offline");
  });
  return robots;
}

std::vector<rsel::OfferedOperation> OfferedOperations(const Dictionary& dictionary,
                                                      const GraphVersion& version) {
  std::vector<rsel::OfferedOperation> offered;
  const auto offers = dictionary.FindIri(DocentIri("offers")),
             known = dictionary.FindIri(DocentIri("inputsKnown")),
             input = dictionary.FindIri(DocentIri("input")), yes = dictionary.Find(Term::Boolean(true));
  if (!offers) return offered;
  version.ForEach({{}, *offers, {}, {}}, [&](const Quad& quad) {
    std::optional<std::string> name = OperationOfIri(dictionary.Decode(quad.object).lexical);
    if (!name) return true;
    rsel::OfferedOperation operation;
    operation.robot = RobotId(dictionary.Decode(quad.subject).lexical);
    operation.name = *std::move(name);
    operation.inputs_known = known && yes && version.ContainsMatch({quad.object, *known, *yes, quad.subject});
    if (operation.inputs_known && input) {
      version.ForEach({quad.object, *input, {}, quad.subject}, [&](const Quad& part) {
        operation.inputs.push_back(dictionary.Decode(part.object).lexical);
        return true;
      });
    }
    offered.push_back(std::move(operation));
    return true;
  });
  return offered;
}

std::vector<AdapterAddress> AdapterAddresses(const Dictionary& dictionary, const GraphVersion& version) {
  std::vector<AdapterAddress> addresses;
  const std::optional<TermId> address = dictionary.FindIri(DocentIri("adapterAddress"));
  if (!address) return addresses;
  version.ForEach({{}, *address, {}, {}}, [&](const Quad& quad) {
    addresses.push_back(
        {RobotId(dictionary.Decode(quad.subject).lexical), dictionary.Decode(quad.object).lexical});
    return true;
  });
  return addresses;
}

}  // namespace docent::server
