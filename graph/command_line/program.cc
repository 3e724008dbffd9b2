#include "graph/command_line/program.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <new>

#include "graph/base/diagnostic.h"
#include "graph/command_line/help_layout.h"
#include "graph/command_line/usage_error.h"

namespace docent {
namespace {

// The given command, as far as it was parsed, and its full name: "docent ontology list".
struct GivenCommand {
  CLI::App* app;
  std::string name;

  // Descends to the given subcommand; false: there is none.
  bool Descend() {
    if (app->get_subcommands().empty()) return false;
    app = app->get_subcommands().front();
    name += " " + app->get_name();
    return true;
  }
};

// The first command level with unparsed words, or the deepest one.
GivenCommand Understood(CLI::App* app) {
  GivenCommand given{app, app->get_name()};
  while (given.app->remaining().empty() && given.Descend()) {
  }
  return given;
}

std::vector<std::string> Left(const GivenCommand& given) {
  std::vector<std::string> left = given.app->remaining();
  std::erase(left, "--");
  return left;
}

std::string WrongOption(const GivenCommand& given, const std::string& argument) {
  const std::string option = argument.substr(0, argument.find('='));
  for (GivenCommand below = given; below.Descend();) {
    if (below.app->get_option_no_throw(option) != nullptr)
      return given.name + ": " + option + " belongs behind `" + below.name + "`";
  }
  std::vector<std::string> known;
  for (const CLI::Option* o : std::as_const(*given.app).get_options()) {
    for (const std::string& name : o->get_lnames()) known.push_back("--" + name);
  }
  const std::string nearest = Nearest(option, known);
  return given.name + ": there is no option " + option + "; " +
         (nearest.empty() ? "`" + given.name + " --help` lists them" : "did you mean " + nearest + "?");
}

// Error text for wrong arguments, with what to do. CLI11's own messages are too general: for an unknown
// command it only says that a command is missing, for an unknown option that it was not expected.
std::string WhatIsWrong(CLI::App* app, const CLI::Error& error) {
  const GivenCommand given = Understood(app);
  const std::vector<std::string> left = Left(given);
  const std::string help = "`" + given.name + " --help`";
  if (left.empty())
    return given.name + ": " + UsageErrorText(error, given.app, given.name) + "; " + help + " tells more";
  if (left.front().starts_with('-')) return WrongOption(given, left.front());
  std::vector<std::string> known;
  for (const CLI::App* command : given.app->get_subcommands([](CLI::App*) { return true; }))
    known.push_back(command->get_name());
  if (known.empty())
    return given.name + ": one argument too many: " + left.front() + "; " + help + " shows its arguments";
  const std::string nearest = Nearest(left.front(), known);
  return app->get_name() + ": there is no command `" + given.name + " " + left.front() + "`; " +
         (nearest.empty() ? help + " lists them" : "did you mean `" + given.name + " " + nearest + "`?");
}

}  // namespace

void PrepareStandardStreams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is this one. Opened read-only for output, so that writes fail as on a closed
    // descriptor.
    (void)!open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
  signal(SIGPIPE, SIG_DFL);
}

std::optional<int> ParseArguments(CLI::App* app, std::vector<std::string> arguments) {
  RefuseEmptyValues(app);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app->parse(arguments);
  } catch (const CLI::ParseError& error) {
    const bool help = error.get_exit_code() == 0;  // --help or --version
    if (help && Left(Understood(app)).empty()) return EndOutput(*app, app->exit(error));
    std::cerr << WhatIsWrong(app, error) << "\n";
    return kExitBad;
  } catch (const std::bad_alloc&) {
    std::cerr << app->get_name()
              << ": there is not enough memory for this; cut the input into smaller files\n";
    return kExitBad;
  }
  return std::nullopt;
}

int EndOutput(const CLI::App& app, int exit_code) {
  errno = 0;
  std::cout.flush();
  if (std::cout) return exit_code;
  const char* reason = errno == 0 ? "" : strerror(errno);
  std::cerr << app.get_name() << ": the result could not be written to standard output"
            << (*reason == '\0' ? "" : ": ") << reason << "\n";
  return kExitBad;
}

void UseHelpLayout(CLI::App* app) {
  app->formatter(std::make_shared<HelpLayout>());
}

}  // namespace docent
