#include "kb_server/replay/simulated_robots.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/number_literal.h"
#include "graph/rdf/vocabulary.h"
#include "maps/geometry.h"
#include "maps/roadmap.h"

namespace docent::server {
namespace {

constexpr char kHasGeometry[] = "http://www.opengis.net/ont/geosparql#hasGeometry";
constexpr char kAsWkt[] = "http://www.opengis.net/ont/geosparql#asWKT";
constexpr char kExtraRobot[] = "urn:docent:robot:simulated";
constexpr TimeMicros kSecond = 1'000'000;

std::optional<double> NumberOf(const GraphReader& graph, const std::string& thing, const char* property) {
  for (const Term& value : graph.Objects(thing, DocentIri(property))) {
    if (const std::optional<double> number = FiniteNumber(value)) return number;
  }
  return std::nullopt;
}

// Where a thing stands itself: its pose, else the point where robots serve it, else its geometry.
std::optional<maps::Point2> OwnPosition(const GraphReader& graph, const std::string& thing) {
  const std::optional<double> x = NumberOf(graph, thing, "x"), y = NumberOf(graph, thing, "y");
  if (x && y) return maps::Point2{*x, *y};
  for (const std::string& property : {DocentIri("servicePoint"), std::string(kHasGeometry)}) {
    for (const Term& point : graph.Objects(thing, property)) {
      for (const Term& wkt : graph.Objects(point.lexical, kAsWkt)) {
        if (const auto read = maps::ReadPoint(wkt.lexical); read.ok()) return *read;
      }
    }
  }
  return std::nullopt;
}

// That, or where the place is that the thing is at.
std::optional<maps::Point2> PositionOf(const GraphReader& graph, const Term& thing) {
  if (!thing.IsIri()) return std::nullopt;
  if (const auto own = OwnPosition(graph, thing.lexical)) return own;
  for (const Term& place : graph.Objects(thing.lexical, DocentIri("isAt"))) {
    if (const auto there = OwnPosition(graph, place.lexical)) return there;
  }
  return std::nullopt;
}

double SecondsOfText(const std::string& text) {
  const std::vector<std::string> words = absl::StrSplit(text, ' ', absl::SkipWhitespace());
  return 1 + static_cast<double>(words.size()) / kSimulatedWordsPerSecond;
}

TimeMicros Micros(double seconds) {
  return static_cast<TimeMicros>(std::llround(seconds * static_cast<double>(kSecond)));
}

// As the operation is described: other operations are about places, too.
bool Drives(const GraphReader& graph, const std::string& operation) {
  const std::string iri = OperationIri(operation);
  const std::vector<Term> occupies = graph.Objects(iri, DocentIri("occupies")),
                          capabilities = graph.Objects(iri, DocentIri("capability"));
  return std::count(occupies.begin(), occupies.end(), Term::Literal("base")) > 0 ||
         std::count(capabilities.begin(), capabilities.end(), Term::Iri(DocentIri("Navigation"))) > 0;
}

// The robot drives from where it is, or is at once where nobody knows where it is.
void Drive(const Decision& command, maps::Point2 from, maps::Point2 to, SimulatedCommand* simulated) {
  const double seconds = maps::Distance(from, to) / kSimulatedSpeed;
  const auto pose = [&](double at) {
    const double share = seconds == 0 ? 1 : std::min(1.0, at / seconds);
    simulated->poses.push_back({command.time_us + Micros(at), command.command, command.robot,
                                from.x_m + share * (to.x_m - from.x_m),
                                from.y_m + share * (to.y_m - from.y_m)});
  };
  for (double at = 1; at < seconds; ++at) pose(at);
  pose(seconds);
  simulated->ends_us = command.time_us + Micros(seconds);
}

}  // namespace

SimulatedCommand SimulateCommand(const Decision& command, const GraphReader& graph) {
  SimulatedCommand simulated;
  simulated.ends_us = command.time_us + Micros(kSimulatedMoment);
  double speaking = 0;
  for (const auto& [name, value] : command.arguments) {
    if (value.IsLiteral() && FiniteNumber(value) == std::nullopt)
      speaking = std::max(speaking, SecondsOfText(value.lexical));
  }
  if (speaking > 0) simulated.ends_us = command.time_us + Micros(speaking);
  if (!Drives(graph, command.operation)) return simulated;
  for (const auto& [name, value] : command.arguments) {
    const auto to = PositionOf(graph, value);
    if (!to) continue;
    Drive(command, OwnPosition(graph, command.robot.value()).value_or(*to), *to, &simulated);
    break;
  }
  return simulated;
}

std::vector<std::string> ReadyRobots(const std::set<std::string>& operations, RunCase* world) {
  std::vector<std::string> notes;
  std::set<std::string> robots, joined, hindered;
  std::set<std::string> offered;
  for (const TermQuad& fact : world->facts) {
    const std::string& predicate = fact.predicate.lexical;
    if (predicate == kRdfType && fact.object.lexical == DocentIri("Robot"))
      robots.insert(fact.subject.lexical);
    if (predicate == DocentIri("incarnation")) joined.insert(fact.subject.lexical);
    if (predicate != DocentIri("offers")) continue;
    if (const auto name = OperationOfIri(fact.object.lexical)) offered.insert(*name);
  }
  std::erase_if(world->facts, [&](TermQuad& fact) {
    if (!robots.contains(fact.subject.lexical)) return false;
    // Where it drives is told in its own graph: one that was told elsewhere must not stay behind.
    if (fact.predicate.lexical == DocentIri("x") || fact.predicate.lexical == DocentIri("y"))
      fact.graph = fact.subject;
    const bool status = fact.predicate.lexical == DocentIri("status");
    if (!status && fact.predicate.lexical != DocentIri("outOfService")) return false;
    if (!status || fact.object.lexical != DocentIri("Standby")) hindered.insert(fact.subject.lexical);
    return true;
  });
  for (const auto& [robot, run] : std::exchange(world->held, {})) hindered.insert(robot.value());
  const auto tell = [world](const std::string& robot, std::string_view property, Term value) {
    world->facts.push_back(
        {Term::Iri(robot), Term::Iri(DocentIri(property)), std::move(value), Term::Iri(robot)});
  };
  for (const std::string& robot : robots) {
    tell(robot, "status", Term::Iri(DocentIri("Standby")));
    if (!joined.contains(robot)) tell(robot, "incarnation", Term::Literal("simulated"));
  }
  if (!hindered.empty()) {
    notes.push_back(absl::StrCat(
        "taken to be ready: ", absl::StrJoin(hindered, ", ", [](std::string* out, const std::string& robot) {
          absl::StrAppend(out, "<", robot, ">");
        })));
  }
  std::vector<std::string> missing;
  std::set_difference(operations.begin(), operations.end(), offered.begin(), offered.end(),
                      std::back_inserter(missing));
  if (missing.empty()) return notes;
  world->facts.push_back({Term::Iri(kExtraRobot), Term::Iri(std::string(kRdfType)),
                          Term::Iri(DocentIri("Robot")), Term::Iri(kExtraRobot)});
  tell(kExtraRobot, "status", Term::Iri(DocentIri("Standby")));
  tell(kExtraRobot, "incarnation", Term::Literal("simulated"));
  for (const std::string& operation : operations)
    tell(kExtraRobot, "offers", Term::Iri(OperationIri(operation)));
  notes.push_back(absl::StrCat("no robot offers ", absl::StrJoin(missing, ", "), ": a simulated one does (<",
                               kExtraRobot, ">)"));
  return notes;
}

}  // namespace docent::server
