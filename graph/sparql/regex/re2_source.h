// Translation of a regular expression into RE2's syntax, if RE2 supports it and compiles it fast. Private to
// this folder. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_RE2_SOURCE_H_
#define DOCENT_GRAPH_SPARQL_REGEX_RE2_SOURCE_H_

#include <optional>
#include <string>

#include "graph/sparql/regex/regex_tree.h"

namespace docent::sparql {

// An RE2 expression with the same matches under RE2's default options; its groups have the same numbers if
// `capture`, else it has none. Under flag m, RE2 differs at the end of a text whose last character is a
// newline: RE2's anchors match there, XPath's do not. nullopt: it has back-references, or bounds or a size
// beyond RE2's range.
std::optional<std::string> Re2Source(const RegexTree& tree, bool capture);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_RE2_SOURCE_H_
