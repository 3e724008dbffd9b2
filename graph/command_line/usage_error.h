// Messages for wrong arguments, in place of CLI11's: what is wrong, which value, what to write. One thread.
#ifndef DOCENT_GRAPH_COMMAND_LINE_USAGE_ERROR_H_
#define DOCENT_GRAPH_COMMAND_LINE_USAGE_ERROR_H_

#include <cstdint>
#include <string>

#include "CLI/App.hpp"

namespace docent {

// Has every option of the program and its commands refuse an empty value, but those of free text (type name TEXT or
// TURTLE): an unset variable of a shell is not the same as an option that is not given.
void RefuseEmptyValues(CLI::App* app);

// Check of an option: a whole number, `least` or more. CLI11 takes -1 for the largest number of 64 bits.
CLI::Validator AtLeast(uint64_t least);

// Text of an error that the options of `command` threw, `name` being its full name ("docent load"). Options may be
// tried with other values, so they must not be used afterwards.
std::string UsageErrorText(const CLI::Error& error, CLI::App* command, const std::string& name);

}  // namespace docent

#endif  // DOCENT_GRAPH_COMMAND_LINE_USAGE_ERROR_H_
