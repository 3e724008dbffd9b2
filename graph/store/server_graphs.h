// The graphs that only the server writes. Pure function.
#ifndef DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_
#define DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_

#include <string_view>

#include "graph/rdf/vocabulary.h"

namespace docent {

inline bool IsServerGraph(std::string_view graph) {
  return graph == kInferredGraph || graph == kRunsGraph;
}

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_
