// Whether properties can have the values that a repair gives them, as the ontology declares the properties. Pure; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_POSSIBLE_VALUES_H_
#define DOCENT_REASONER_EXPLAIN_POSSIBLE_VALUES_H_

#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/repair.h"

namespace docent::explain {

// False:
// - a docent:StateProperty would need two values of one source: the later one replaces the earlier one;
// - an owl:FunctionalProperty would get a second value, or a value of an owl:InverseFunctionalProperty a second subject: it says
//   what a thing is, and not in which state it is.
bool HasPossibleValues(const Repair& repair, const GraphVersion& version, const Dictionary& dictionary);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_POSSIBLE_VALUES_H_
