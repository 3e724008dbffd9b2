// Ids of runs as people write them on a command line. Pure; any thread.
#ifndef DOCENT_KB_SERVER_CLI_RUN_NAME_H_
#define DOCENT_KB_SERVER_CLI_RUN_NAME_H_

#include <string>
#include <string_view>

#include "CLI/App.hpp"

namespace docent::server {

// The id of a run, in which characters that an IRI cannot hold are escaped: "My guide-9" and "My%20guide-9" are one.
std::string RunIdOf(std::string_view text);

// Makes an option or argument take either.
CLI::Option* TakesRunName(CLI::Option* option);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_RUN_NAME_H_
