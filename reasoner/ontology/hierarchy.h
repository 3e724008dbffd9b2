// Cycles in hierarchies of classes and properties. Pure function.
#ifndef DOCENT_REASONER_ONTOLOGY_HIERARCHY_H_
#define DOCENT_REASONER_ONTOLOGY_HIERARCHY_H_

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "reasoner/ontology/vocabulary.h"

namespace docent::ontology {

// A shortest cycle from `from` over `to` back to `from`, without repeating `from` at its end; empty if there
// is none. O(edges).
std::vector<std::string> CycleThrough(const std::map<std::string, Words, std::less<>>& edges,
                                      const std::string& from, const std::string& to);

}  // namespace docent::ontology

#endif  // DOCENT_REASONER_ONTOLOGY_HIERARCHY_H_
