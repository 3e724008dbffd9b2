// SPARQL queries of shapes (SHACL sections 5 and 6): checks SHACL's restrictions on variables with given
// values, and puts a property path in place of $PATH. Private to this folder. Pure; any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_QUERY_H_
#define DOCENT_REASONER_SHAPES_SHAPE_QUERY_H_

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/shapes/shape.h"

namespace docent::shapes {

// Variables that may get a value before a query runs. A sub-SELECT must project those in `required`.
struct GivenVariables {
  std::vector<std::string> required;  // this, value, parameters
  std::vector<std::string> optional = {"shapesGraph", "currentShape"};
  bool Has(std::string_view name) const;
};

// Violations of appendix A in `query`: MINUS, VALUES, SERVICE, an assignment to a given variable, a
// sub-SELECT that does not project one. Each with its place in the query.
Diagnostics CheckGiven(const sparql::Query& query, const GivenVariables& given);

// The names of all variables in the query.
std::vector<std::string> VariablesOf(const sparql::Query& query);

// Replaces ?PATH as a predicate by `path`. Diagnostics: other places of ?PATH.
Diagnostics SubstitutePath(const Path& path, const Dictionary& dictionary, sparql::Query* query);

// A message with values in place of variables: "{?name} is {$value}". Variables without a value stay.
std::string FillTemplate(std::string_view text,
                         const std::vector<std::pair<std::string, std::string>>& values);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_QUERY_H_
