// Parser of a class of characters in brackets (XSD 1.1 part 2, G.4.1): [a-z], [^\d_], [a-z-[aeiou]]. Private to this
// folder. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_CLASS_PARSER_H_
#define DOCENT_GRAPH_SPARQL_REGEX_CLASS_PARSER_H_

#include "graph/sparql/regex/pattern_scanner.h"
#include "graph/sparql/regex/unicode_sets.h"

namespace docent::sparql {

struct ClassOptions {
  bool ignore_case = false;       // flag i
  int nesting = 0;                // classes that may stand inside each other
  size_t* ranges_left = nullptr;  // of regex_ranges
};

// Reads a class whose '[' comes next. Where there is a mistake, the scanner has it and the set has no meaning.
CharacterSet ReadClass(PatternScanner* scanner, const ClassOptions& options);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_CLASS_PARSER_H_
