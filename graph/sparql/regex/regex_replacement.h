// Replacement text of REPLACE, with references to groups (XPath and XQuery Functions 3.1, 5.6.4). Pure
// functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_REPLACEMENT_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_REPLACEMENT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/sparql/regex/regex_parser.h"

namespace docent::sparql {

// Literal texts; each but the last is followed by the text of a group.
struct RegexReplacement {
  std::vector<std::string> texts{""};
  std::vector<int> groups;
  size_t text_bytes = 0;  // of all texts
};

// $1 is the text of group 1, $0 the whole match; \$ and \\ are the characters. `groups`: number of groups of
// the expression; a larger number is read as a shorter one followed by digits, and a single digit above it as
// nothing. `literal` (flag q): all characters stand for themselves.
std::optional<RegexMistake> ReadReplacement(std::string_view replacement, int groups, bool literal,
                                            RegexReplacement* out);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_REPLACEMENT_H_
