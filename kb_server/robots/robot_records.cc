#include "kb_server/robots/robot_records.h"

#include <algorithm>
#include <set>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/robots/measures.h"
#include "kb_server/robots/operation_facts.h"
#include "kb_server/robots/reservations.h"
#include "kb_server/robots/service_state.h"

namespace docent::server {

AdapterAddress AdapterOf(const GraphReader& graph, const std::string& robot) {
  const GraphReader own = graph.In(robot);
  const GraphReader& told = own.Object(robot, DocentIri("adapterAddress")).empty() ? graph : own;
  return {RobotId(robot), told.Object(robot, DocentIri("adapterAddress")),
          told.Object(robot, DocentIri("incarnation"))};
}

namespace {

std::vector<std::string> RobotIris(const GraphReader& graph) {
  return graph.Subjects(kRdfType, Term::Iri(DocentIri("Robot")));
}

void ReadHold(const GraphReader& all, const std::string& robot, RobotRecord* out) {
  const GraphReader graph = all.In(kRunsGraph);
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

// What it says itself, without the classes above that are inferred.
std::vector<std::string> ToldCapabilities(const Dictionary& dictionary, const GraphVersion& version,
                                          const std::string& robot) {
  std::vector<std::string> classes;
  const auto id = dictionary.FindIri(robot), property = dictionary.FindIri(DocentIri("hasCapability"));
  if (!id || !property) return classes;
  version.ForEach({*id, *property, {}, *id}, [&](const Quad& quad) {
    classes.push_back(dictionary.Decode(quad.object).lexical);
    return true;
  });
  std::sort(classes.begin(), classes.end());
  return classes;
}

RobotRecord ReadRobot(const GraphReader& graph, const std::string& robot) {
  RobotRecord out;
  out.robot = robot;
  out.label = graph.Object(robot, Concat(kRdfsNs, "label"));
  out.address = AdapterOf(graph, robot).address;
  out.incarnation = AdapterOf(graph, robot).incarnation;
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
  const std::vector<engine::Reservation> reservations = ReadReservations(dictionary, version);
  for (const std::string& robot : RobotIris(graph)) {
    robots.push_back(ReadRobot(graph, robot));
    robots.back().capabilities = ToldCapabilities(dictionary, version, robot);
    for (const engine::Reservation& reservation : reservations) {
      if (reservation.robots.contains(RobotId(robot))) robots.back().reservations.push_back(reservation);
    }
  }
  return robots;
}

std::vector<std::string> RobotsOnline(const Dictionary& dictionary, const GraphVersion& version) {
  const GraphReader graph(dictionary, version);
  std::vector<std::string> robots = RobotIris(graph);
  std::erase_if(robots, [&graph](const std::string& robot) {
    const std::vector<Term> told = graph.In(robot).Objects(robot, DocentIri("status"));
    return AdapterOf(graph, robot).address.empty() ||
           std::find(told.begin(), told.end(), Term::Iri(DocentIri("Offline"))) != told.end();
  });
  return robots;
}

std::vector<rsel::OfferedOperation> OfferedOperations(const Dictionary& dictionary,
                                                      const GraphVersion& version) {
  std::vector<rsel::OfferedOperation> offered;
  const GraphReader graph(dictionary, version);
  const auto offers = dictionary.FindIri(DocentIri("offers"));
  if (!offers) return offered;
  std::set<std::pair<TermId, TermId>> known;  // told in several graphs
  version.ForEach({{}, *offers, {}, {}}, [&](const Quad& quad) {
    if (!known.emplace(quad.subject, quad.object).second) return true;
    const std::string iri = dictionary.Decode(quad.object).lexical;
    std::optional<std::string> name = OperationOfIri(iri);
    if (!name) return true;
    rsel::OfferedOperation operation;
    operation.robot = RobotId(dictionary.Decode(quad.subject).lexical);
    operation.name = *std::move(name);
    const OperationFacts facts(graph, operation.robot.value(), iri);
    operation.capabilities = facts.Capabilities();
    if (std::optional<std::vector<std::string>> inputs = facts.Inputs()) {
      operation.inputs_known = true;
      operation.inputs = *std::move(inputs);
      operation.outputs = facts.Outputs();
      operation.input_types = facts.InputTypes();
      operation.output_types = facts.OutputTypes();
      operation.idempotent = facts.Idempotent();
      operation.description = facts.Description();
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
  const GraphReader graph(dictionary, version);
  version.ForEach({{}, *address, {}, {}}, [&](const Quad& quad) {
    addresses.push_back(AdapterOf(graph, dictionary.Decode(quad.subject).lexical));
    return true;
  });
  return addresses;
}

}  // namespace docent::server
