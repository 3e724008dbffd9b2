// Parser of a character class in brackets (XSD 1.1 part 2, G.4.1): [a-z], [^\d_], [a-z-[aeiou]]. Private to
// this folder. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_CLASS_PARSER_H_
#define DOCENT_GRAPH_SPARQL_REGEX_CLASS_PARSER_H_

#include "graph/sparql/regex/pattern_scanner.h"
#include "graph/sparql/regex/unicode_sets.h"

namespace docent::sparql {

struct ClassOptions {
  bool ignore_case = false;       // flag i
  int nesting = 0;                // levels of nested classes that are allowed
  size_t* ranges_left = nullptr;  // remaining part of the limit regex_ranges
};

// Reads a class whose '[' comes next. After a mistake, which the scanner keeps, the set has no meaning.
CharacterSet ReadClass(PatternScanner* scanner, const ClassOptions& options);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_CLASS_PARSER_H_
