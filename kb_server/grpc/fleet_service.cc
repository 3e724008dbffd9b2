// Fleet: which robots are there, from leases and the graph.
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/robot_facts.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/work/graph_reader.h"
#include "kb_server/work/measures.h"
#include "spdlog/spdlog.h"

namespace docent::server {
grpc::ServerUnaryReactor* FleetService::Join(grpc::CallbackServerContext* context,
                                             const v1::JoinRequest* request, v1::JoinReply* reply) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  auto refuse = [reactor](const std::string& why) {
    reactor->Finish(grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, why));
    return reactor;
  };
  const v1::RobotDescription& description = request->description();
  v1::Term robot;
  robot.set_iri(description.robot());
  if (auto term = FromProto(robot, "description.robot"); !term.ok())
    return refuse(std::string(term.status().message()));
  if (request->address().empty())
    return refuse("address is empty; give the HOST:PORT where the adapter serves RobotAdapter");
  if (description.incarnation().empty())
    return refuse("description.incarnation is empty; it must change at every start");
  reply->set_lease_ms(FleetLeases::kLeaseMs);
  std::vector<std::string> warnings;
  v1::JoinRequest join = *request;
  *join.mutable_description() = AcceptedDescription(description, &warnings);
  for (const std::string& warning : warnings) reply->add_warnings(warning);
  std::string text = absl::StrCat(request->address(), "\n", description.SerializeAsString());
  leases_.Renew(description.robot(), text, [this, reactor, reply, text, join = std::move(join)](bool tell) {
    GraphVersionPtr version = ports_.queries->Newest();
    reply->set_revision(version->revision().value());
    if (!tell) return reactor->Finish(grpc::Status::OK);
    reply->set_tell_states(true);
    ports_.inbox->Push(FactsOfJoin(join, *ports_.dictionary, *version),
                       [this, reactor, reply, robot = join.description().robot(),
                        text](const absl::StatusOr<BatchOutcome>& outcome) {
                         if (outcome.ok()) reply->set_revision(outcome->offset);
                         leases_.Told(robot, text, outcome.ok());
                         for (const std::string& warning : reply->warnings())
                           spdlog::warn("{} joined, but for: {}", robot, warning);
                         reactor->Finish(ToGrpc(outcome.status()));
                       });
  });
  return reactor;
}

grpc::ServerUnaryReactor* FleetService::List(grpc::CallbackServerContext* context,
                                             const v1::ListRobotsRequest*, v1::ListRobotsReply* reply) {
  return OnWorker(context->DefaultReactor(), ports_.workers,
                  [this, reply](grpc::ServerUnaryReactor* reactor) {
                    GraphVersionPtr version = ports_.queries->Newest();
                    GraphReader graph(*ports_.dictionary, *version);
                    for (const std::string& robot : graph.Subjects(kRdfType, Term::Iri(DocentIri("Robot")))) {
                      v1::RobotStatus* out = reply->add_robots();
                      out->set_robot(robot);
                      out->set_label(graph.Object(robot, Concat(kRdfsNs, "label")));
                      out->set_address(graph.Object(robot, DocentIri("adapterAddress")));
                      out->set_incarnation(graph.Object(robot, DocentIri("incarnation")));
                      std::string status = graph.Object(robot, DocentIri("status"));
                      out->set_state(status == DocentIri("Standby") ? "standby"
                                     : status == DocentIri("Busy")  ? "busy"
                                                                    : "offline");
                      for (const Term& operation : graph.Objects(robot, DocentIri("offers"))) {
                        out->add_operations(OperationOfIri(operation.lexical).value_or(operation.lexical));
                      }
                      out->set_last_seen_us(MicrosOfDateTime(graph.Object(robot, DocentIri("lastSeenAt"))));
                      const auto measure = [&](const char* local) {
                        return MeasureOf(local, graph.Objects(robot, DocentIri(local)));
                      };
                      const auto x = measure("x"), y = measure("y"), heading = measure("heading");
                      if (x && y) {
                        out->set_has_pose(true);
                        out->set_x_m(*x);
                        out->set_y_m(*y);
                        if (heading) out->set_heading_rad(*heading);
                      }
                      for (const Term& region : graph.Objects(robot, DocentIri("isAt")))
                        out->add_regions(region.lexical);
                    }
                    reactor->Finish(grpc::Status::OK);
                  });
}

}  // namespace docent::server
