// docent robots: the robots that the server knows.
#include <iomanip>
#include <iostream>

#include "docent/v1/fleet.grpc.pb.h"
#include "graph/rdf/term.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"

namespace docent {
namespace {

int ListRobots(const ClientOptions& options) {
  v1::ListRobotsReply reply;
  grpc::ClientContext context;
  grpc::Status status = v1::Fleet::NewStub(Connect(options))->List(&context, {}, &reply);
  if (!status.ok()) return Fail(status, options);
  for (const v1::RobotStatus& robot : reply.robots()) {
    if (options.json) {
      PrintJson(robot);
      continue;
    }
    std::cout << ToDisplay(Term::Iri(robot.robot())) << "  " << robot.state();
    if (robot.has_pose()) {
      std::cout << std::fixed << std::setprecision(2) << "  x " << robot.x_m() << " m  y " << robot.y_m()
                << " m  heading " << robot.heading_rad() << " rad";
    }
    for (const std::string& region : robot.regions()) std::cout << "  in " << ToDisplay(Term::Iri(region));
    std::cout << "\n  offers";
    for (const std::string& operation : robot.operations()) std::cout << " " << operation;
    std::cout << "\n  adapter " << (robot.address().empty() ? "none" : robot.address()) << "\n";
  }
  if (reply.robots().empty() && !options.json) std::cerr << "no robot has joined\n";
  return kExitOk;
}

}  // namespace

void AddRobotsCommand(CLI::App* app, int* exit_code) {
  auto options = std::make_shared<ClientOptions>();
  CLI::App* command = app->add_subcommand("robots", "List robots with state, pose and operations");
  AddClientOptions(command, options.get());
  command->callback([options, exit_code] { *exit_code = ListRobots(*options); });
}

}  // namespace docent
