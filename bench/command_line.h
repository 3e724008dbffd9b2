// Command-line parsing of the benchmarks.
#ifndef DOCENT_BENCH_COMMAND_LINE_H_
#define DOCENT_BENCH_COMMAND_LINE_H_

#include <optional>
#include <string>
#include <vector>

#include "CLI/App.hpp"
#include "CLI/Config.hpp"
#include "CLI/Formatter.hpp"

namespace docent::bench {

// An exit code if the benchmark must not run: help was requested (0), or the arguments are wrong (2); both
// are printed.
inline std::optional<int> Parse(CLI::App* app, const std::vector<std::string>& args) {
  try {
    app->parse(std::vector<std::string>(args.rbegin(), args.rend()));  // CLI11 takes them last first
  } catch (const CLI::ParseError& error) {
    return app->exit(error) == 0 ? 0 : 2;
  }
  return std::nullopt;
}

}  // namespace docent::bench

#endif  // DOCENT_BENCH_COMMAND_LINE_H_
