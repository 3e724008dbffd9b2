// docent-robot: a simulated guide robot, or the replay of a real robot's recording, as an adapter of a docent
// server.
#include "CLI/App.hpp"
#include "graph/base/program_setup.h"
#include "graph/base/text.h"
#include "graph/base/version.h"
#include "graph/command_line/log_output.h"
#include "graph/command_line/program.h"
#include "robot_adapters/sim/commands.h"
#include "robot_adapters/sim/signals.h"

int main(int argc, char** argv) {
  docent::PrepareStandardStreams();
  docent::SetMutexChecks();
  docent::robot::BlockSignals();
  docent::UseLogOutput("docent-robot", "");  // results on stdout, diagnostics on stderr
  CLI::App app(
      "A simulated guide robot: it localises with a particle filter, plans paths, drives, shows pages and "
      "speaks, as a docent server commands.",
      "docent-robot");
  docent::UseHelpLayout(&app);
  int exit_code = docent::kExitOk;
  docent::robot::AddDriveCommand(&app, &exit_code);
  docent::robot::AddReplayCommand(&app, &exit_code);
  app.require_subcommand(0, 1);
  app.set_version_flag("--version", docent::Concat("docent-robot ", docent::VersionWithCommit()),
                       "Print the version and the commit that it was built from");
  const auto ended = docent::ParseArguments(&app, {argv + 1, argv + argc});
  return ended ? *ended : docent::EndOutput(app, exit_code);
}
