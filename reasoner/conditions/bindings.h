// Order of bindings in answers to users. Private to this folder. Any thread.
#ifndef DOCENT_REASONER_CONDITIONS_BINDINGS_H_
#define DOCENT_REASONER_CONDITIONS_BINDINGS_H_

#include <vector>

#include "graph/rdf/dictionary.h"
#include "reasoner/conditions/standing_conditions.h"

namespace docent::conditions {

// Sorts by the values, first variable first, in SPARQL's term order (CompareTerms).
void SortBindings(std::vector<Binding>& bindings, const Dictionary& dictionary);

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_BINDINGS_H_
