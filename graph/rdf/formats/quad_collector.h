// Output of the parsers: collects quads, names blank nodes, enforces the size limit of terms. Included only
// by the parsers of this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_QUAD_COLLECTOR_H_
#define DOCENT_GRAPH_RDF_FORMATS_QUAD_COLLECTOR_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/rdf/term.h"
#include "graph/rdf/text_bytes.h"

namespace docent {

class QuadCollector {
 public:
  // `limits` bounds the document; `memory` counts what is collected, too, if it is not null.
  QuadCollector(std::string scope, const Limits& limits, MemoryUse* memory)
      : scope_(std::move(scope)),
        memory_(memory),
        memory_bytes_(limits.query_memory_bytes),
        most_(std::max(kFewQuads, limits.document_bytes / kBytesOfQuad)),
        most_bytes_(std::max(kFewBytes, limits.document_bytes > SIZE_MAX / kGrowth
                                            ? SIZE_MAX
                                            : limits.document_bytes * kGrowth)) {}

  // The blank node with this label in the document.
  Term NamedBlank(std::string_view label);
  // A blank node without a label in the document; TakeQuads gives it its final label ("b1", "b2" …, none that
  // the document uses).
  Term NewBlank();

  // False if the quad exceeds the number of quads or the size of all texts (see Refusal); short names under a
  // long prefix reach the latter. A quad takes many times the memory of its shortest text.
  bool Add(TermQuad quad) {
    if (quads_ == most_ || !Charge(TextBytes(quad), sizeof(TermQuad))) return false;
    if (quads_++ % kQuadsAPiece == 0) {
      pieces_.emplace_back();
      if (pieces_.size() > 1) pieces_.back().reserve(kQuadsAPiece);
    }
    pieces_.back().push_back(std::move(quad));
    return true;
  }
  // Counts text that a parser keeps beside the quads, and what keeping it takes in addition.
  bool Charge(size_t bytes, size_t more = kBytesKept) {
    bytes_ += bytes;
    uncounted_ += bytes + more;
    return bytes_ <= most_bytes_ && (uncounted_ < kBytesAChunk || Count());
  }
  std::string Refusal() const;
  // RESOURCE_EXHAUSTED if `memory` was not enough. Nothing more is to be read then.
  const absl::Status& stopped() const { return stopped_; }

  // Moves all quads out; the collector is empty afterwards.
  std::vector<TermQuad> TakeQuads();

 private:
  std::vector<TermQuad> Joined();
  static constexpr size_t kBytesOfQuad = 32;  // of text for each quad
  static constexpr size_t kFewQuads = 1000;   // allowed in any case
  static constexpr size_t kGrowth = 16;       // bytes of all terms for each byte of the limit
  static constexpr size_t kFewBytes = 1 << 20;

  static constexpr size_t kBytesAChunk = 64u << 10;
  static constexpr size_t kBytesKept = 64;
  bool Count();

  std::string scope_;
  MemoryUse* const memory_;
  const size_t memory_bytes_;
  size_t uncounted_ = 0;
  absl::Status stopped_;
  const size_t most_, most_bytes_;
  size_t bytes_ = 0;
  // In pieces: an array that grows takes twice as much, the old and the new one, as soon as it is large.
  static constexpr size_t kQuadsAPiece = 1u << 15;
  std::vector<std::vector<TermQuad>> pieces_;
  size_t quads_ = 0;
  absl::flat_hash_set<uint64_t> named_like_new_;  // N of the document's labels of the form bN
  uint64_t new_blanks_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_QUAD_COLLECTOR_H_
