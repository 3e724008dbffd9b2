#include "kb_server/robots/reservations.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "graph/store/server_graphs.h"

namespace docent::server {
namespace {

bool IsOneOf(const GraphReader& graph, const std::string& iri, std::string_view property, const Term& value) {
  const std::vector<Term> told = graph.Objects(iri, property);
  return std::find(told.begin(), told.end(), value) != told.end();
}

absl::StatusOr<std::string> BeneficiaryIri(const std::string& name, const GraphReader& graph) {
  if (name.empty()) return std::string();
  const std::string workflow = WorkflowIri(name);
  for (const std::string& id : {name, IriSegment(name)}) {  // as it is shown, and as it is meant
    std::string run = RunIri(RunId(id));
    if (!IsOneOf(graph, run, DocentIri("runState"), Term::Literal("running"))) continue;
    for (std::string parent; !(parent = graph.Object(run, DocentIri("parentRun"))).empty();) run = parent;
    return run;  // the outermost: it is the one that robots are given to
  }
  if (IsOneOf(graph, workflow, kRdfType, Term::Iri(DocentIri("Workflow")))) return workflow;
  return absl::NotFoundError(absl::StrCat("there is no live run and no deployed workflow ", name,
                                          "; docent runs and docent workflows list them"));
}

}  // namespace

std::vector<engine::Reservation> ReadReservations(const Dictionary& dictionary, const GraphVersion& version) {
  const GraphReader graph(dictionary, version);
  std::map<std::string, engine::Reservation> by_iri;
  const std::optional<TermId> property = dictionary.FindIri(DocentIri("reservedBy"));
  if (!property) return {};
  version.ForEach({{}, *property, {}, {}}, [&](const Quad& quad) {
    const Term iri = dictionary.Decode(quad.object), robot = dictionary.Decode(quad.subject);
    if (iri.IsIri() && robot.IsIri()) by_iri[iri.lexical].robots.insert(RobotId(robot.lexical));
    return true;
  });
  std::vector<engine::Reservation> all;
  for (auto& [iri, reservation] : by_iri) {
    reservation.iri = iri;
    reservation.kept_for = graph.Object(iri, DocentIri("reservedFor"));
    if (!absl::SimpleAtoi(graph.Object(iri, DocentIri("reservationPriority")), &reservation.priority))
      reservation.priority = 0;
    reservation.since_us = MicrosOfDateTime(graph.Object(iri, DocentIri("reservedAt")));
    reservation.until_us = MicrosOfDateTime(graph.Object(iri, DocentIri("reservedUntil")));
    reservation.reason = graph.Object(iri, Concat(kRdfsNs, "comment"));
    all.push_back(std::move(reservation));
  }
  std::sort(all.begin(), all.end(), [](const engine::Reservation& a, const engine::Reservation& b) {
    return std::tie(b.priority, a.since_us, a.iri) < std::tie(a.priority, b.since_us, b.iri);
  });
  return all;
}

std::string KeptForText(const engine::Reservation& reservation) {
  if (const auto run = RunOfIri(reservation.kept_for)) return absl::StrCat("run ", run->value());
  if (const auto workflow = WorkflowOfIri(reservation.kept_for)) return absl::StrCat("workflow ", *workflow);
  return "";
}

absl::Status CheckReservation(const ReservationRequest& request) {
  if (request.robots.empty())
    return absl::InvalidArgumentError("no robot is named; name those to be reserved");
  if (request.robots.size() > kWorkflowLimits.reserved_robots) {
    return absl::ResourceExhaustedError(absl::StrCat("there are ", request.robots.size(),
                                                     " robots; the limit reserved_robots is ",
                                                     kWorkflowLimits.reserved_robots));
  }
  for (const std::string& robot : request.robots) {
    if (!IsValidTermIri(robot))
      return absl::InvalidArgumentError(absl::StrCat("the robot \"", robot, "\" is not an absolute IRI"));
  }
  if (request.priority < -kMaxReservationPriority || request.priority > kMaxReservationPriority) {
    return absl::InvalidArgumentError(absl::StrCat("priority ", request.priority, " is not from -",
                                                   kMaxReservationPriority, " to ", kMaxReservationPriority));
  }
  if (request.lasting_ms > kLongestReservationMs) {
    return absl::InvalidArgumentError(
        absl::StrCat("a reservation lasts 720 hours at most, and this one ", request.lasting_ms, " ms"));
  }
  if (request.lasting_ms == 0 && request.kept_for.empty()) {
    return absl::InvalidArgumentError(
        "the reservation would have no end: say how long it lasts, or for which run or workflow it is");
  }
  return absl::OkStatus();
}

absl::Status MakeReservation(const ReservationRequest& request, const Dictionary& dictionary,
                             const GraphVersion& graph, TimeMicros now_us, WriteBatch* batch,
                             engine::Reservation* made) {
  const GraphReader reader(dictionary, graph);
  for (const std::string& robot : request.robots) {
    if (!IsOneOf(reader, robot, kRdfType, Term::Iri(DocentIri("Robot")))) {
      return absl::NotFoundError(
          absl::StrCat("there is no robot <", robot, ">; docent robots lists those that have joined"));
    }
    made->robots.insert(RobotId(robot));
  }
  absl::StatusOr<std::string> kept_for = BeneficiaryIri(request.kept_for, reader);
  if (!kept_for.ok()) return kept_for.status();
  // One batch is one revision: the number is not used twice.
  made->iri = ReservationIri(absl::StrCat("operator-", graph.revision().value() + 1));
  made->kept_for = *std::move(kept_for);
  made->priority = request.priority;
  made->reason = request.reason;
  made->since_us = now_us;
  if (request.lasting_ms != 0) made->until_us = now_us + static_cast<TimeMicros>(request.lasting_ms) * 1000;
  const auto say = [&](const std::string& subject, const std::string& predicate, Term object) {
    batch->operations.push_back({QuadOperation::Kind::kAdd,
                                 {Term::Iri(subject), Term::Iri(predicate), std::move(object),
                                  Term::Iri(std::string(kOperatorGraph))}});
  };
  say(made->iri, std::string(kRdfType), Term::Iri(DocentIri("Reservation")));
  if (!made->kept_for.empty()) say(made->iri, DocentIri("reservedFor"), Term::Iri(made->kept_for));
  say(made->iri, DocentIri("reservationPriority"), Term::Integer(made->priority));
  say(made->iri, DocentIri("reservedAt"), DateTimeTerm(made->since_us));
  if (made->until_us != 0) say(made->iri, DocentIri("reservedUntil"), DateTimeTerm(made->until_us));
  if (!request.reason.empty()) say(made->iri, Concat(kRdfsNs, "comment"), Term::Literal(request.reason));
  for (const RobotId& robot : made->robots) say(robot.value(), DocentIri("reservedBy"), Term::Iri(made->iri));
  batch->lifetime_ms = request.lasting_ms;
  return absl::OkStatus();
}

absl::Status ReleaseReservation(const std::string& reservation, const Dictionary& dictionary,
                                const GraphVersion& graph, WriteBatch* batch) {
  const std::optional<TermId> iri = dictionary.FindIri(reservation),
                              property = dictionary.FindIri(DocentIri("reservedBy"));
  const bool known = iri && property && graph.ContainsMatch({{}, *property, *iri, {}});
  if (!known) {
    return absl::NotFoundError(absl::StrCat("there is no reservation <", reservation,
                                            ">; docent robots shows which robots are reserved, and by what"));
  }
  for (const QuadPattern& pattern : {QuadPattern{*iri, {}, {}, {}}, QuadPattern{{}, *property, *iri, {}}}) {
    graph.ForEach(pattern, [&](const Quad& quad) {
      const Term source = dictionary.Decode(quad.graph);
      if (source.lexical == kInferredGraph) return true;
      batch->operations.push_back({QuadOperation::Kind::kRemove,
                                   {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                                    dictionary.Decode(quad.object), source}});
      return true;
    });
  }
  return absl::OkStatus();
}

}  // namespace docent::server
