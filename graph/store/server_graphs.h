// The graphs that the server keeps. Pure functions.
#ifndef DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_
#define DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_

#include <string>
#include <string_view>

#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

// What turns derive from the others: no batch writes it.
inline bool IsDerivedGraph(std::string_view graph) {
  return graph == kInferredGraph || graph == kRunsGraph;
}
// Only the server writes it, if by batches of its own.
inline bool IsServerGraph(std::string_view graph) {
  return IsDerivedGraph(graph) || graph == kDocumentsGraph || graph == kClockGraph;
}

// What operators say of robots: out of service, reserved. The server tells it when they ask for it.
inline constexpr std::string_view kOperatorGraph = "urn:docent:operator";
// What the run of this IRI told lies in the graph urn:docent:run:ID.
inline constexpr std::string_view kRunGraphs = "urn:docent:run:";
// Only the server adds facts to these graphs, so a reader may rely on who told them. Clients may withdraw facts of runs and
// operators: a fact stays after its run has ended, and then only a client can withdraw it.
inline bool IsToldByServer(std::string_view graph) {
  return IsServerGraph(graph) || graph == kOperatorGraph || graph.starts_with(kRunGraphs);
}

// Why clients cannot add facts to a graph of this name, and what to do; empty: they can. For ParseRdfOptions::refuse_graph.
std::string RefuseGraph(const Term& graph);
// Why they cannot take facts away from it.
std::string RefuseRemoval(const Term& graph);

// A module of ontology has a graph of its own: this and its name. What is not about one graph by name leaves it alone.
inline constexpr std::string_view kModuleGraphs = "https://w3id.org/docent/ontology/";
inline bool IsModuleGraph(std::string_view graph) {
  return graph.starts_with(kModuleGraphs);
}

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_SERVER_GRAPHS_H_
