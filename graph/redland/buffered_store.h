// A transaction over a store: changes are kept here until Commit, and show in what is found meanwhile.
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

  // As the base would answer if the changes had been made. With changes under way an answer is collected
  // whole.
  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  // Keeps the changes; nothing is checked before Commit.
  absl::Status Apply(std::vector<QuadOperation> operations) override;

  // Quads whose last change is kept here.
  size_t changes() const { return changes_.size(); }
  // The kept changes, ordered by quad.
  std::vector<QuadOperation> Operations() const;
  // Brings all changes to the base at once. Whatever it answers, none are kept afterwards: they are made, or
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
  absl::flat_hash_map<TermQuad, QuadOperation::Kind, HashQuad> changes_;  // the last of each quad
};

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_BUFFERED_STORE_H_
