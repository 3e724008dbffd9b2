#include "kb_server/cli/robots/robot_work.h"

#include "absl/strings/str_cat.h"

namespace docent::server {

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

std::string WorkAfterOut(const v1::RobotStatus& robot) {
  if (robot.held_for().empty() && robot.ending_commands().empty()) return "";
  const bool away = robot.state() == "offline";
  return absl::StrCat("it still does ", HeldText(robot), away ? ", as far as is known" : "",
                      "; --cancel-commands ends it\n");
}

}  // namespace docent::server
