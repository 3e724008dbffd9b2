// docent services generate and check.
#include <algorithm>
#include <iostream>

#include "docent/v1/robot_services.grpc.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/terminal.h"

namespace docent::server {
namespace {

bool HasErrors(const google::protobuf::RepeatedPtrField<v1::Diagnostic>& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(),
                     [](const v1::Diagnostic& diagnostic) { return !diagnostic.warning(); });
}

}  // namespace

int GenerateServices(const ServiceArguments& arguments) {
  v1::GenerateRequest request;
  request.set_name(arguments.name);
  request.set_process(arguments.process);
  for (const std::string& operation : arguments.names) request.add_operations(operation);
  if (!arguments.robot.empty()) {
    FactArguments facts([&] { return ServerNames(arguments.client); });
    if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
    request.set_robot(facts.Iri(arguments.robot));
  }
  v1::GenerateReply reply;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::RobotServices::NewStub(Connect(arguments.client))->Generate(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json) {
    PrintJson(reply);
    return kExitOk;
  }
  PrintForPrograms(reply.rsel());
  PrintDiagnostics(reply.diagnostics());
  return kExitOk;
}

int CheckServices(const ServiceArguments& arguments) {
  int exit_code = kExitOk;
  const auto stub = v1::RobotServices::NewStub(Connect(arguments.client));
  for (const std::string& file : arguments.names) {
    absl::StatusOr<std::string> text = ReadBytes(file, kDocumentText);
    if (!text.ok()) return Fail(text.status());
    v1::RegisterRequest request;
    request.set_name(file);
    request.set_rsel(*std::move(text));
    v1::RegisterReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub->Check(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments.client);
    const bool bad = HasErrors(reply.diagnostics());
    if (bad) exit_code = kExitNegative;
    if (arguments.client.json) {
      PrintJson(reply);
      continue;
    }
    PrintDiagnostics(reply.diagnostics());
    if (!bad) std::cout << file << ": ok\n";
  }
  return exit_code;
}

}  // namespace docent::server
