// The first stage of a turn: a batch of text becomes changes of the graph.
//
//  - terms are checked and interned; quads without a graph go to the batch's source, or to docent:default
//  - kAssert: a new value of a property typed docent:StateProperty replaces the old one of the same subject and graph,
//    the last in the batch wins
//  - a fact told with a lifetime is withdrawn when it has passed, unless told again; the clock batch of that time does it
//  - sensor readings become facts by the graph's docent:ReadingMapping resources (reading_mapper.h)
//
// Commit or Rollback at the end of each turn, together with the writer. Writer thread only.
#ifndef DOCENT_KB_SERVER_STORE_BATCH_APPLIER_H_
#define DOCENT_KB_SERVER_STORE_BATCH_APPLIER_H_

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "kb_server/base/limits.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/store/delta.h"
#include "kb_server/store/delta_sum.h"
#include "kb_server/store/graph_writer.h"
#include "kb_server/store/write_batch.h"

namespace docent {

class BatchApplier {
 public:
  // `dictionary` must outlive the applier.
  BatchApplier(Dictionary& dictionary, const Limits& limits);

  // The net change. INVALID_ARGUMENT naming the operation and the term ("operations[3]: …"), RESOURCE_EXHAUSTED for a term
  // over term_bytes: the graph is as it was.
  absl::StatusOr<Delta> Apply(const WriteBatch& batch, GraphWriter& writer);

  // When the next lifetime ends, if any.
  std::optional<TimeMicros> NextDeadline() const;

  void Commit();
  void Rollback();

 private:
  absl::Status Check(const QuadOperation& operation, size_t index) const;
  Quad Intern(const TermQuad& quad, TermId default_graph);
  void Add(const Quad& quad, const WriteBatch& batch, GraphWriter& writer, DeltaSum* sum);
  void Remove(const Quad& quad, GraphWriter& writer, DeltaSum* sum);
  void Expire(TimeMicros now_us, GraphWriter& writer, DeltaSum* sum);
  void SetDeadline(const Quad& quad, std::optional<TimeMicros> deadline);
  void RefreshStateProperties(const GraphVersion& version);

  Dictionary& dictionary_;
  const Limits limits_;
  const TermId type_;
  const TermId state_property_;
  const TermId default_graph_;

  absl::flat_hash_set<TermId> state_properties_;
  bool state_properties_known_ = false;

  absl::flat_hash_map<Quad, TimeMicros> deadlines_;
  std::set<std::pair<TimeMicros, Quad>> by_deadline_;
  std::vector<std::pair<Quad, std::optional<TimeMicros>>> undo_;  // deadlines before this turn's changes
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_STORE_BATCH_APPLIER_H_
