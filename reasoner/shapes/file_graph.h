// Documents as graphs with the places of their triples, for `docent validate` and `docent check` without a
// server. One thread.
#ifndef DOCENT_REASONER_SHAPES_FILE_GRAPH_H_
#define DOCENT_REASONER_SHAPES_FILE_GRAPH_H_

#include <map>
#include <string>

#include "graph/rdf/dictionary.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/store/graph_writer.h"
#include "reasoner/shapes/graph_view.h"
#include "reasoner/shapes/source_map.h"

namespace docent::shapes {

class FileGraph {
 public:
  FileGraph() : writer_(nullptr) {}

  // Adds the quads of a document to the graph `name`, ignoring their own graphs. Blank nodes of two documents
  // must have different labels (ParseRdfOptions::blank_node_scope).
  void Add(const std::string& file, const LocatedRdf& document, const std::string& name);

  Dictionary& dictionary() { return dictionary_; }
  const GraphVersion& version() const { return writer_.current(); }
  // The graph for SHACL; invalid after another Add. An unknown name is an empty graph.
  GraphView View(const std::string& name) const;
  const SourceMap& Places(const std::string& name) const;

 private:
  Dictionary dictionary_;
  GraphWriter writer_;
  std::map<std::string, SourceMap> places_;
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_FILE_GRAPH_H_
