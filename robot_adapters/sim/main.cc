// docent-robot: a simulated guide robot, or the replay of a real one's log, as an adapter of a docent server.
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <iostream>

#include "CLI/CLI.hpp"
#include "graph/base/program_setup.h"
#include "graph/base/text.h"
#include "graph/base/version.h"
#include "robot_adapters/sim/commands.h"
#include "robot_adapters/sim/signals.h"

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  docent::robot::BlockSignals();
  spdlog::set_default_logger(
      spdlog::stderr_logger_mt("docent-robot"));  // results on stdout, diagnostics on stderr
  CLI::App app(
      "A simulated guide robot: localises with a particle filter, plans, drives, shows pages and speaks, at "
      "the command of a "
      "docent server.\nSIGTERM ends it and SIGUSR1 makes it write a report: report.json, path.csv, path.png "
      "in --out.",
      "docent-robot");
  int exit_code = docent::robot::kExitOk;
  docent::robot::AddDriveCommand(&app, &exit_code);
  docent::robot::AddReplayCommand(&app, &exit_code);
  app.require_subcommand(0, 1);
  app.set_version_flag("--version", docent::Concat("docent-robot ", docent::VersionWithCommit()));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? docent::robot::kExitOk : docent::robot::kExitBad;
  }
  return exit_code;
}
