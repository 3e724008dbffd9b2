// Manners of a program with a command line (CLI11): help, errors that name the nearest word, exit codes, output that cannot
// be written. One thread.
#ifndef DOCENT_GRAPH_COMMAND_LINE_PROGRAM_H_
#define DOCENT_GRAPH_COMMAND_LINE_PROGRAM_H_

#include <optional>
#include <string>
#include <vector>

#include "CLI/App.hpp"

namespace docent {

// Exit codes of every program and command.
inline constexpr int kExitOk = 0;
inline constexpr int kExitNegative =
    1;                              // a negative answer: ASK is false, a run failed, a check found errors
inline constexpr int kExitBad = 2;  // bad usage or input, no server, output that cannot be written

// First of all in main: standard input, output and error are open, so that no file or socket gets their numbers, and a
// program that reads our output and stops ends us without a word (SIGPIPE).
void PrepareStandardStreams();

// Parses the arguments, which runs the callbacks. --help and --version print and end the program, and so do errors of
// usage, in one line that says what to do: the exit code. nullopt: parsed, and the callbacks have run.
std::optional<int> ParseArguments(CLI::App* app, std::vector<std::string> arguments);

// Last of all in main: `exit_code`, or kExitBad with a message where standard output could not be written.
int EndOutput(const CLI::App& app, int exit_code);

// Lays out --help: names in capitals for values, defaults behind the description, lines wrapped at the terminal's width,
// else at COLUMNS or 100. Given to the program; its commands inherit it if they are added later.
void UseHelpLayout(CLI::App* app);

}  // namespace docent

#endif  // DOCENT_GRAPH_COMMAND_LINE_PROGRAM_H_
