// Reader of property paths in a shapes graph (SHACL section 2.3.1), and of RDF lists. Private to this folder.
// One thread.
#ifndef DOCENT_REASONER_SHAPES_PATH_READER_H_
#define DOCENT_REASONER_SHAPES_PATH_READER_H_

#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/graph_view.h"
#include "reasoner/shapes/shape.h"

namespace docent::shapes {

class PathReader {
 public:
  PathReader(const GraphView& graph, const Dictionary& dictionary, int nesting_limit);

  // nullopt: ill-formed; problem() gives the reason.
  std::optional<Path> Read(TermId node);
  std::optional<std::vector<TermId>> ReadList(TermId head);
  const std::string& problem() const { return problem_; }

 private:
  std::optional<Path> ReadNested(TermId node, int depth);
  std::optional<Path> ReadMembers(Path::Kind kind, TermId list, int depth);
  std::nullopt_t Fail(std::string problem);

  const GraphView& graph_;
  const Dictionary& dictionary_;
  const int nesting_limit_;
  const TermId first_, rest_, nil_;
  std::string problem_;
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_PATH_READER_H_
