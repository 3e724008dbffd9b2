// Fleet: which robots are there, from leases and the graph.
#include "absl/strings/str_cat.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/robots/robot_facts.h"
#include "kb_server/robots/robot_records.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

RobotDescription Describe(const v1::JoinRequest& request) {
  const v1::RobotDescription& description = request.description();
  RobotDescription out;
  out.robot = description.robot();
  out.type = description.type();
  out.label = description.label();
  out.incarnation = description.incarnation();
  out.address = request.address();
  for (const v1::OperationDescription& operation : description.operations()) {
    out.operations.push_back({operation.name(),
                              {operation.inputs().begin(), operation.inputs().end()},
                              {operation.outputs().begin(), operation.outputs().end()},
                              operation.idempotent()});
  }
  return out;
}

void Fill(const RobotRecord& robot, v1::RobotStatus* out) {
  out->set_robot(robot.robot);
  out->set_label(robot.label);
  out->set_address(robot.address);
  out->set_incarnation(robot.incarnation);
  out->set_state(robot.state == RobotRecord::State::kStandby ? "standby"
                 : robot.state == RobotRecord::State::kBusy  ? "busy"
                                                             : "offline");
  for (const std::string& operation : robot.operations) out->add_operations(operation);
  out->set_last_seen_us(robot.last_seen_us);
  if (robot.x_m && robot.y_m) {
    out->set_has_pose(true);
    out->set_x_m(*robot.x_m);
    out->set_y_m(*robot.y_m);
    if (robot.heading_rad) out->set_heading_rad(*robot.heading_rad);
  }
  for (const std::string& region : robot.regions) out->add_regions(region);
}

}  // namespace

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
  RobotDescription join = AcceptedDescription(Describe(*request), &warnings);
  for (const std::string& warning : warnings) reply->add_warnings(warning);
  std::string text = absl::StrCat(request->address(), "\n", description.SerializeAsString());
  leases_.Renew(description.robot(), text, [this, reactor, reply, text, join = std::move(join)](bool tell) {
    GraphVersionPtr version = ports_.queries->Newest();
    reply->set_revision(version->revision().value());
    if (!tell) return reactor->Finish(grpc::Status::OK);
    reply->set_tell_states(true);
    ports_.inbox->Push(
        FactsOfJoin(join, *ports_.dictionary, *version),
        [this, reactor, reply, robot = join.robot, text](const absl::StatusOr<BatchOutcome>& outcome) {
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
                    const GraphVersionPtr version = ports_.queries->Newest();
                    for (const RobotRecord& robot : ReadRobots(*ports_.dictionary, *version))
                      Fill(robot, reply->add_robots());
                    reactor->Finish(grpc::Status::OK);
                  });
}

}  // namespace docent::server
