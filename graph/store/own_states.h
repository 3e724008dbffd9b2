// The properties of robots and runs that the server itself reads, as far as they are states: a robot has one status, one
// charge, one current command. They are state properties whatever ontology is loaded (graph/store/batch_applier.h): a robot
// that told docent:Busy and then docent:Standby is free. The project's ontology declares them, too. Pure functions.
#ifndef DOCENT_GRAPH_STORE_OWN_STATES_H_
#define DOCENT_GRAPH_STORE_OWN_STATES_H_

#include <algorithm>
#include <iterator>
#include <string_view>

#include "graph/rdf/vocabulary.h"

namespace docent {

// Local names, after https://w3id.org/docent#.
inline constexpr std::string_view kOwnStates[] = {
    "status",  "outOfService",   "x",        "y",           "heading",       "localised",
    "battery", "currentCommand", "progress", "lastUsed",    "lastSeenAt",    "incarnation",
    "heldBy",  "runState",       "pausedAt", "pauseReason", "adapterAddress"};

inline bool IsOwnState(std::string_view property) {
  return property.starts_with(kDocentNs) &&
         std::find(std::begin(kOwnStates), std::end(kOwnStates), property.substr(kDocentNs.size())) !=
             std::end(kOwnStates);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_OWN_STATES_H_
