// One distinct standing query: its witnesses, and the watches in the discrimination indexes that they and
// their absence need. Private to this folder. Writer thread only.
//
// A condition without key variables has at most one witness; it *holds* if it has one. With key variables it
// has a witness for each distinct binding of them.
//
// Invariant between updates: every change that could give a new witness, or break one that is there, is
// matched by a watch.
#ifndef DOCENT_REASONER_CONSTRAINTS_CONDITION_H_
#define DOCENT_REASONER_CONSTRAINTS_CONDITION_H_

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/status/status.h"
#include "absl/types/span.h"
#include "kb_server/store/graph_version.h"
#include "reasoner/constraints/shape.h"
#include "reasoner/constraints/watch_indexes.h"
#include "reasoner/matching/body.h"
#include "reasoner/matching/pattern_index.h"

namespace docent {

class Condition {
 public:
  using Key = absl::InlinedVector<TermId, 2>;
  using Row = absl::InlinedVector<TermId, 4>;

  // `keys`: columns of `body`. `number` is what references call it. Does not evaluate: call Refresh.
  Condition(uint32_t number, std::unique_ptr<Body> body, std::vector<int16_t> keys, WatchIndexes& indexes);
  ~Condition();
  // From now on what is watched alike by all conditions of `shape` is watched there. Before the first Arm.
  // `shape` must outlive the condition.
  void SetShape(Shape* shape, Shape::Constants constants);
  Condition(const Condition&) = delete;
  Condition& operator=(const Condition&) = delete;

  Body& body() { return *body_; }
  const std::vector<Body::Column>& columns() const { return body_->columns(); }
  bool has_keys() const { return !keys_.empty(); }
  const std::vector<int16_t>& keys() const { return keys_; }
  bool holds() const { return !by_key_.empty(); }
  bool Has(const Key& key) const { return by_key_.contains(key); }
  std::vector<Key> Present() const;

  // What changed, to be told and to be undone.
  struct Edit {
    Key key;
    bool was_present = false;
    Row before;  // the witness that was there
  };
  using Edits = std::vector<Edit>;

  // The witness `slot` may be broken: looks for another with its key.
  absl::Status Recheck(uint32_t slot, const sparql::RunOptions& run, Edits& edits);
  // `quad` was added or removed and matches `trigger`: takes what new keys come from it.
  // `full_done`: whether a whole evaluation was already made for this update, so nothing is left to find; set
  // when nothing could be bound and one is made here.
  absl::Status Probe(uint32_t trigger, const Quad& quad, const sparql::RunOptions& run, bool& full_done,
                     Edits& edits);
  // Takes a solution that was found elsewhere, if its key is new.
  void Offer(absl::Span<const TermId> row, Edits& edits) {
    if (has_keys() || !holds()) Take(row, edits);
  }
  // Takes all new keys that there are, by a whole evaluation.
  absl::Status ProbeAll(const sparql::RunOptions& run, Edits& edits);
  // Whole evaluation, in both directions.
  absl::Status Refresh(const sparql::RunOptions& run, Edits& edits);
  void Undo(const Edit& edit);

  // Brings the rise watches in line with the state on `version`. True if they changed. Without a version
  // every trigger is watched that the state needs.
  bool Arm(const GraphVersion* version);
  // A rise watch was hit although only one pattern was watched: what was known of it no longer holds.
  bool watches_one() const { return armed_ == Armed::kOne; }

  // The update that last touched witness `slot` or the whole condition, for the caller's own use.
  uint64_t& stamp(uint32_t slot) { return witnesses_[slot].stamp; }

 private:
  enum class Armed : uint8_t { kNothing, kOne, kAll };
  struct Witness {
    Key key;
    Row row;
    uint64_t stamp = 0;
    absl::InlinedVector<PatternIndex::Handle, 3> on_add;
    absl::InlinedVector<PatternIndex::Handle, 3> on_remove;
  };

  Key KeyOf(absl::Span<const TermId> row) const;
  // Takes `row` as witness of its key unless it has one. True if it is new.
  bool Take(absl::Span<const TermId> row, Edits& edits);
  void SetWitness(const Key& key, absl::Span<const TermId> row);
  void DropWitness(const Key& key);
  void Watch(uint32_t slot);
  void Unwatch(Witness& witness);
  int BlockingTrigger(const GraphVersion& version) const;
  void WatchTrigger(uint32_t trigger);
  void Disarm();

  const uint32_t number_;
  const std::unique_ptr<Body> body_;
  const std::vector<int16_t> keys_;
  WatchIndexes& indexes_;
  Shape* shape_ = nullptr;
  Shape::Constants constants_;                 // what tells this condition from others of the shape
  bool joined_ = false;                        // it waits there
  absl::flat_hash_map<Key, uint32_t> by_key_;  // → place in witnesses_
  std::vector<Witness> witnesses_;
  std::vector<uint32_t> free_;
  Armed armed_ = Armed::kNothing;
  int16_t armed_trigger_ = -1;  // kOne: which
  absl::InlinedVector<PatternIndex::Handle, 3> armed_on_add_;
  absl::InlinedVector<PatternIndex::Handle, 3> armed_on_remove_;
  std::vector<TermId> seed_;  // scratch
};

}  // namespace docent

#endif  // DOCENT_REASONER_CONSTRAINTS_CONDITION_H_
