// docent: the server and its command line.
#include <stdlib.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "kb_server/app/client.h"
#include "kb_server/app/commands.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/base/program_setup.h"

namespace docent {
namespace {

// CLI11 says of a word that is no command only that a command is missing. What to say instead; empty where none is given.
std::string UnknownCommand(const CLI::App& app) {
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().front();
  std::string word;
  for (const std::string& left : app.remaining(/*recurse=*/true)) {
    if (word.empty() && !left.starts_with('-')) word = left;
  }
  if (word.empty()) return "";
  std::vector<std::string> names;
  for (const CLI::App* command : at->get_subcommands([](const CLI::App*) { return true; })) names.push_back(command->get_name());
  const std::string nearest = Nearest(word, names);
  const std::string group = at == &app ? "" : at->get_name() + " ";
  return "there is no command \"" + group + word + "\"; " +
         (nearest.empty() ? "`docent " + group + "--help` lists them" : "did you mean `docent " + group + nearest + "`?");
}

}  // namespace
}  // namespace docent

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  setenv("GRPC_VERBOSITY", "NONE", 0);  // what gRPC would log reaches people through our own errors
  setenv("REDLAND_MODULE_PATH", "/dev/null",
         1);  // librdf must not load our own storage module into ourselves
  CLI::App app{"Docent: a semantic context-reasoning server for service robots"};
  app.set_version_flag("--version", std::string(DOCENT_VERSION));
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
  std::vector<std::string> arguments = docent::WithSignedFacts({argv + 1, argv + argc});
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app.parse(arguments);
  } catch (const CLI::RequiredError& error) {
    if (const std::string word = docent::UnknownCommand(app); !word.empty()) {
      std::cerr << "docent: " << word << "\n";
      return docent::kExitBad;
    }
    app.exit(error);
    return docent::kExitBad;
  } catch (const CLI::ParseError& error) {
    int code = app.exit(error);
    return code == 0 ? docent::kExitOk : docent::kExitBad;
  }
  return exit_code;
}
