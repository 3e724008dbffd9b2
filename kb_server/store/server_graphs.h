// The graphs that the server alone writes. Pure function.
#ifndef DOCENT_KB_SERVER_STORE_SERVER_GRAPHS_H_
#define DOCENT_KB_SERVER_STORE_SERVER_GRAPHS_H_

#include <string_view>

#include "kb_server/rdf/vocabulary.h"

namespace docent {

inline bool IsServerGraph(std::string_view graph) {
  return graph == kInferredGraph || graph == kRunsGraph;
}

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_SERVER_GRAPHS_H_
