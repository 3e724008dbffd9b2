// View of some graphs of a version as one RDF graph: SHACL's data graph or shapes graph. A triple in several
// of them counts once. Value over a version that must outlive it; any thread.
#ifndef DOCENT_REASONER_SHAPES_GRAPH_VIEW_H_
#define DOCENT_REASONER_SHAPES_GRAPH_VIEW_H_

#include <algorithm>
#include <utility>
#include <vector>

#include "graph/store/graph_version.h"

namespace docent::shapes {

// Placeholder for a term that is not in the dictionary: it matches nothing, and is not a wildcard.
inline constexpr TermId kAbsentTerm = TermId::Make(TermId::Tag::kLocal, (uint64_t{1} << 60) - 2);

class GraphView {
 public:
  // All graphs of the version.
  explicit GraphView(const GraphVersion& version) : version_(&version), all_(true) {}
  // These graphs; they need not exist.
  GraphView(const GraphVersion& version, std::vector<TermId> graphs)
      : version_(&version), all_(false), graphs_(std::move(graphs)) {
    std::sort(graphs_.begin(), graphs_.end());
  }

  const GraphVersion& version() const { return *version_; }
  // True for all graphs of the version; false: graphs().
  bool IsWhole() const { return all_; }
  const std::vector<TermId>& graphs() const { return graphs_; }

  // Calls `visit(quad)` for each distinct matching triple (kNone is a wildcard) until it returns false.
  template <typename Visit>
  void ForEach(TermId subject, TermId predicate, TermId object, const Visit& visit) const {
    Quad last;
    for (QuadCursor c = version_->Scan({subject, predicate, object, TermId()}); c.Valid(); c.Next()) {
      const Quad quad = c.quad();
      if (!all_ && !std::binary_search(graphs_.begin(), graphs_.end(), quad.graph)) continue;
      if (quad.subject == last.subject && quad.predicate == last.predicate && quad.object == last.object)
        continue;
      last = quad;
      if (!visit(quad)) return;
    }
  }
  // No wildcards here.
  bool Contains(TermId subject, TermId predicate, TermId object) const {
    bool found = false;
    ForEach(subject, predicate, object, [&found](const Quad&) {
      found = true;
      return false;
    });
    return found;
  }
  std::vector<TermId> Objects(TermId subject, TermId predicate) const {
    std::vector<TermId> out;
    ForEach(subject, predicate, TermId(), [&out](const Quad& q) {
      out.push_back(q.object);
      return true;
    });
    return out;
  }
  std::vector<TermId> Subjects(TermId predicate, TermId object) const {
    std::vector<TermId> out;
    ForEach(TermId(), predicate, object, [&out](const Quad& q) {
      out.push_back(q.subject);
      return true;
    });
    return out;
  }

 private:
  const GraphVersion* version_;
  bool all_;
  std::vector<TermId> graphs_;  // sorted
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_GRAPH_VIEW_H_
