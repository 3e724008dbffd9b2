// docent robots: the robots that the server knows.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "docent/v1/fleet.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {
namespace {

std::string PoseText(const v1::RobotStatus& robot) {
  if (!robot.has_pose()) return "";
  return absl::StrFormat("%.2f, %.2f m, %.2f rad", robot.x_m(), robot.y_m(), robot.heading_rad());
}

std::string StateText(const v1::RobotStatus& robot) {
  if (!robot.out_of_service()) return robot.state();
  return absl::StrCat(robot.state(), ", out of service: ", robot.out_of_service_reason());
}

// "BoothGuide-1/Move2User moveToUser, ending".
std::string HeldText(const v1::RobotStatus& robot) {
  if (robot.held_by().empty()) return "";
  std::string text;
  for (const v1::RobotTask& task : robot.held_for()) {
    absl::StrAppend(&text, text.empty() ? "" : "; ", task.run().empty() ? robot.held_by() : task.run(), "/",
                    task.node(), " ", task.step().empty() ? task.operation() : task.step());
  }
  if (text.empty()) text = robot.held_by();
  if (!robot.ending_commands().empty()) absl::StrAppend(&text, ", ending");
  return text;
}

int ListRobots(const ClientOptions& options) {
  v1::ListRobotsReply reply;
  grpc::ClientContext context;
  grpc::Status status = v1::Fleet::NewStub(Connect(options))->List(&context, {}, &reply);
  if (!status.ok()) return Fail(status, options);
  if (options.json) {
    for (const v1::RobotStatus& robot : reply.robots()) PrintJson(robot);
    return kExitOk;
  }
  if (reply.robots().empty()) {
    std::cerr << "no robot has joined\n";
    return kExitOk;
  }
  const Presenter presenter(options);
  Table table({"robot", "state", "x, y, heading", "in", "held by", "operations", "adapter"});
  for (const v1::RobotStatus& robot : reply.robots()) {
    const auto named = [&](std::string* out, const std::string& iri) { out->append(presenter.Iri(iri)); };
    table.Add({presenter.Iri(robot.robot()),
               {StateText(robot), StyleOfState(robot.state())},
               PoseText(robot),
               absl::StrJoin(robot.regions(), " ", named),
               HeldText(robot),
               absl::StrJoin(robot.operations(), " "),
               robot.address()});
  }
  std::cout << table.Render(presenter.terminal());
  return kExitOk;
}

struct ServiceArguments {
  ClientOptions client;
  std::string robot, reason;
  std::vector<std::string> prefixes;
  bool cancel_commands = false;
};

int SetService(const ServiceArguments& arguments, bool in) {
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  auto stub = v1::Fleet::NewStub(Connect(arguments.client));
  grpc::ClientContext context;
  v1::ServiceStateReply reply;
  grpc::Status status;
  if (in) {
    v1::PutInServiceRequest request;
    request.set_robot(facts.Iri(arguments.robot));
    status = stub->PutInService(&context, request, &reply);
  } else {
    v1::TakeOutOfServiceRequest request;
    request.set_robot(facts.Iri(arguments.robot));
    request.set_cancel_commands(arguments.cancel_commands);
    request.set_reason(arguments.reason);
    status = stub->TakeOutOfService(&context, request, &reply);
  }
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json)
    PrintJson(reply);
  else
    std::cout << arguments.robot << (in ? " is in service\n" : " is out of service\n");
  return kExitOk;
}

void AddServiceCommands(CLI::App* robots, int* exit_code) {
  for (const bool in : {false, true}) {
    auto arguments = std::make_shared<ServiceArguments>();
    CLI::App* command = robots->add_subcommand(
        in ? "in" : "out", in ? "Put a robot in service again"
                              : "Take a robot out of service: it gets no further command until it is put in");
    AddClientOptions(command, &arguments->client);
    AddPrefixOption(command, &arguments->prefixes);
    command->add_option("robot", arguments->robot, "The robot: prefix:name or an IRI")->required();
    if (!in) {
      command->add_flag("--cancel-commands", arguments->cancel_commands,
                        "Cancel what it does; by default its commands end");
      command->add_option("--reason", arguments->reason, "Why, for people")->type_name("TEXT");
    }
    command->callback([arguments, in, exit_code] { *exit_code = SetService(*arguments, in); });
  }
}

}  // namespace

void AddRobotsCommand(CLI::App* app, int* exit_code) {
  auto options = std::make_shared<ClientOptions>();
  CLI::App* command = app->add_subcommand(
      "robots",
      "List the robots with state, pose, region and operations; take one out of service, or put it in");
  command->group(kRobotsGroup);
  AddClientOptions(command, options.get());
  AddShowOptions(command, options.get());
  command->footer(
      "Examples:\n"
      "  docent robots --json\n"
      "  docent robots out expo:R01 --reason 'a wheel squeaks'\n"
      "  docent robots in expo:R01");
  AddServiceCommands(command, exit_code);
  command->callback([options, command, exit_code] {
    if (command->get_subcommands().empty()) *exit_code = ListRobots(*options);
  });
}

}  // namespace docent::server
