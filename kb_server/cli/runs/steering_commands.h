// docent runs pause, resume, cancel, retry, skip, fail, set: what an operator does with runs. One thread.
#ifndef DOCENT_KB_SERVER_CLI_RUNS_STEERING_COMMANDS_H_
#define DOCENT_KB_SERVER_CLI_RUNS_STEERING_COMMANDS_H_

#include <string>

#include "CLI/App.hpp"
#include "kb_server/cli/client.h"

namespace docent::server {

void AddSteeringCommands(CLI::App* runs, int* exit_code);

// docent runs save.
void AddSaveCommand(CLI::App* runs, int* exit_code);

// Cancels a run and shows it. Returns the exit code.
int CancelRun(const ClientOptions& client, const std::string& run);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_RUNS_STEERING_COMMANDS_H_
