// RobotServices: composite robot services (RSEL processes); register, list, invoke and follow.
#include "absl/strings/str_cat.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/grpc/version_proto.h"
#include "kb_server/robots/robot_records.h"
#include "workflow/rsel/generator.h"
#include "workflow/rsel/parser.h"
#include "workflow/rsel/type_checks.h"

namespace docent::server {
namespace {

void Fill(const std::vector<std::string>& names, const rsel::PartTypes& types,
          google::protobuf::RepeatedPtrField<v1::Part>* out) {
  for (const std::string& name : names) {
    v1::Part* part = out->Add();
    part->set_name(name);
    if (const auto type = types.find(name); type != types.end()) part->set_type(type->second);
  }
}

void Fill(const std::vector<rsel::OfferedOperation>& offered, const rsel::Plan& plan, const Catalog& catalog,
          v1::RobotService* out) {
  out->set_name(plan.process);
  out->set_document(plan.document);
  out->set_version(plan.version);
  for (const std::string& input : plan.inputs) out->add_inputs(input);
  for (const rsel::PlanStep& step : plan.steps) {
    v1::ServiceStep* service_step = out->add_steps();
    service_step->set_operation(step.operation);
    service_step->set_service(step.service);
  }
  for (const RobotId& robot : rsel::CapableRobots(plan, offered)) out->add_robots(robot.value());
  const rsel::ServiceTypes types = rsel::TypesOf(plan, offered);
  Fill(plan.inputs, types.inputs, out->mutable_input_parts());
  std::vector<std::string> outputs;
  for (const auto& [part, source] : plan.outputs) outputs.push_back(part);
  Fill(outputs, types.outputs, out->mutable_output_parts());
  if (const DocumentVersionsPtr versions = catalog.versions.Find({Document::Kind::kRsel, plan.document})) {
    out->set_registered_version(versions->newest().number);
    out->set_revision(versions->newest().revision.value());
  }
}

// What the registry says of the document, and if it takes it, warnings about what the robots that are here cannot do.
Diagnostics CheckHere(const RunPorts& ports, const rsel::ParsedRsel& parsed) {
  rsel::ServiceRegistry registry = ports.catalog->Get()->services;
  Diagnostics of_registry = registry.Put(parsed.document);
  if (HasErrors(of_registry)) return of_registry;
  return rsel::CheckFeasibility(*parsed.document, registry,
                                OfferedOperations(*ports.dictionary, *ports.queries->Newest()));
}

// The document of the request, with what is wrong in it; RESOURCE_EXHAUSTED: it is too large to be looked at.
absl::StatusOr<rsel::ParsedRsel> Parse(const v1::RegisterRequest& request, const Limits& limits) {
  if (absl::Status size = CheckDocumentSize(request.name(), request.rsel(), limits); !size.ok()) return size;
  return rsel::ParseRsel(request.rsel(), request.name(), limits);
}

void Fill(const rsel::ParsedRsel& parsed, v1::RegisterReply* reply) {
  for (const Diagnostic& diagnostic : parsed.diagnostics) ToProto(diagnostic, reply->add_diagnostics());
  if (parsed.document == nullptr) return;
  for (const rsel::Process& process : parsed.document->processes) reply->add_processes(process.name.value);
}

}  // namespace

grpc::ServerUnaryReactor* RobotServicesService::Register(grpc::CallbackServerContext* context,
                                                         const v1::RegisterRequest* request,
                                                         v1::RegisterReply* reply) {
  return OnWorker(ports_, context, [this, request, reply](grpc::ServerUnaryReactor* reactor) {
    absl::StatusOr<rsel::ParsedRsel> read = Parse(*request, ports_.limits);
    if (!read.ok()) return reactor->Finish(ToGrpc(read.status()));
    rsel::ParsedRsel& parsed = *read;
    if (!parsed.ok()) return reactor->Finish(ToGrpc(ToStatus(parsed.diagnostics, request->rsel())));
    // What the registry refuses is left to the writer's turn to say.
    if (const Diagnostics here = CheckHere(ports_, parsed); !HasErrors(here))
      parsed.diagnostics.insert(parsed.diagnostics.end(), here.begin(), here.end());
    Fill(parsed, reply);
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kRsel, Document::Action::kPut, request->name(),
                               request->rsel(), std::make_shared<const ParsedDocument>(parsed.document)});
    ports_.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) reply->set_revision(outcome->offset);
      reactor->Finish(ToGrpc(outcome.status()));
    });
  });
}

grpc::ServerUnaryReactor* RobotServicesService::Check(grpc::CallbackServerContext* context,
                                                      const v1::RegisterRequest* request,
                                                      v1::RegisterReply* reply) {
  return OnWorker(ports_, context, [this, request, reply](grpc::ServerUnaryReactor* reactor) {
    absl::StatusOr<rsel::ParsedRsel> read = Parse(*request, ports_.limits);
    if (!read.ok()) return reactor->Finish(ToGrpc(read.status()));
    rsel::ParsedRsel& parsed = *read;
    if (parsed.ok()) {
      const Diagnostics here = CheckHere(ports_, parsed);
      parsed.diagnostics.insert(parsed.diagnostics.end(), here.begin(), here.end());
    }
    Fill(parsed, reply);
    reactor->Finish(grpc::Status::OK);
  });
}

grpc::ServerUnaryReactor* RobotServicesService::List(grpc::CallbackServerContext* context,
                                                     const v1::ListServicesRequest*,
                                                     v1::ListServicesReply* reply) {
  return OnWorker(ports_, context, [this, reply](grpc::ServerUnaryReactor* reactor) {
    const auto offered = OfferedOperations(*ports_.dictionary, *ports_.queries->Newest());
    const std::shared_ptr<const Catalog> catalog = ports_.catalog->Get();
    for (const rsel::PlanPtr& plan : catalog->services.Plans())
      Fill(offered, *plan, *catalog, reply->add_services());
    reactor->Finish(grpc::Status::OK);
  });
}

grpc::ServerUnaryReactor* RobotServicesService::Describe(grpc::CallbackServerContext* context,
                                                         const v1::DescribeServiceRequest* request,
                                                         v1::RobotService* reply) {
  const std::shared_ptr<const Catalog> catalog = ports_.catalog->Get();
  const rsel::PlanPtr plan = catalog->services.Find(request->name());
  if (plan == nullptr) return FinishNow(context, ToGrpc(catalog->services.NotRegistered(request->name())));
  Fill(OfferedOperations(*ports_.dictionary, *ports_.queries->Newest()), *plan, *catalog, reply);
  return FinishNow(context, grpc::Status::OK);
}

grpc::ServerUnaryReactor* RobotServicesService::Remove(grpc::CallbackServerContext* context,
                                                       const v1::RemoveServicesRequest* request,
                                                       v1::RemoveServicesReply* reply) {
  WriteBatch batch;
  batch.documents.push_back({Document::Kind::kRsel, Document::Action::kRemove, request->document(),
                             request->force() ? std::string(kForcedRemoval) : std::string()});
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
    if (outcome.ok()) reply->set_revision(outcome->offset);
    reactor->Finish(ToGrpc(outcome.status()));
  });
  return reactor;
}

grpc::ServerUnaryReactor* RobotServicesService::ListVersions(grpc::CallbackServerContext* context,
                                                             const v1::ListServiceVersionsRequest* request,
                                                             v1::ListVersionsReply* reply) {
  const std::shared_ptr<const Catalog> catalog = ports_.catalog->Get();
  const DocumentVersionsPtr versions = catalog->versions.Find({Document::Kind::kRsel, request->document()});
  if (versions == nullptr)
    return FinishNow(context, ToGrpc(catalog->services.NoDocument(request->document())));
  ToProto(*versions, request->with_texts(), reply);
  return FinishNow(context, grpc::Status::OK);
}

grpc::ServerUnaryReactor* RobotServicesService::Generate(grpc::CallbackServerContext* context,
                                                         const v1::GenerateRequest* request,
                                                         v1::GenerateReply* reply) {
  return OnWorker(ports_, context, [this, request, reply](grpc::ServerUnaryReactor* reactor) {
    const auto offered = OfferedOperations(*ports_.dictionary, *ports_.queries->Newest());
    const rsel::GeneratorRequest wanted{request->name(),
                                        request->process(),
                                        {request->operations().begin(), request->operations().end()},
                                        RobotId(request->robot())};
    absl::StatusOr<std::string> text =
        rsel::GenerateDocument(wanted, offered, ports_.catalog->Get()->services);
    if (!text.ok()) return reactor->Finish(ToGrpc(text.status()));
    rsel::ParsedRsel parsed = rsel::ParseRsel(*text, request->name(), ports_.limits);
    if (parsed.ok()) {
      const Diagnostics here = CheckHere(ports_, parsed);
      parsed.diagnostics.insert(parsed.diagnostics.end(), here.begin(), here.end());
    }
    for (const Diagnostic& diagnostic : parsed.diagnostics) ToProto(diagnostic, reply->add_diagnostics());
    reply->set_rsel(*std::move(text));
    reactor->Finish(grpc::Status::OK);
  });
}

}  // namespace docent::server
