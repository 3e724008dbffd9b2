// Translation of a regular expression into RE2's language, for those that RE2 can take and is quick to compile. Private to
// this folder. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_RE2_SOURCE_H_
#define DOCENT_GRAPH_SPARQL_REGEX_RE2_SOURCE_H_

#include <optional>
#include <string>

#include "graph/sparql/regex/regex_tree.h"

namespace docent::sparql {

// An expression that matches the same, by the rules of RE2's default options; its groups have the same numbers where
// `capture`, else it has none. Under flag m, RE2 differs at the end of a text whose last character is a newline: there its
// anchors match, and XPath's do not. nullopt: it has back-references, or bounds or a size beyond what RE2 is good for.
std::optional<std::string> Re2Source(const RegexTree& tree, bool capture);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_RE2_SOURCE_H_
