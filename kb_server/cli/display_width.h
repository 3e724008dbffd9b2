// How many columns a text takes on a terminal (Unicode Standard Annex 11: East Asian Width). Any thread.
#ifndef DOCENT_KB_SERVER_CLI_DISPLAY_WIDTH_H_
#define DOCENT_KB_SERVER_CLI_DISPLAY_WIDTH_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace docent::server {

// Wide characters take two columns, combining marks and other characters without a width none.
size_t DisplayWidth(std::string_view text);

// The text, if it fits into `columns`; else its beginning and "…", together at most so wide. A combining mark stays with
// its letter.
std::string CutToWidth(std::string_view text, size_t columns);

// The text on one line and safe for a terminal: line breaks and tabs as spaces, other hidden characters
// (graph/rdf/hidden_character.h) as U+FFFD, but for joiners after a character beyond ASCII; so are bytes that are not UTF-8.
std::string Printable(std::string_view text);

// The same of several lines: line breaks and tabs stay.
std::string PrintableLines(std::string_view text);

// JSON with these characters as \uXXXX, which means the same. Line breaks stay: they are none of its values.
std::string PrintableJson(std::string_view json);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_DISPLAY_WIDTH_H_
