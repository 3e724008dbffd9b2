// Recorder of quad places. It collects byte offsets during parsing and converts them to lines and columns in
// one pass at the end. Included only by the parsers of this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_PLACE_RECORDER_H_
#define DOCENT_GRAPH_RDF_FORMATS_PLACE_RECORDER_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/formats/located_parser.h"

namespace docent {

class PlaceRecorder {
 public:
  // Offsets are bytes from the beginning of the text.
  void AddQuad(size_t subject, size_t predicate, size_t object) {
    offsets_.push_back({subject, predicate, object});
  }
  void DeclarePrefix(std::string_view prefix, const std::string& iri, size_t offset);
  void UsePrefix(std::string_view prefix);

  // Writes all places into `out`; none if the document has mistakes.
  void Finish(std::string_view text, LocatedRdf* out);

 private:
  struct Offsets {
    size_t subject, predicate, object;
  };
  std::vector<Offsets> offsets_;
  std::vector<QuadPlace> places_;
  std::vector<PrefixPlace> prefixes_;
  std::vector<size_t> prefix_offsets_;
  absl::flat_hash_map<std::string, size_t> newest_;  // prefix → its last declaration
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_PLACE_RECORDER_H_
