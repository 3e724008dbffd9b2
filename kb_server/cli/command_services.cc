// docent services: composite robot services (RSEL processes); list, describe, invoke.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "docent/v1/robot_services.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/variable_argument.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

constexpr size_t kResultColumns = 200;  // of a result's value

struct ServicesArguments {
  ClientOptions client;
  std::string invoke;
  std::vector<std::string> arguments;
  std::vector<std::string> prefixes;
  std::string robot;
};

int ListServices(const ClientOptions& options) {
  v1::ListServicesReply reply;
  grpc::ClientContext context;
  grpc::Status status = v1::RobotServices::NewStub(Connect(options))->List(&context, {}, &reply);
  if (!status.ok()) return Fail(status, options);
  if (options.json) {
    for (const v1::RobotService& service : reply.services()) PrintJson(service);
    return kExitOk;
  }
  if (reply.services().empty()) {
    std::cerr << "no robot service is registered\n";
    return kExitOk;
  }
  const Presenter presenter(options);
  Table table({"service", "steps", "robots that offer all of it", "from"});
  for (const v1::RobotService& service : reply.services()) {
    const auto operation = [](std::string* out, const auto& step) { out->append(step.operation()); };
    const auto named = [&](std::string* out, const std::string& iri) { out->append(presenter.Iri(iri)); };
    const bool offered = !service.robots().empty();
    table.Add({absl::StrCat(service.name(), "(", absl::StrJoin(service.inputs(), ", "), ")"),
               absl::StrJoin(service.steps(), " → ", operation),
               {offered ? absl::StrJoin(service.robots(), " ", named) : "none now",
                offered ? Style::kPlain : Style::kFaint},
               absl::StrCat(service.document(), " ", service.version())});
  }
  std::cout << table.Render(presenter.terminal());
  return kExitOk;
}

int InvokeService(const ServicesArguments& arguments) {
  v1::InvokeServiceRequest request;
  request.set_name(arguments.invoke);
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  request.set_robot(facts.Iri(arguments.robot));
  for (const std::string& text : arguments.arguments) {
    auto variable =
        ParseVariable(text, [&facts](std::string_view prefix) { return facts.Namespace(prefix); });
    if (!variable.ok()) return Fail(variable.status());
    v1::NamedTerm* named = request.add_arguments();
    named->set_name(variable->first);
    ToProto(variable->second, named->mutable_value());
  }
  grpc::ClientContext context;
  auto reader = v1::RobotServices::NewStub(Connect(arguments.client))->Invoke(&context, request);
  v1::InvokeServiceReply reply;
  const Presenter presenter(arguments.client);
  std::string state;
  while (reader->Read(&reply)) {
    if (reply.final()) state = reply.state();
    if (arguments.client.json) {
      PrintJson(reply);
      continue;
    }
    std::cout << reply.run() << "  " << reply.step() << "  " << reply.state();
    if (!reply.message().empty()) std::cout << "  " << reply.message();
    std::cout << "\n";
    for (const v1::NamedTerm& result : reply.results()) {
      if (const std::optional<Term> value = FromProto(result.value()))
        std::cout << "  " << result.name() << " = " << presenter.Text(ToDisplay(*value), kResultColumns)
                  << "\n";
    }
  }
  grpc::Status status = reader->Finish();
  if (!status.ok()) return Fail(status, arguments.client);
  return state == "done" ? kExitOk : kExitNegative;
}

}  // namespace

void AddServicesCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ServicesArguments>();
  CLI::App* command = app->add_subcommand("services", "List the robot services, or invoke one and follow it");
  command->group(kRobotsGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option("--invoke", arguments->invoke, "Invoke this service")->type_name("SERVICE");
  command->add_option("--arg", arguments->arguments, "An argument of the service")->type_name("NAME=VALUE");
  AddPrefixOption(command, &arguments->prefixes);
  command
      ->add_option("--robot", arguments->robot,
                   "Robot that carries it out; by default any that offers all of it")
      ->type_name("IRI");
  command->footer(
      absl::StrCat(kVariableValueHelp,
                   "\n"
                   "Exit code 1: the invoked service failed or was cancelled.\n"
                   "Examples:\n"
                   "  docent services\n"
                   "  docent services --invoke moveToBooth --arg booth=https://w3id.org/docent/expo#B03"));
  command->callback([arguments, exit_code] {
    *exit_code = arguments->invoke.empty() ? ListServices(arguments->client) : InvokeService(*arguments);
  });
}

}  // namespace docent::server
