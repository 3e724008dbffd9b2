// Numeric values of literals. Any thread.
#ifndef DOCENT_GRAPH_RDF_NUMBER_LITERAL_H_
#define DOCENT_GRAPH_RDF_NUMBER_LITERAL_H_

#include <optional>

#include "graph/rdf/term.h"

namespace docent {

// True for XML Schema's numeric datatypes: decimal, double, float, integer and types derived from it.
bool IsNumberLiteral(const Term& term);

// The value of a number literal in a valid form (XML Schema 1.1 Part 2, sections 3.3.3 to 3.3.5 and 3.4.13
// on) whose value is finite as a double. nullopt for "NaN", "INF" and "1e400".
std::optional<double> FiniteNumber(const Term& term);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_NUMBER_LITERAL_H_
