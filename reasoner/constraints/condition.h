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

#include <algorithm>
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

  using Keys = absl::InlinedVector<int16_t, 2>;
  // Of an object that begins with it: the bytes that every update looks at which concerns it.
  static constexpr size_t kLooksFrom = 64, kLooksTo = 256;
  // `keys`: columns of `body`. `number` is what references call it. Does not evaluate: call Refresh.
  Condition(uint32_t number, std::unique_ptr<Body> body, Keys keys, WatchIndexes& indexes);
  // A member of `shape`, with the shape's body and these constants in it. `shape` must outlive the condition.
  Condition(uint32_t number, Shape* shape, Shape::Constants constants, Keys keys, WatchIndexes& indexes);
  ~Condition();
  // For a condition with a body of its own: what is watched alike by all conditions of `shape` is watched there. To be
  // armed afterwards. `shape` must outlive the condition.
  void SetShape(Shape* shape, Shape::Constants constants);
  Condition(const Condition&) = delete;
  Condition& operator=(const Condition&) = delete;

  Body& body() { return *body_; }
  const std::vector<Body::Column>& columns() const { return body_->columns(); }
  bool has_keys() const { return has_keys_; }
  const Keys& keys() const { return keys_; }
  bool holds() const { return present_ > 0; }
  bool Has(const Key& key) const { return SlotOf(key) >= 0; }
  // For body(): its constants in it, nothing else.
  std::vector<TermId> Seed() const;
  std::vector<Key> Present() const;

  // What changed, to be told and to be undone.
  struct Edit {
    uint32_t condition = 0;  // its number
    uint32_t next = 0;  // for the caller's own use
    bool was_present = false;
    bool is_present = false;
    Key key;
    Row before;  // the witness that was there
  };
  using Edits = std::vector<Edit>;

  // The witness `slot` may be broken: looks for another with its key. `trigger`: of which it has lost a match, or gained
  // one; or kSomeTrigger.
  absl::Status Recheck(uint32_t slot, uint16_t trigger, const sparql::RunOptions& run, Edits& edits);
  // A change matched what the witness watches, and the condition does not hold: it was kept in vain.
  bool keeps_witness() const { return !has_keys_ && present_ == 0; }
  void ForgetKept();
  // Whether Probe has anything to go by: what a change that matches `trigger` binds, or a constant of the query.
  // Otherwise it is a whole evaluation, which costs more the larger the graph is.
  bool narrows(uint32_t trigger) const { return (whole_ & (1u << std::min(trigger, 31u))) == 0; }
  // `quad` was added or removed and matches `trigger`: takes what new keys come from it.
  // `full_done`: whether a whole evaluation was already made for this update, so nothing is left to find; set
  // when nothing could be bound and one is made here.
  absl::Status Probe(uint32_t trigger, const Quad& quad, bool added, const sparql::RunOptions& run,
                     bool& full_done, Edits& edits);
  // Takes a solution that its shape found, if its key is new. `row`: as the shape's columns are.
  void Offer(absl::Span<const TermId> row, Edits& edits);
  // Whether what could make it rise does not matter now. It is remembered that such a thing came.
  bool IgnoresRise() {
    if (has_keys() || !holds()) return false;
    in_vain_ = true;
    return true;
  }
  // Takes all new keys that there are, by a whole evaluation.
  absl::Status ProbeAll(const sparql::RunOptions& run, Edits& edits);
  // Whole evaluation, in both directions.
  absl::Status Refresh(const sparql::RunOptions& run, Edits& edits);
  void Undo(const Edit& edit);

  // Brings the rise watches in line with the state on `version`. True if they changed. Without a version
  // every trigger is watched that the state needs. `probed`: a change matched one of them, and nothing rose.
  bool Arm(const GraphVersion* version, bool probed = false);
  // It holds, and what it watches to rise was hit nevertheless. What holds keeps these watches until then: most
  // often it falls before, and needs them again.
  bool watches_in_vain() const { return in_vain_; }

  // For the caller's own use: the update that last touched witness `slot`, or the whole condition and where it is
  // listed there.
  uint64_t& stamp(uint32_t slot) { return witnesses_[slot].stamp; }
  uint64_t& touched_in() { return touched_in_; }
  uint32_t& touched_at() { return touched_at_; }

 private:
  enum class Armed : uint8_t { kNothing, kOne, kAll };
  using Watches = absl::InlinedVector<WatchIndexes::Watch, 4>;
  struct Witness {
    Row row;  // its key is a part of it; where there are keys, empty: none
    Watches watches;
    uint64_t stamp = 0;
  };

  // Of many witnesses: where they are.
  struct Slots {
    absl::flat_hash_map<Key, uint32_t> taken;  // → place in witnesses_
    std::vector<uint32_t> free;
  };
  // So many witnesses are looked through.
  static constexpr size_t kFewWitnesses = 8;

  void Begin();
  Key KeyOf(absl::Span<const TermId> row) const;
  bool HasKey(absl::Span<const TermId> row, const Key& key) const;
  int SlotOf(const Key& key) const;  // -1: there is no witness with it
  int NewSlot(const Key& key);            // -1: there is a witness with it
  // Takes `row` as witness of its key unless it has one. True if it is new.
  bool Take(absl::Span<const TermId> row, Edits& edits);
  void SetRow(uint32_t slot, absl::Span<const TermId> row);
  void DropSlot(uint32_t slot, const Key& key);
  void Watch(uint32_t slot);
  // Whether the witness and its watches stay when it is broken so. Most often it is the same again when what the query
  // says must not be has gone.
  bool KeepsWitness(uint16_t trigger) const;
  // Of its pattern, with the constants of the shape in it.
  QuadPattern ConstantsOf(const Trigger& trigger) const;
  int BlockingTrigger(const GraphVersion& version) const;
  // Whether the trigger has no match with the seed, so that there is no solution.
  bool HasNoMatch(uint16_t trigger, absl::Span<const TermId> seed, const GraphVersion& version) const;
  void WatchTrigger(uint32_t trigger);
  void Disarm();
  // The scratch seed: the constants, nothing else.
  std::vector<TermId>& BeginSeed() const;

  bool Narrows(uint32_t trigger) const;
  // Whether a change may give the column its value, without losing a solution.
  bool MayBind(const Body::Column& column) const { return has_keys() ? column.certain : column.seedable; }
  bool watches_one() const { return armed_ == Armed::kOne; }

  // Which lines of the cache an update looks at matters: those of ten thousands of conditions are most often in none.
  // One that is looked at where there are keys, or to arm it:
  Watches armed_watches_;
  const Keys keys_;
  std::unique_ptr<Slots> slots_;
  const std::unique_ptr<Body> own_;  // null: the body is the shape's
  // and three, with what a derived class begins with, that always are (kLooksFrom to kLooksTo).
  uint64_t touched_in_ = 0;
  uint32_t touched_at_ = 0;
  const uint32_t number_;
  uint32_t present_ = 0;        // witnesses
  uint32_t whole_ = 0;          // triggers, as bits, that do not narrow; the last bit stands for all beyond
  int16_t armed_trigger_ = -1;  // kOne: which
  Armed armed_ = Armed::kNothing;
  const bool has_keys_;
  const bool borrows_ : 1;   // the body is the shape's
  bool joined_ : 1 = false;  // it waits at the shape
  bool in_vain_ = false;
  bool blocked_ = false;   // kOne: nothing matches the trigger now, as a Recheck of this update saw
  bool unlooked_ = false;  // kAll: whether one would do was not looked at since it fell
  Body* const body_;
  WatchIndexes& indexes_;
  Shape* shape_ = nullptr;
  // Without keys: the first, while present_; or kept after it was broken, if it has watches.
  absl::InlinedVector<Witness, 1> witnesses_;
  Shape::Constants constants_;                 // what tells this condition from others of the shape
};

}  // namespace docent

#endif  // DOCENT_REASONER_CONSTRAINTS_CONDITION_H_
