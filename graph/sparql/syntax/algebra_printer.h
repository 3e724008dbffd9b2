// Printer of the algebra as SPARQL text: for `docent check --ask`, error messages, tests (parse, print, parse
// again gives the same). Any thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_PRINTER_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_PRINTER_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {

struct PrintOptions {
  // Used to shorten IRIs; a printed query declares the used ones at its head.
  std::vector<std::pair<std::string, std::string>> prefixes;
  bool declare_prefixes = true;
};

// A query text that parses to a query with the same meaning and the same text. Indented, one triple a line.
// Hidden variables of blank nodes are printed as _:label, those of path steps as ?_pN.
std::string PrintQuery(const Query& query, const PrintOptions& options = {});
// A group: "{ … }".
std::string PrintPattern(const Algebra& algebra, const PrintOptions& options = {});
std::string PrintExpression(const Expression& expression, const PrintOptions& options = {});
std::string PrintTriple(const TriplePattern& triple, const PrintOptions& options = {});
// The text with each run of white space replaced by one space.
std::string OnOneLine(std::string_view text);

// The algebra as an S-expression, in the notation of the SPARQL 1.1 examples: (join (bgp …) (filter …)). For
// tests and for people who study a query.
std::string PrintAlgebra(const Algebra& algebra);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_PRINTER_H_
