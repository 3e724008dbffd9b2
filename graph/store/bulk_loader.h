// Loader of large files into a graph: statements are interned while they are parsed, and the indexes are
// built from sorted keys. Writer thread only.
#ifndef DOCENT_GRAPH_STORE_BULK_LOADER_H_
#define DOCENT_GRAPH_STORE_BULK_LOADER_H_

#include <string>
#include <string_view>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/rdf/formats/parser.h"
#include "graph/store/graph_writer.h"

namespace docent {

class BulkLoader {
 public:
  // Statements without a graph go to docent:default. `dictionary` must outlive the loader.
  explicit BulkLoader(Dictionary& dictionary);

  // Adds the statements of a document. After mistakes none of them is added; terms may have been interned.
  Diagnostics Add(std::string_view text, RdfFormat format, const ParseRdfOptions& options);
  // Number of statements so far, with repeats.
  size_t size() const { return quads_.size(); }
  // Adds all of them to the graph of `writer`; the loader is empty afterwards.
  void Build(GraphWriter& writer);

 private:
  void Take(const TermQuad& quad);
  TermId IdOf(const Term& term, int position);

  Dictionary& dictionary_;
  TermId default_graph_;
  std::vector<Quad> quads_;
  // The last term of each position: neighbouring statements mostly share subject, predicate and graph.
  Term last_[4];
  TermId last_id_[4];
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_BULK_LOADER_H_
