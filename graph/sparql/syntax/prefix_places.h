// Prefix declarations of a text with their places and uses. Pure; any thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_PREFIX_PLACES_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_PREFIX_PLACES_H_

#include <string_view>
#include <vector>

#include "graph/rdf/formats/located_parser.h"

namespace docent::sparql {

// The prefixes that a query, an update or a rule document (`.rules`) declares, in order, with the number of
// names that use each. `text` must parse without errors.
std::vector<PrefixPlace> PrefixPlaces(std::string_view text);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_PREFIX_PLACES_H_
