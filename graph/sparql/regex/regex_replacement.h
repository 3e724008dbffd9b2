// What REPLACE puts in the place of a match: text with references to groups (XPath and XQuery Functions 3.1, 5.6.4). Pure
// functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_REPLACEMENT_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_REPLACEMENT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/sparql/regex/regex_parser.h"

namespace docent::sparql {

// Fixed texts, each but the last with the group that comes after it.
struct RegexReplacement {
  std::vector<std::string> texts{""};
  std::vector<int> groups;
  size_t text_bytes = 0;  // of all texts
};

// $1 is what group 1 matched, $0 the whole match; \$ and \\ are the characters. `groups`: of the expression; a number above is
// taken for a shorter one with digits behind it, and a single digit above for nothing. `literal` (flag q): all characters
// are themselves.
std::optional<RegexMistake> ReadReplacement(std::string_view replacement, int groups, bool literal,
                                            RegexReplacement* out);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_REPLACEMENT_H_
