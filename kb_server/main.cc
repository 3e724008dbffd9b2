// docent: the server and its command line.
#include <stdlib.h>

#include <string>
#include <vector>

#include "CLI/App.hpp"
#include "graph/base/program_setup.h"
#include "graph/base/text.h"
#include "graph/base/version.h"
#include "graph/command_line/program.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/cli/visit/visit_command.h"

int main(int argc, char** argv) {
  docent::PrepareStandardStreams();
  docent::SetMutexChecks();
  const docent::server::SafeOutput safe_output;
  setenv("GRPC_VERBOSITY", "NONE", 0);  // what gRPC would log reaches people through our own errors
  // librdf must not load our own storage module into ourselves
  setenv("REDLAND_MODULE_PATH", "/dev/null", 1);
  CLI::App app{"Docent: a semantic context-reasoning server for service robots, and its command line.",
               "docent"};
  docent::UseHelpLayout(&app);
  app.set_version_flag("--version", docent::Concat("docent ", docent::VersionWithCommit()),
                       "Print the version and the commit that it was built from");
  app.require_subcommand(1);
  int exit_code = docent::kExitOk;
  docent::server::AddServeCommand(&app, &exit_code);
  docent::server::AddStatusCommand(&app, &exit_code);
  docent::server::AddLoadCommand(&app, &exit_code);
  docent::server::AddExportCommand(&app, &exit_code);
  docent::server::AddRulesCommand(&app, &exit_code);
  docent::server::AddTellCommand(&app, &exit_code);
  docent::server::AddQueryCommand(&app, &exit_code);
  docent::server::AddWatchCommand(&app, &exit_code);
  docent::server::AddWhyCommand(&app, &exit_code);
  docent::server::AddWhyNotCommand(&app, &exit_code);
  docent::server::AddWhatIfCommand(&app, &exit_code);
  docent::server::AddUpdateCommand(&app, &exit_code);
  docent::server::AddCheckCommand(&app, &exit_code);
  docent::server::AddTestCommand(&app, &exit_code);
  docent::server::AddFmtCommand(&app, &exit_code);
  docent::server::AddMapCommand(&app, &exit_code);
  docent::server::AddValidateCommand(&app, &exit_code);
  docent::server::AddOntologyCommand(&app, &exit_code);
  docent::server::AddRunCommand(&app, &exit_code);
  docent::server::AddRunsCommand(&app, &exit_code);
  docent::server::AddReplayCommand(&app, &exit_code);
  docent::server::AddWorkflowsCommand(&app, &exit_code);
  docent::server::AddRobotsCommand(&app, &exit_code);
  docent::server::AddServicesCommand(&app, &exit_code);
  docent::server::AddVisitCommand(&app, &exit_code);
  docent::server::AddVerifyCommand(&app, &exit_code);
  docent::server::AddBackupCommand(&app, &exit_code);
  docent::server::AddRestoreCommand(&app, &exit_code);
  docent::server::AddReferenceCommand(&app, &exit_code);
  const auto ended = docent::ParseArguments(&app, docent::server::WithSignedFacts({argv + 1, argv + argc}));
  return ended ? *ended : docent::EndOutput(app, exit_code);
}
