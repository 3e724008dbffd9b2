// A transaction over a store: changes are kept here until Commit; Find already sees them.
#ifndef DOCENT_GRAPH_REDLAND_BUFFERED_STORE_H_
#define DOCENT_GRAPH_REDLAND_BUFFERED_STORE_H_

#include <memory>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/redland/quad_store.h"

namespace docent::redland {

class BufferedStore final : public QuadStore {
 public:
  // `base` must outlive it.
  explicit BufferedStore(QuadStore* base) : base_(*base) {}

  // Answers as the base would after the changes. With pending changes the whole answer is collected
  // first.
  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  // Keeps the changes; they are not checked before Commit.
  absl::Status Apply(std::vector<QuadOperation> operations) override;

  // Number of quads with a pending change.
  size_t changes() const { return changes_.size(); }
  // The pending changes, ordered by quad.
  std::vector<QuadOperation> Operations() const;
  // Applies all changes to the base at once. Afterwards none are pending: they were applied, or
  // refused.
  absl::Status Commit();

 private:
  absl::StatusOr<bool> InBase(const TermQuad& quad);

  struct HashQuad {
    size_t operator()(const TermQuad& quad) const {
      return absl::HashOf(quad.subject, quad.predicate, quad.object, quad.graph);
    }
  };
  QuadStore& base_;
  absl::flat_hash_map<TermQuad, QuadOperation::Kind, HashQuad> changes_;  // the last change of each quad
};

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_BUFFERED_STORE_H_
