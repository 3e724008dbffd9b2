// Literals as measured numbers. Any thread.
#ifndef DOCENT_GRAPH_RDF_NUMBER_LITERAL_H_
#define DOCENT_GRAPH_RDF_NUMBER_LITERAL_H_

#include <optional>

#include "graph/rdf/term.h"

namespace docent {

// Whether the literal's datatype is one of XML Schema's numbers: decimal, double, float, integer and what is derived from it.
bool IsNumberLiteral(const Term& term);

// Its value if it is a number literal of a form that XML Schema knows (1.1 Part 2, sections 3.3.3 to 3.3.5 and 3.4.13 on) and
// finite, also as a double. "NaN", "INF" and "1e400" have none.
std::optional<double> FiniteNumber(const Term& term);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_NUMBER_LITERAL_H_
