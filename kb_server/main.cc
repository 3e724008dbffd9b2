// docent: the server and its command line.
#include <stdlib.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/base/program_setup.h"
#include "graph/base/text.h"
#include "graph/base/version.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"

namespace docent {
namespace {

// The command that was given, as far as it was understood, and how it is called: "docent ontology list".
struct GivenCommand {
  const CLI::App* app;
  std::string name = "docent";

  // The command below it that was given; false: there is none.
  bool Descend() {
    if (app->get_subcommands().empty()) return false;
    app = app->get_subcommands().front();
    name += " " + app->get_name();
    return true;
  }
};

// What is wrong with the arguments and what to do about it. CLI11 says of a word that is no command only that a command is
// missing, and of an option that there is none that it was not expected.
std::string WhatIsWrong(const CLI::App& app, const CLI::ParseError& error) {
  GivenCommand given{&app};
  while (given.app->remaining().empty() && given.Descend()) {
  }
  const std::string help = "`" + given.name + " --help`";
  std::vector<std::string> left = given.app->remaining();
  std::erase(left, "--");
  if (left.empty()) return given.name + ": " + error.what() + "; " + help + " tells more";
  std::vector<std::string> known;
  if (left.front().starts_with('-')) {
    const std::string option = left.front().substr(0, left.front().find('='));
    for (GivenCommand below = given; below.Descend();) {
      if (below.app->get_option_no_throw(option) != nullptr)
        return given.name + ": " + option + " belongs behind `" + below.name + "`";
    }
    for (const CLI::Option* o : given.app->get_options()) {
      for (const std::string& name : o->get_lnames()) known.push_back("--" + name);
    }
    const std::string nearest = Nearest(option, known);
    return given.name + ": there is no option " + option + "; " +
           (nearest.empty() ? help + " lists them" : "did you mean " + nearest + "?");
  }
  for (const CLI::App* command : given.app->get_subcommands([](const CLI::App*) { return true; }))
    known.push_back(command->get_name());
  if (known.empty())
    return given.name + ": one argument too many: " + left.front() + "; " + help + " tells what it takes";
  const std::string nearest = Nearest(left.front(), known);
  return "docent: there is no command `" + given.name + " " + left.front() + "`; " +
         (nearest.empty() ? help + " lists them" : "did you mean `" + given.name + " " + nearest + "`?");
}

}  // namespace
}  // namespace docent

int main(int argc, char** argv) {
  docent::SetMutexChecks();
  setenv("GRPC_VERBOSITY", "NONE", 0);  // what gRPC would log reaches people through our own errors
  setenv("REDLAND_MODULE_PATH", "/dev/null",
         1);  // librdf must not load our own storage module into ourselves
  CLI::App app{"Docent: a semantic context-reasoning server for service robots", "docent"};
  app.set_version_flag("--version", docent::Concat("docent ", docent::VersionWithCommit()));
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
  std::vector<std::string> arguments = docent::WithSignedFacts({argv + 1, argv + argc});
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::cerr << docent::WhatIsWrong(app, error) << "\n";
    return docent::kExitBad;
  }
  return exit_code;
}
