// Parser of escapes (after a backslash) in a regular expression. Private to this folder. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_ESCAPE_PARSER_H_
#define DOCENT_GRAPH_SPARQL_REGEX_ESCAPE_PARSER_H_

#include <optional>

#include "graph/sparql/regex/pattern_scanner.h"
#include "graph/sparql/regex/unicode_sets.h"

namespace docent::sparql {

// A character (\n, \\, \-) or a set (\d, \p{L}, \P{IsGreek}).
struct Escape {
  char32_t character = 0;
  CharacterSetPtr set;  // null: it is the character
};

// Reads an escape whose backslash comes next. nullopt: a mistake, which the scanner keeps. A digit after the
// backslash is a mistake.
std::optional<Escape> ReadEscape(PatternScanner* scanner);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_ESCAPE_PARSER_H_
