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
#include "graph/store/graph_reader.h"
#include "maps/geometry.h"
#include "maps/roadmap.h"

namespace docent::server {
namespace {

constexpr char kHasGeometry[] = "http://www.opengis.net/ont/geosparql#hasGeometry";
constexpr char kAsWkt[] = "http://www.opengis.net/ont/geosparql#asWKT";
constexpr char kExtraRobot[] = "urn:docent:robot:simulated";
constexpr TimeMicros kSecond = 1'000'000;

class Places {
 public:
  Places(const Dictionary& dictionary, const GraphVersion& graph)
      : dictionary_(dictionary), graph_(dictionary, graph) {}

  // Where a thing stands itself: its pose, else the point where robots serve it, else its geometry.
  std::optional<maps::Point2> Of(const Term& thing) const {
    const std::optional<double> x = Number(thing, "x"), y = Number(thing, "y");
    if (x && y) return maps::Point2{*x, *y};
    for (const std::string& property : {DocentIri("servicePoint"), std::string(kHasGeometry)}) {
      for (const Term& point : Objects(thing, property)) {
        for (const Term& wkt : Objects(point, kAsWkt)) {
          if (const auto read = maps::ReadPoint(wkt.lexical); read.ok()) return *read;
        }
      }
    }
    return std::nullopt;
  }

  std::vector<Term> Objects(const Term& subject, std::string_view property) const {
    const std::optional<TermId> id = dictionary_.Find(subject);  // points are often blank nodes
    return id ? graph_.Objects(*id, property) : std::vector<Term>();
  }

 private:
  std::optional<double> Number(const Term& thing, const char* property) const {
    for (const Term& value : Objects(thing, DocentIri(property))) {
      if (const std::optional<double> number = FiniteNumber(value)) return number;
    }
    return std::nullopt;
  }

  const Dictionary& dictionary_;
  const GraphReader graph_;
};

// A place, or where a person is.
struct Destination {
  maps::Point2 point;
  std::string place;
};
std::optional<Destination> DestinationOf(const Places& places, const Term& thing) {
  if (!thing.IsIri()) return std::nullopt;
  const std::vector<Term> at = places.Objects(thing, DocentIri("isAt"));
  if (const auto own = places.Of(thing))
    return Destination{*own, at.empty() ? thing.lexical : at.front().lexical};
  for (const Term& place : at) {
    if (const auto there = places.Of(place)) return Destination{*there, place.lexical};
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
bool Drives(const Places& places, const std::string& operation) {
  const Term iri = Term::Iri(OperationIri(operation));
  const std::vector<Term> occupies = places.Objects(iri, DocentIri("occupies")),
                          capabilities = places.Objects(iri, DocentIri("capability"));
  return std::count(occupies.begin(), occupies.end(), Term::Literal("base")) > 0 ||
         std::count(capabilities.begin(), capabilities.end(), Term::Iri(DocentIri("Navigation"))) > 0;
}

// A straight line at a constant speed.
void Drive(const Decision& command, maps::Point2 from, maps::Point2 to, SimulatedCommand* simulated) {
  const double seconds = maps::Distance(from, to) / kSimulatedSpeed;
  const auto pose = [&](double at) {
    const double share = seconds == 0 ? 1 : std::min(1.0, at / seconds);
    simulated->poses.push_back({command.time_us + Micros(at), command.command, command.robot,
                                from.x_m + share * (to.x_m - from.x_m),
                                from.y_m + share * (to.y_m - from.y_m), ""});
  };
  for (double at = 1; at < seconds; ++at) pose(at);
  pose(seconds);
  simulated->ends_us = command.time_us + Micros(seconds);
}

}  // namespace

SimulatedCommand SimulateCommand(const Decision& command, const Dictionary& dictionary,
                                 const GraphVersion& graph) {
  const Places places(dictionary, graph);
  SimulatedCommand simulated;
  simulated.ends_us = command.time_us + Micros(kSimulatedMoment);
  double speaking = 0;
  for (const auto& [name, value] : command.arguments) {
    if (value.IsLiteral() && FiniteNumber(value) == std::nullopt)
      speaking = std::max(speaking, SecondsOfText(value.lexical));
  }
  if (speaking > 0) simulated.ends_us = command.time_us + Micros(speaking);
  if (!Drives(places, command.operation)) return simulated;
  for (const auto& [name, value] : command.arguments) {
    const auto to = DestinationOf(places, value);
    if (!to) continue;
    Drive(command, places.Of(Term::Iri(command.robot.value())).value_or(to->point), to->point, &simulated);
    simulated.poses.back().place = to->place;
    break;
  }
  return simulated;
}

std::vector<std::string> ReadyRobots(const std::set<std::string>& operations, RunCase* world) {
  std::vector<std::string> notes;
  std::set<std::string> robots, joined, offering, hindered;
  std::set<std::string> offered;
  for (const TermQuad& fact : world->facts) {
    const std::string& predicate = fact.predicate.lexical;
    if (predicate == kRdfType && fact.object.lexical == DocentIri("Robot"))
      robots.insert(fact.subject.lexical);
    if (predicate == DocentIri("incarnation")) joined.insert(fact.subject.lexical);
    if (predicate != DocentIri("offers")) continue;
    offering.insert(fact.subject.lexical);
    if (const auto name = OperationOfIri(fact.object.lexical)) offered.insert(*name);
  }
  std::erase_if(world->facts, [&](TermQuad& fact) {
    if (!robots.contains(fact.subject.lexical)) return false;
    const std::string& property = fact.predicate.lexical;
    // Where it drives is told in its own graph: what was told elsewhere must not stay behind.
    if (property == DocentIri("x") || property == DocentIri("y") || property == DocentIri("isAt"))
      fact.graph = fact.subject;
    if (property == DocentIri("localised")) return true;
    const bool status = property == DocentIri("status");
    if (!status && property != DocentIri("outOfService")) return false;
    if (!status || fact.object.lexical != DocentIri("Standby")) hindered.insert(fact.subject.lexical);
    return true;
  });
  // A simulated robot goes on telling what it told.
  std::erase_if(world->lifetimes, [&](const auto& lifetime) {
    const TermQuad& fact = lifetime.second;
    return robots.contains(fact.subject.lexical) && fact.graph == fact.subject;
  });
  for (const auto& [robot, run] : std::exchange(world->held, {})) hindered.insert(robot.value());
  const auto tell = [world](const std::string& robot, std::string_view property, Term value) {
    world->facts.push_back(
        {Term::Iri(robot), Term::Iri(DocentIri(property)), std::move(value), Term::Iri(robot)});
  };
  const auto ready = [&](const std::string& robot) {
    tell(robot, "status", Term::Iri(DocentIri("Standby")));
    tell(robot, "localised", Term::Boolean(true));
    if (!joined.contains(robot)) tell(robot, "incarnation", Term::Literal("simulated"));
  };
  for (const std::string& robot : robots) ready(robot);
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
  std::vector<std::string> simulated;  // robots of which only descriptions are known
  std::set_difference(robots.begin(), robots.end(), offering.begin(), offering.end(),
                      std::back_inserter(simulated));
  if (simulated.empty()) {
    simulated = {kExtraRobot};
    world->facts.push_back({Term::Iri(kExtraRobot), Term::Iri(std::string(kRdfType)),
                            Term::Iri(DocentIri("Robot")), Term::Iri(kExtraRobot)});
    ready(kExtraRobot);
  }
  for (const std::string& robot : simulated) {
    for (const std::string& operation : operations) tell(robot, "offers", Term::Iri(OperationIri(operation)));
  }
  notes.push_back(absl::StrCat("no robot offers ", absl::StrJoin(missing, ", "), ": a simulated one does (<",
                               simulated.front(), ">)"));
  return notes;
}

}  // namespace docent::server
