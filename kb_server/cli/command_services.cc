// docent services: composite robot services (RSEL processes); list, describe, invoke.
#include <iostream>

#include "docent/v1/robot_services.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/grpc/convert.h"

namespace docent {
namespace {

struct ServicesArguments {
  ClientOptions client;
  std::string invoke;
  std::vector<std::string> arguments;
  std::string robot;
};

int ListServices(const ClientOptions& options) {
  v1::ListServicesReply reply;
  grpc::ClientContext context;
  grpc::Status status = v1::RobotServices::NewStub(Connect(options))->List(&context, {}, &reply);
  if (!status.ok()) return Fail(status, options);
  for (const v1::RobotService& service : reply.services()) {
    if (options.json) {
      PrintJson(service);
      continue;
    }
    std::cout << service.name() << "(";
    for (int i = 0; i < service.inputs_size(); ++i) std::cout << (i > 0 ? ", " : "") << service.inputs(i);
    std::cout << ")  from " << service.document() << " " << service.version() << "\n ";
    for (int i = 0; i < service.steps_size(); ++i)
      std::cout << (i > 0 ? " → " : " ") << service.steps(i).operation();
    std::cout << "\n  robots:";
    for (const std::string& robot : service.robots()) std::cout << " " << ToDisplay(Term::Iri(robot));
    std::cout << (service.robots().empty() ? " none offers all of it now\n" : "\n");
  }
  return kExitOk;
}

int InvokeService(const ServicesArguments& arguments) {
  v1::InvokeServiceRequest request;
  request.set_name(arguments.invoke);
  request.set_robot(arguments.robot);
  for (const std::string& text : arguments.arguments) {
    auto variable = ParseVariable(text);
    if (!variable.ok()) return Fail(variable.status());
    v1::NamedTerm* named = request.add_arguments();
    named->set_name(variable->first);
    ToProto(variable->second, named->mutable_value());
  }
  grpc::ClientContext context;
  auto reader = v1::RobotServices::NewStub(Connect(arguments.client))->Invoke(&context, request);
  v1::InvokeServiceReply reply;
  std::string state;
  while (reader->Read(&reply)) {
    std::cout << reply.run() << "  " << reply.step() << "  " << reply.state();
    if (!reply.message().empty()) std::cout << "  " << reply.message();
    std::cout << "\n";
    if (reply.final()) state = reply.state();
  }
  grpc::Status status = reader->Finish();
  if (!status.ok()) return Fail(status, arguments.client);
  return state == "done" ? kExitOk : kExitNegative;
}

}  // namespace

void AddServicesCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ServicesArguments>();
  CLI::App* command = app->add_subcommand("services", "List composite robot services, or invoke one");
  AddClientOptions(command, &arguments->client);
  command->add_option("--invoke", arguments->invoke,
                      "Run this service and follow it (exit code 1: it failed)");
  command->add_option("--arg", arguments->arguments,
                      "NAME=VALUE, an argument of the service; may be repeated");
  command->add_option("--robot", arguments->robot,
                      "IRI of the robot that shall do it (default: any that can)");
  command->callback([arguments, exit_code] {
    *exit_code = arguments->invoke.empty() ? ListServices(arguments->client) : InvokeService(*arguments);
  });
}

}  // namespace docent
