// Command-line conventions of all programs (CLI11): help, errors that name the nearest word, exit codes,
// output errors. One thread.
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

// Call it first in main. Opens standard input, output and error if they are closed, so that no file or socket
// gets their numbers. Restores SIGPIPE: if the reader of our output stops, the program ends silently.
void PrepareStandardStreams();

// Parses the arguments, which runs the callbacks. nullopt: parsed. An exit code: --help or --version was
// printed, or an error of usage, in one line that says what to do; the program ends with it. Empty values are
// refused, but for free text.
std::optional<int> ParseArguments(CLI::App* app, std::vector<std::string> arguments);

// Call it last in main. Returns `exit_code`, or kExitBad with a message if standard output could not be
// written.
int EndOutput(const CLI::App& app, int exit_code);

// Lays out --help: value names in capitals, defaults after the description, lines wrapped at the terminal's
// width, else at COLUMNS or 100. Set it on the program before its commands are added; they inherit it.
void UseHelpLayout(CLI::App* app);

}  // namespace docent

#endif  // DOCENT_GRAPH_COMMAND_LINE_PROGRAM_H_
