// Names and argument counts of SPARQL's builtin functions and aggregates. Constant tables; any thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_BUILTINS_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_BUILTINS_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {

struct BuiltinInfo {
  std::string_view name;  // as written in the standard
  Builtin builtin;
  int min_arguments;
  int max_arguments;
};

// By keyword in any case ("URI" and "isURI" are other names of IRI and isIRI). Null if there is none.
const BuiltinInfo* FindBuiltin(std::string_view keyword);
std::string_view NameOf(Builtin builtin);
std::optional<Aggregate::Function> FindAggregate(std::string_view keyword);
std::string_view NameOf(Aggregate::Function function);
// All names, for hints.
std::vector<std::string> BuiltinNames();

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_BUILTINS_H_
