// The subcommands of docent-robot. Each function adds one to the command line; its callback does the work and
// sets the exit code (graph/command_line/program.h).
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_COMMANDS_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_COMMANDS_H_

#include "CLI/App.hpp"
#include "absl/status/status.h"
#include "graph/command_line/program.h"

namespace docent::robot {

// docent-robot without a subcommand: the simulated guide robot.
void AddDriveCommand(CLI::App* app, int* exit_code);
// docent-robot replay: the recording of a real robot.
void AddReplayCommand(CLI::App* app, int* exit_code);

// Prints "docent-robot: message" to stderr.
int Fail(const absl::Status& status);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_COMMANDS_H_
