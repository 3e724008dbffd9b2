// Unused prefix declarations of a text, with their places. Pure; any thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_PREFIX_PLACES_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_PREFIX_PLACES_H_

#include <string_view>
#include <vector>

#include "graph/rdf/formats/located_parser.h"

namespace docent::sparql {

// The prefixes that a query, an update or a text made of their productions (`.rules`) declares, in order, and how many
// names use each. `text` must be one that its parser takes.
std::vector<PrefixPlace> PrefixPlaces(std::string_view text);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_PREFIX_PLACES_H_
