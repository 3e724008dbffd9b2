#include "graph/redland/quad_store.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace docent::redland {
namespace {

class VectorStream final : public QuadStream {
 public:
  explicit VectorStream(std::vector<TermQuad> quads) : quads_(std::move(quads)) {}
  bool Next(TermQuad* quad) override {
    if (at_ == quads_.size()) return false;
    *quad = std::move(quads_[at_++]);
    return true;
  }

 private:
  std::vector<TermQuad> quads_;
  size_t at_ = 0;
};

}  // namespace

std::unique_ptr<QuadStream> StreamOf(std::vector<TermQuad> quads) {
  return std::make_unique<VectorStream>(std::move(quads));
}

void SortByTriple(std::vector<TermQuad>* quads) {
  std::sort(quads->begin(), quads->end(), TripleOrder);
}

bool TripleOrder(const TermQuad& a, const TermQuad& b) {
  return std::tie(a.subject, a.predicate, a.object, a.graph) <
         std::tie(b.subject, b.predicate, b.object, b.graph);
}

}  // namespace docent::redland
