// Where the parsers put what they read: gathers quads, names blank nodes, holds terms to their size limit.
// Included only by the parsers of this folder. One thread.
#ifndef DOCENT_KB_SERVER_RDF_QUAD_COLLECTOR_H_
#define DOCENT_KB_SERVER_RDF_QUAD_COLLECTOR_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "kb_server/rdf/term.h"

namespace docent {

class QuadCollector {
 public:
  explicit QuadCollector(std::string scope) : scope_(std::move(scope)) {}

  // The blank node that the document calls `label`.
  Term NamedBlank(std::string_view label);
  // A blank node without a label in the document; its final label ("b1", "b2" …, none that the document uses)
  // is given by TakeQuads.
  Term NewBlank();

  void Add(TermQuad quad) { quads_.push_back(std::move(quad)); }

  // All quads; the collector is empty afterwards.
  std::vector<TermQuad> TakeQuads();

 private:
  std::string scope_;
  std::vector<TermQuad> quads_;
  absl::flat_hash_set<std::string> named_like_new_;  // labels of the document of the form b[0-9]+
  uint64_t new_blanks_ = 0;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_RDF_QUAD_COLLECTOR_H_
