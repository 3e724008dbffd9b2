// Check of the constant arguments of REGEX and REPLACE: a constant pattern, flags or replacement that can
// never be evaluated is a mistake of the query text. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_REGEX_ARGUMENTS_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_REGEX_ARGUMENTS_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {

struct ArgumentMistake {
  SourceSpan span;  // in the text
  std::string message;
  std::string hint;
};

// `call`: any call of a builtin. `text`: the text that its spans point into.
std::optional<ArgumentMistake> FindRegexMistake(const Expression& call, std::string_view text);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_REGEX_ARGUMENTS_H_
