// Fleet: robots taken out of service and put in service again; reservations.
#include <optional>
#include <utility>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "graph/base/cut_text.h"
#include "graph/base/text_limits.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/robots/reservations.h"
#include "kb_server/robots/service_state.h"

namespace docent::server {
namespace {

grpc::ServerUnaryReactor* Set(const WritePorts& ports, grpc::CallbackServerContext* context,
                              const std::string& robot, std::optional<std::string> reason, WriteBatch batch,
                              v1::ServiceStateReply* reply) {
  if (absl::Status iri = CheckRobotIri(robot, "robot", ports.limits); !iri.ok())
    return FinishNow(context, ToGrpc(iri));
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports.inbox->Push(
      std::move(batch),
      [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
        if (outcome.ok()) reply->set_revision(outcome->offset);
        reactor->Finish(ToGrpc(outcome.status()));
      },
      [dictionary = ports.dictionary, robot, reason = std::move(reason)](const TurnView& view,
                                                                         WriteBatch* made) {
        return SetServiceState(robot, reason, *dictionary, view.graph, made);
      });
  return reactor;
}

}  // namespace

void ToProto(const engine::Reservation& reservation, v1::RobotReservation* out) {
  out->set_reservation(reservation.iri);
  for (const RobotId& robot : reservation.robots) out->add_robots(robot.value());
  out->set_kept_for(KeptForText(reservation));
  out->set_priority(reservation.priority);
  out->set_since_us(reservation.since_us);
  out->set_until_us(reservation.until_us);
  out->set_reason(reservation.reason);
}

grpc::ServerUnaryReactor* FleetService::TakeOutOfService(grpc::CallbackServerContext* context,
                                                         const v1::TakeOutOfServiceRequest* request,
                                                         v1::ServiceStateReply* reply) {
  WriteBatch batch;
  if (request->cancel_commands()) {
    RunRequest cancel;
    cancel.kind = RunRequest::Kind::kCancelCommands;
    cancel.target = request->robot();
    cancel.reason = CutText(request->reason(), kTextLimits.message_bytes);
    batch.run_requests.push_back(std::move(cancel));
  }
  return Set(ports_, context, request->robot(), CutText(request->reason(), kTextLimits.message_bytes),
             std::move(batch), reply);
}

grpc::ServerUnaryReactor* FleetService::PutInService(grpc::CallbackServerContext* context,
                                                     const v1::PutInServiceRequest* request,
                                                     v1::ServiceStateReply* reply) {
  return Set(ports_, context, request->robot(), std::nullopt, {}, reply);
}

grpc::ServerUnaryReactor* FleetService::Reserve(grpc::CallbackServerContext* context,
                                                const v1::ReserveRequest* request, v1::ReserveReply* reply) {
  ReservationRequest wanted{{request->robots().begin(), request->robots().end()},
                            request->kept_for(),
                            request->priority(),
                            0,
                            CutText(request->reason(), kTextLimits.message_bytes)};
  if (request->lasting_ms() < 0 || (request->lasting_ms() > 0 && request->until_us() != 0))
    return FinishNow(
        context, ToGrpc(absl::InvalidArgumentError("lasting_ms and until_us: give one of them, above 0")));
  wanted.lasting_ms = static_cast<uint64_t>(request->lasting_ms());
  if (request->until_us() != 0) {
    const int64_t left_us = request->until_us() - absl::ToUnixMicros(absl::Now());
    if (left_us < 1000)
      return FinishNow(context, ToGrpc(absl::InvalidArgumentError("until_us is in the past")));
    wanted.lasting_ms = static_cast<uint64_t>(left_us / 1000);
  }
  if (absl::Status valid = CheckReservation(wanted); !valid.ok()) return FinishNow(context, ToGrpc(valid));
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(
      WriteBatch(),
      [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
        if (outcome.ok()) reply->set_revision(outcome->offset);
        reactor->Finish(ToGrpc(outcome.status()));
      },
      [dictionary = ports_.dictionary, wanted = std::move(wanted), reply](const TurnView& view,
                                                                          WriteBatch* batch) {
        engine::Reservation made;
        if (absl::Status status =
                MakeReservation(wanted, *dictionary, view.graph, batch->time_us, batch, &made);
            !status.ok())
          return status;
        ToProto(made, reply->mutable_reservation());
        return absl::OkStatus();
      });
  return reactor;
}

grpc::ServerUnaryReactor* FleetService::Release(grpc::CallbackServerContext* context,
                                                const v1::ReleaseRequest* request, v1::ReleaseReply* reply) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(
      WriteBatch(),
      [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
        if (outcome.ok()) reply->set_revision(outcome->offset);
        reactor->Finish(ToGrpc(outcome.status()));
      },
      [dictionary = ports_.dictionary, reservation = request->reservation()](const TurnView& view,
                                                                             WriteBatch* batch) {
        return ReleaseReservation(reservation, *dictionary, view.graph, batch);
      });
  return reactor;
}

}  // namespace docent::server
