// The first stage of a turn: turns a batch of text into changes of the graph.
//
//  - terms are checked and interned; quads without a graph go to the batch's source, or to
//    docent:default
//  - kAssert: a new value of a property that the graph types docent:StateProperty, or that is a state of the
//    server's own (own_states.h), replaces the old one of the same subject and graph; the last in the batch wins
//  - a fact with a lifetime is withdrawn when the lifetime ends, unless it is asserted again: with a new
//    lifetime, or without one (then it stays). The first batch at or after that time withdraws it, or a
//    clock batch if no other comes
//  - sensor readings become facts by the graph's docent:ReadingMapping resources (reading_mapper.h)
//
// Commit or Rollback at the end of each turn, together with the writer. Writer thread only.
#ifndef DOCENT_GRAPH_STORE_BATCH_APPLIER_H_
#define DOCENT_GRAPH_STORE_BATCH_APPLIER_H_

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/delta.h"
#include "graph/store/delta_sum.h"
#include "graph/store/graph_writer.h"
#include "graph/store/write_batch.h"

namespace docent {

class BatchApplier {
 public:
  // `dictionary` must outlive the applier.
  BatchApplier(Dictionary& dictionary, const Limits& limits);

  // The net change. INVALID_ARGUMENT naming the place ("add[3]: subject: …", "readings[0]: …", "source: …"):
  // a term that RDF does not allow (term_check.h), a graph that is no IRI or that only the server writes, a
  // reading without a mapping. RESOURCE_EXHAUSTED: a term over term_bytes. After an error the graph is
  // unchanged and no term was interned.
  // `first`: the server's own changes for this batch; applied before its operations, not checked.
  absl::StatusOr<Delta> Apply(const WriteBatch& batch, GraphWriter& writer,
                              absl::Span<const QuadOperation> first = {});

  // The `… rdf:type C` of the last Apply where C is docent:Event or a class below it, in order, whether or not the graph had
  // them; those of graphs that documents fill included. Until the next Apply.
  const std::vector<Quad>& told_events() const { return told_events_; }
  // Looks at a batch before anything of it is applied: the classes that it puts below docent:Event count for its own events.
  void Announce(const WriteBatch& batch, const GraphVersion& version);
  // Whether a type makes a thing an event, as the graph and the batch of the last Announce say.
  bool IsEventClass(const Term& type) const;

  // Others changed the graph so: rules, a run. They may have declared state properties or event classes.
  void Learn(const Delta& delta);

  // Removes facts with their lifetimes.
  Delta Withdraw(absl::Span<const Quad> quads, GraphWriter& writer);

  // The end of the next lifetime, if any.
  std::optional<TimeMicros> NextDeadline() const;

  // The running lifetimes by their end. Below: restores them into a new applier (start from a snapshot).
  std::vector<std::pair<TimeMicros, Quad>> Lifetimes() const {
    return {by_deadline_.begin(), by_deadline_.end()};
  }
  void RestoreLifetimes(const std::vector<std::pair<TimeMicros, Quad>>& lifetimes);

  void Commit();
  void Rollback();

 private:
  absl::Status Check(const WriteBatch& batch) const;
  Quad Intern(const TermQuad& quad, TermId default_graph);
  std::vector<Quad> InternAll(const std::vector<QuadOperation>& operations, TermId default_graph);
  // nullopt if one of its terms was never interned, so that the graph cannot hold the quad.
  std::optional<Quad> Find(const TermQuad& quad, TermId default_graph) const;
  void Add(const Quad& quad, const WriteBatch& batch, GraphWriter& writer, DeltaSum* sum);
  void ApplyOne(const QuadOperation& operation, TermId default_graph, const WriteBatch& batch,
                GraphWriter& writer, DeltaSum* sum);
  void AddAll(const WriteBatch& batch, TermId default_graph, GraphWriter& writer, DeltaSum* sum);
  void Remove(const Quad& quad, GraphWriter& writer, DeltaSum* sum);
  void Expire(TimeMicros now_us, GraphWriter& writer, DeltaSum* sum);
  void SetDeadline(const Quad& quad, std::optional<TimeMicros> deadline);
  void RefreshStateProperties(const GraphVersion& version);
  void RefreshEventClasses(const GraphVersion& version);
  // Makes the classes below it in the graph event classes; those that were none.
  std::vector<TermId> AddClassesBelow(TermId above, const GraphVersion& version);
  void NoteEvent(const Quad& quad) {
    if (quad.predicate == type_ && event_classes_.contains(quad.object)) told_events_.push_back(quad);
  }

  Dictionary& dictionary_;
  const Limits limits_;
  const TermId type_;
  const TermId state_property_;
  const TermId default_graph_;
  const TermId subclass_;
  const TermId event_;

  absl::flat_hash_set<TermId> own_states_;
  absl::flat_hash_set<TermId> state_properties_;  // with these
  bool knows_state_properties_ = false;           // state_properties_ is what the graph says

  absl::flat_hash_set<TermId> event_classes_;  // docent:Event and the classes below it
  bool knows_event_classes_ = false;           // event_classes_ is what the graph says
  std::set<Term> announced_classes_;           // those that the batch makes event classes
  std::vector<Quad> told_events_;

  absl::flat_hash_map<Quad, TimeMicros> deadlines_;
  std::set<std::pair<TimeMicros, Quad>> by_deadline_;
  std::vector<std::pair<Quad, std::optional<TimeMicros>>> undo_;  // deadlines before this turn's changes
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_BATCH_APPLIER_H_
