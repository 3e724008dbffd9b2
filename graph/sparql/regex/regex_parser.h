// Parser of the regular expressions of XPath and XQuery Functions and Operators 3.1 (5.6.1 and 5.6.2), used
// by SPARQL's REGEX and REPLACE and SHACL's sh:pattern: those of XSD 1.1 part 2 appendix G with ^ and $,
// reluctant quantifiers, groups that do not capture, and back-references. Constructs of other languages
// (look-around, (?i), \b, \A, POSIX classes) are mistakes. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_PARSER_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_PARSER_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/regex_limits.h"
#include "graph/sparql/regex/regex_tree.h"

namespace docent::sparql {

// A mistake in a regular expression, its flags, or its replacement text.
struct RegexMistake {
  enum class Where : uint8_t { kPattern, kFlags, kReplacement };
  std::string message;
  std::string hint;
  Where where = Where::kPattern;
  size_t offset = 0;  // of the first wrong byte in that text
  size_t length = 1;  // bytes
};

// Reads `pattern` into *tree. The flags are s, m, i, x and q, each any number of times. Both texts are UTF-8.
std::optional<RegexMistake> ParseRegex(std::string_view pattern, std::string_view flags, RegexTree* tree,
                                       const RegexLimits& limits = {});

// Checks the flags alone.
std::optional<RegexMistake> FindFlagMistake(std::string_view flags);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_PARSER_H_
