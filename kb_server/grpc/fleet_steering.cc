// Fleet: robots taken out of service and put in service again.
#include <optional>
#include <utility>

#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/robots/service_state.h"

namespace docent::server {
namespace {

grpc::ServerUnaryReactor* Set(const WritePorts& ports, grpc::CallbackServerContext* context,
                              const std::string& robot, std::optional<std::string> reason, WriteBatch batch,
                              v1::ServiceStateReply* reply) {
  v1::Term iri;
  iri.set_iri(robot);
  if (auto term = FromProto(iri, "robot"); !term.ok()) return FinishNow(context, ToGrpc(term.status()));
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

grpc::ServerUnaryReactor* FleetService::TakeOutOfService(grpc::CallbackServerContext* context,
                                                         const v1::TakeOutOfServiceRequest* request,
                                                         v1::ServiceStateReply* reply) {
  WriteBatch batch;
  if (request->cancel_commands()) {
    RunRequest cancel;
    cancel.kind = RunRequest::Kind::kCancelCommands;
    cancel.target = request->robot();
    cancel.reason = request->reason();
    batch.run_requests.push_back(std::move(cancel));
  }
  return Set(ports_, context, request->robot(), request->reason(), std::move(batch), reply);
}

grpc::ServerUnaryReactor* FleetService::PutInService(grpc::CallbackServerContext* context,
                                                     const v1::PutInServiceRequest* request,
                                                     v1::ServiceStateReply* reply) {
  return Set(ports_, context, request->robot(), std::nullopt, {}, reply);
}

}  // namespace docent::server
