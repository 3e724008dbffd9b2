#include "graph/store/server_graphs.h"

#include "graph/base/text.h"

namespace docent {

std::string RefuseGraph(const Term& graph) {
  if (!graph.IsIri()) {
    return graph.IsBlank() ? "a graph of the store is named by an IRI, and this is a blank node"
                           : "a graph of the store is named by an IRI, and this is a literal";
  }
  if (!IsToldByServer(graph.lexical)) return "";
  return Concat("the graph <", graph.lexical,
                "> is one of those that only the server writes; name another graph or source");
}

std::string RefuseRemoval(const Term& graph) {
  if (graph.IsIri() && !IsServerGraph(graph.lexical)) return "";
  return RefuseGraph(graph);
}

}  // namespace docent
