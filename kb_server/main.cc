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

int main(int argc, char** argv) {
  docent::PrepareStandardStreams();
  docent::SetMutexChecks();
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
  docent::AddServeCommand(&app, &exit_code);
  docent::AddLoadCommand(&app, &exit_code);
  docent::AddRulesCommand(&app, &exit_code);
  docent::AddTellCommand(&app, &exit_code);
  docent::AddQueryCommand(&app, &exit_code);
  docent::AddWatchCommand(&app, &exit_code);
  docent::AddWhyCommand(&app, &exit_code);
  docent::AddWhyNotCommand(&app, &exit_code);
  docent::AddWhatIfCommand(&app, &exit_code);
  docent::AddUpdateCommand(&app, &exit_code);
  docent::AddCheckCommand(&app, &exit_code);
  docent::AddValidateCommand(&app, &exit_code);
  docent::AddOntologyCommand(&app, &exit_code);
  docent::AddRunCommand(&app, &exit_code);
  docent::AddRunsCommand(&app, &exit_code);
  docent::AddRobotsCommand(&app, &exit_code);
  docent::AddServicesCommand(&app, &exit_code);
  docent::AddVerifyCommand(&app, &exit_code);
  docent::AddBackupCommand(&app, &exit_code);
  docent::AddRestoreCommand(&app, &exit_code);
  docent::AddReferenceCommand(&app, &exit_code);
  const auto ended = docent::ParseArguments(&app, docent::WithSignedFacts({argv + 1, argv + argc}));
  return ended ? *ended : docent::EndOutput(app, exit_code);
}
