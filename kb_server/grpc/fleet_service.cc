// Fleet: which robots are there, from leases and the graph.
#include <grpcpp/grpcpp.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/cut_text.h"
#include "graph/base/text_limits.h"
#include "graph/wire/text_cut.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/imports/import_target.h"
#include "kb_server/robots/robot_facts.h"
#include "kb_server/robots/robot_records.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

// Names alone, or where given, with types.
void TakeParts(const google::protobuf::RepeatedPtrField<std::string>& names,
               const google::protobuf::RepeatedPtrField<v1::Part>& parts, std::vector<std::string>* out,
               rsel::PartTypes* types) {
  out->assign(names.begin(), names.end());
  if (!parts.empty()) out->clear();
  for (const v1::Part& part : parts) {
    out->push_back(part.name());
    if (!part.type().empty()) types->emplace(part.name(), part.type());
  }
}

RobotDescription Describe(const v1::JoinRequest& request) {
  const v1::RobotDescription& description = request.description();
  RobotDescription out;
  out.robot = description.robot();
  out.type = description.type();
  out.label = description.label();
  out.incarnation = description.incarnation();
  out.address = request.address();
  for (const v1::OperationDescription& operation : description.operations()) {
    OperationDescription& to = out.operations.emplace_back();
    to.name = operation.name();
    to.idempotent = operation.idempotent();
    to.occupies = {operation.occupies().begin(), operation.occupies().end()};
    to.description = CutText(operation.description(), kTextLimits.message_bytes);
    to.capabilities = {operation.capabilities().begin(), operation.capabilities().end()};
    TakeParts(operation.inputs(), operation.input_parts(), &to.inputs, &to.input_types);
    TakeParts(operation.outputs(), operation.output_parts(), &to.outputs, &to.output_types);
  }
  return out;
}

void Fill(const RobotRecord& robot, v1::RobotStatus* out) {
  out->set_robot(robot.robot);
  out->set_label(robot.label);
  out->set_address(robot.address);
  out->set_incarnation(robot.incarnation);
  out->set_state(std::string(ToString(robot.state)));
  out->set_out_of_service(robot.out_of_service.has_value());
  out->set_out_of_service_reason(robot.out_of_service.value_or(""));
  out->set_held_by(robot.held_by.value());
  for (const RobotTaskRecord& task : robot.held_for) {
    v1::RobotTask* held_for = out->add_held_for();
    held_for->set_run(task.run.value());
    held_for->set_node(task.node);
    held_for->set_operation(task.operation);
    held_for->set_step(task.step);
  }
  for (const std::string& command : robot.ending_commands) out->add_ending_commands(command);
  for (const std::string& operation : robot.operations) out->add_operations(operation);
  for (const std::string& capability : robot.capabilities) out->add_capabilities(capability);
  out->set_last_seen_us(robot.last_seen_us);
  if (robot.x_m && robot.y_m) {
    out->set_has_pose(true);
    out->set_x_m(*robot.x_m);
    out->set_y_m(*robot.y_m);
    if (robot.heading_rad) out->set_heading_rad(*robot.heading_rad);
  }
  for (const std::string& region : robot.regions) out->add_regions(region);
  for (const engine::Reservation& reservation : robot.reservations)
    ToProto(reservation, out->add_reservations());
}

// The page that follows the robot of the token.
void FillPage(std::vector<RobotRecord> robots, const v1::ListRobotsRequest& request,
              v1::ListRobotsReply* reply) {
  std::sort(robots.begin(), robots.end(), [](const auto& a, const auto& b) { return a.robot < b.robot; });
  size_t bytes = 0;
  for (const RobotRecord& robot : robots) {
    if (robot.robot <= request.page_token()) continue;
    v1::RobotStatus status;
    const bool full =
        request.page_size() > 0 && static_cast<uint32_t>(reply->robots_size()) == request.page_size();
    if (!full) {
      Fill(robot, &status);
      status.set_texts_cut(CutToFit(&status, kTextLimits.listed_text_bytes, kTextLimits.listed_bytes));
      bytes += status.ByteSizeLong();
    }
    if (full || (reply->robots_size() > 0 && bytes > kTextLimits.listed_bytes)) {
      reply->set_next_page_token(reply->robots(reply->robots_size() - 1).robot());
      return;
    }
    *reply->add_robots() = std::move(status);
  }
}

// What of a description is longer than a robot may say; empty: nothing.
std::string TooLong(const v1::JoinRequest& request) {
  const v1::RobotDescription& description = request.description();
  std::string too_long;
  const auto look = [&too_long](const std::string& what, const std::string& text) {
    if (text.size() <= kTextLimits.label_bytes || !too_long.empty()) return;
    too_long = absl::StrCat(what, " has ", text.size(), " bytes; the limit label_bytes is ",
                            kTextLimits.label_bytes);
  };
  look("address", request.address());
  look("description.robot", description.robot());
  look("description.label", description.label());
  look("description.type", description.type());
  look("description.incarnation", description.incarnation());
  for (const v1::OperationDescription& operation : description.operations()) {
    look("description.operations.name", operation.name());
    for (const auto* names :
         {&operation.inputs(), &operation.outputs(), &operation.occupies(), &operation.capabilities()}) {
      for (const std::string& name : *names) look("description.operations", name);
    }
    for (const auto* parts : {&operation.input_parts(), &operation.output_parts()}) {
      for (const v1::Part& part : *parts) {
        look("description.operations", part.name());
        look("description.operations", part.type());
      }
    }
  }
  return too_long;
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
  if (const std::string too_long = TooLong(*request); !too_long.empty()) return refuse(too_long);
  if (absl::Status robot = CheckRobotIri(description.robot(), "description.robot", ports_.limits);
      !robot.ok())
    return refuse(std::string(robot.message()));
  if (const std::string fault = RobotNameFault(description.robot()); !fault.empty())
    return refuse(absl::StrCat("description.robot: ", fault));
  if (request->address().empty())
    return refuse("address is empty; give the HOST:PORT where the adapter serves RobotAdapter");
  if (absl::Status address = CheckTarget(request->address()); !address.ok())
    return refuse(absl::StrCat("address: ", address.message()));
  if (description.incarnation().empty())
    return refuse("description.incarnation is empty; it must change at every start");
  const std::string speaker = leases_.Claim(description.robot(), request->address());
  if (speaker.empty()) {
    Accept(reactor, *request, reply);
    return reactor;
  }
  probes_.Ask(speaker, [this, reactor, request, reply, speaker](bool gone) {
    ClaimFrom(speaker, gone, reactor, *request, reply);
  });
  return reactor;
}

// If the other one is there, this one is refused.
void FleetService::ClaimFrom(const std::string& speaker, bool gone, grpc::ServerUnaryReactor* reactor,
                             const v1::JoinRequest& request, v1::JoinReply* reply) {
  const std::string& robot = request.description().robot();
  std::string holder = speaker;
  if (gone) holder = leases_.Claim(robot, request.address(), speaker);
  if (holder.empty()) return Accept(reactor, request, reply);
  leases_.CountRefused();
  const std::string why =
      absl::StrCat("the adapter at ", holder, " speaks for ", robot,
                   " and its lease lives; stop one of the two, or give them robots of their own");
  spdlog::warn("the adapter at {} is refused: {}", request.address(), why);
  reactor->Finish(grpc::Status(grpc::StatusCode::ALREADY_EXISTS, why));
}

void FleetService::Accept(grpc::ServerUnaryReactor* reactor, const v1::JoinRequest& request,
                          v1::JoinReply* reply) {
  const v1::RobotDescription& description = request.description();
  reply->set_lease_ms(FleetLeases::kLeaseMs);
  std::vector<std::string> warnings;
  RobotDescription join = AcceptedDescription(Describe(request), &warnings);
  if (const std::string rival = leases_.RivalOf(description.robot()); !rival.empty()) {
    warnings.push_back(
        absl::StrCat("another adapter, at ", rival, ", wants to speak for this robot and is refused"));
  }
  for (const std::string& warning : warnings) reply->add_warnings(warning);
  const GraphVersionPtr now = ports_.queries->Newest();
  if (!HasFacts(FactsOfJoin(join, *ports_.dictionary, *now), *ports_.dictionary, *now))
    leases_.Untell(join.robot);
  std::string text = absl::StrCat(request.address(), "\n", description.SerializeAsString());
  leases_.Renew(description.robot(), description.incarnation(), text,
                [this, reactor, reply, text, join = std::move(join)](bool tell) {
                  GraphVersionPtr version = ports_.queries->Newest();
                  reply->set_revision(version->revision().value());
                  if (!tell) return reactor->Finish(grpc::Status::OK);
                  reply->set_tell_states(true);
                  ports_.inbox->Push(FactsOfJoin(join, *ports_.dictionary, *version),
                                     [this, reactor, reply, robot = join.robot,
                                      text](const absl::StatusOr<BatchOutcome>& outcome) {
                                       if (outcome.ok()) reply->set_revision(outcome->offset);
                                       leases_.Told(robot, text, outcome.ok());
                                       for (const std::string& warning : reply->warnings())
                                         spdlog::warn("{} joined, but for: {}", robot, warning);
                                       reactor->Finish(ToGrpc(outcome.status()));
                                     });
                });
}

grpc::ServerUnaryReactor* FleetService::Leave(grpc::CallbackServerContext* context,
                                              const v1::LeaveRequest* request, v1::LeaveReply* reply) {
  if (request->robot().empty() || request->incarnation().empty()) {
    return FinishNow(context,
                     ToGrpc(absl::InvalidArgumentError(
                         "robot or incarnation is empty; give both as the adapter joined with them")));
  }
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  leases_.Leave(
      request->robot(), request->incarnation(), [this, reactor, reply](const FleetLeases::Lost* lost) {
        const GraphVersionPtr version = ports_.queries->Newest();
        reply->set_revision(version->revision().value());
        if (lost == nullptr) return reactor->Finish(grpc::Status::OK);
        ports_.inbox->Push(
            FactsOfLoss(lost->robot, lost->seen_us, *ports_.dictionary, *version),
            [this, reactor, reply, robot = lost->robot](const absl::StatusOr<BatchOutcome>& outcome) {
              if (outcome.ok()) reply->set_revision(outcome->offset);
              leases_.ToldLost(robot, outcome.ok());
              reactor->Finish(ToGrpc(outcome.status()));
            });
      });
  return reactor;
}

grpc::ServerUnaryReactor* FleetService::List(grpc::CallbackServerContext* context,
                                             const v1::ListRobotsRequest* request,
                                             v1::ListRobotsReply* reply) {
  const auto trace = TraceOf(*context, ports_.followed);
  return OnWorker(ports_, context, [this, request, reply, trace](grpc::ServerUnaryReactor* reactor) {
    std::vector<RobotRecord> robots = Traced(trace.get(), [this] {
      const GraphVersionPtr version = ports_.queries->Newest();
      return ReadRobots(*ports_.dictionary, *version);
    });
    FillPage(std::move(robots), *request, reply);
    reactor->Finish(grpc::Status::OK);
  });
}

}  // namespace docent::server
