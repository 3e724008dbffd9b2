// docent robots: the robots that the server knows.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "docent/v1/fleet.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {
namespace {

std::string PoseText(const v1::RobotStatus& robot) {
  if (!robot.has_pose()) return "";
  return absl::StrFormat("%.2f, %.2f m, %.2f rad", robot.x_m(), robot.y_m(), robot.heading_rad());
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
               {robot.state(), StyleOfState(robot.state())},
               PoseText(robot),
               absl::StrJoin(robot.regions(), " ", named),
               HeldText(robot),
               absl::StrJoin(robot.operations(), " "),
               robot.address()});
  }
  std::cout << table.Render(presenter.terminal());
  return kExitOk;
}

}  // namespace

void AddRobotsCommand(CLI::App* app, int* exit_code) {
  auto options = std::make_shared<ClientOptions>();
  CLI::App* command =
      app->add_subcommand("robots", "List the robots with state, pose, region and operations");
  command->group(kRobotsGroup);
  AddClientOptions(command, options.get());
  AddShowOptions(command, options.get());
  command->footer("Example:\n  docent robots --json");
  command->callback([options, exit_code] { *exit_code = ListRobots(*options); });
}

}  // namespace docent::server
