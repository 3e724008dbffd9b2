// RobotServices.ImportTemplates.
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/template_proto.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/imports/import_target.h"
#include "kb_server/imports/service_import.h"
#include "workflow/templates/wsdl_reader.h"

namespace docent::server {
namespace {

absl::StatusOr<templates::ImportedTemplates> Import(const RunPorts& ports,
                                                    const grpc::CallbackServerContext& context,
                                                    const v1::ImportTemplatesRequest& request) {
  using From = v1::ImportTemplatesRequest;
  switch (request.from_case()) {
    case From::kWsdl:
      if (absl::Status size = CheckDocumentSize(request.name(), request.wsdl(), ports.limits); !size.ok())
        return size;
      return templates::ReadWsdl(request.wsdl(), request.name(), ports.limits);
    case From::kGrpcTarget:
      if (absl::Status may = CheckMayReach(request.grpc_target(), ports.remote); !may.ok()) return may;
      return ImportFromGrpc(request.grpc_target(), &context);
    case From::kAdapter:
      if (absl::Status may = CheckMayReach(request.adapter(), ports.remote); !may.ok()) return may;
      return ImportFromAdapter(request.adapter(), &context);
    case From::FROM_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("nothing to import is given; give wsdl, grpc_target or adapter");
}

}  // namespace

grpc::ServerUnaryReactor* RobotServicesService::ImportTemplates(grpc::CallbackServerContext* context,
                                                                const v1::ImportTemplatesRequest* request,
                                                                v1::ImportTemplatesReply* reply) {
  return OnWorker(ports_, context, [this, context, request, reply](grpc::ServerUnaryReactor* reactor) {
    // While another server is waited for, the worker's place is free.
    std::optional<WorkerPool::Waiting> waiting;
    if (!request->has_wsdl()) waiting.emplace();
    if (waiting && !waiting->status().ok()) return reactor->Finish(ToGrpc(waiting->status()));
    const absl::StatusOr<templates::ImportedTemplates> imported = Import(ports_, *context, *request);
    waiting.reset();
    if (!imported.ok()) return reactor->Finish(ToGrpc(imported.status()));
    if (HasErrors(imported->diagnostics))
      return reactor->Finish(ToGrpc(ToStatus(imported->diagnostics, request->wsdl())));
    ToProto(*imported, reply);
    reactor->Finish(grpc::Status::OK);
  });
}

}  // namespace docent::server
