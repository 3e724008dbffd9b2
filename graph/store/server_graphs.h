// The graphs that the server keeps. Pure functions.
#ifndef DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_
#define DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_

#include <string>
#include <string_view>

#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

// Why clients cannot write to a graph of this name; empty: they can. For ParseRdfOptions::refuse_graph.
std::string RefuseGraph(const Term& graph);

// What turns derive from the others: no batch writes it.
inline bool IsDerivedGraph(std::string_view graph) {
  return graph == kInferredGraph || graph == kRunsGraph;
}
// Only the server writes it, if by batches of its own.
inline bool IsServerGraph(std::string_view graph) {
  return IsDerivedGraph(graph) || graph == kDocumentsGraph || graph == kClockGraph;
}

// A module of ontology has a graph of its own: this and its name. What is not about one graph by name leaves it alone.
inline constexpr std::string_view kModuleGraphs = "https://w3id.org/docent/ontology/";
inline bool IsModuleGraph(std::string_view graph) {
  return graph.starts_with(kModuleGraphs);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_
