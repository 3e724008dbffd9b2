// The SPARQL of shapes (SHACL sections 5 and 6): queries read with their prefixes, held to what SHACL allows where variables
// are given before, and with a property path in the place of $PATH. Private to this folder. Pure; any thread.
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

// Variables that a query may get a value for before it runs. In a sub-SELECT those of `required` must be projected.
struct GivenVariables {
  std::vector<std::string> required;  // this, value, parameters
  std::vector<std::string> optional = {"shapesGraph", "currentShape"};
  bool Has(std::string_view name) const;
};

// What is wrong with `query` by appendix A: MINUS, VALUES, SERVICE, a given variable that is assigned anew, a sub-SELECT
// that does not pass one on. Each with its place in the query.
Diagnostics CheckGiven(const sparql::Query& query, const GivenVariables& given);

// The names of all variables that the query mentions anywhere.
std::vector<std::string> VariablesOf(const sparql::Query& query);

// Puts `path` where the query has ?PATH as a predicate. Diagnostics: places where it stands otherwise.
Diagnostics SubstitutePath(const Path& path, const Dictionary& dictionary, sparql::Query* query);

// A message with the values of variables in it: "{?name} is {$value}". What has no value stays as it is.
std::string FillTemplate(std::string_view text,
                         const std::vector<std::pair<std::string, std::string>>& values);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_QUERY_H_
