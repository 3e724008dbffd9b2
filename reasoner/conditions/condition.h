// One distinct standing query: its witnesses, and the watches in the discrimination indexes that they and
// their absence need. Private to this folder. Writer thread only.
//
// A condition without key variables has at most one witness; it *holds* if it has one. With key variables it
// has a witness for each distinct binding of them.
//
// Invariant between updates: every change that could give a new witness, or break one that is there, is
// matched by a watch.
#ifndef DOCENT_REASONER_CONDITIONS_CONDITION_H_
#define DOCENT_REASONER_CONDITIONS_CONDITION_H_

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "absl/status/status.h"
#include "absl/types/span.h"
#include "graph/store/graph_version.h"
#include "reasoner/conditions/condition_kind.h"
#include "reasoner/conditions/condition_template.h"
#include "reasoner/conditions/watch_indexes.h"
#include "reasoner/matching/body.h"
#include "reasoner/matching/pattern_index.h"

namespace docent::conditions {

class Condition {
 public:
  using Key = absl::InlinedVector<TermId, 2>;
  using Row = absl::InlinedVector<TermId, 3>;
  using Keys = ConditionKind::Keys;

  // `keys`: columns of `body`. `number` is what references call it. Does not evaluate: call Refresh.
  Condition(uint32_t number, std::unique_ptr<matching::Body> body, Keys keys, WatchIndexes& indexes);
  // A member of `condition_template`, with the template's body and these constants in it. `template` must outlive the condition.
  Condition(uint32_t number, ConditionTemplate* condition_template, ConditionTemplate::Constants constants,
            const Keys& keys);
  ~Condition();
  // For a condition with a body of its own: what is watched alike by all conditions of `template` is watched there. To be
  // armed afterwards. `template` must outlive the condition.
  void SetTemplate(ConditionTemplate* condition_template, ConditionTemplate::Constants constants);
  Condition(const Condition&) = delete;
  Condition& operator=(const Condition&) = delete;

  matching::Body& body() { return kind_->body; }
  const std::vector<matching::Body::Column>& columns() const { return kind_->body.columns(); }
  bool has_keys() const { return kind_->has_keys; }
  const Keys& keys() const { return kind_->keys; }
  bool holds() const { return present_ > 0; }
  bool Has(const Key& key) const { return SlotOf(key) >= 0; }
  // For body(): its constants in it, nothing else.
  std::vector<TermId> Seed() const { return BeginSeed(); }
  std::vector<Key> Present() const;

  // What changed, to be told and to be undone.
  struct Edit {
    uint32_t condition = 0;  // its number
    uint32_t next = 0;       // for the caller's own use
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
  bool keeps_witness() const { return present_ == 0 && !has_keys(); }
  void ForgetKept();
  // Whether Probe has anything to go by: what a change that matches `trigger` binds, or a constant of the query.
  // Otherwise it is a whole evaluation, which costs more the larger the graph is.
  bool narrows(uint32_t trigger) const { return kind_->Narrows(trigger); }
  // `quad` was added or removed and matches `trigger`: takes what new keys come from it.
  // `full_done`: whether a whole evaluation was already made for this update, so nothing is left to find; set
  // when nothing could be bound and one is made here.
  absl::Status Probe(uint32_t trigger, const Quad& quad, bool added, const sparql::RunOptions& run,
                     bool& full_done, Edits& edits);
  // Takes a solution that its template found, if its key is new. `row`: as the template's columns are.
  void Offer(absl::Span<const TermId> row, Edits& edits);
  // Whether what could make it rise does not matter now. It is remembered that such a thing came.
  bool IgnoresRise() {
    if (!holds() || has_keys()) return false;
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

  // For the caller's own use: where the running update lists it, and whether it has groups.
  uint32_t& touched_at() { return touched_at_; }
  bool is_grouped() const { return grouped_; }
  void set_grouped() { grouped_ = true; }

 private:
  enum class Armed : uint8_t { kNothing, kOne, kAll };
  using Watches = absl::InlinedVector<WatchIndexes::Watch, 4>;
  struct Witness {
    Row row;  // its key is a part of it; where there are keys, empty: none
    Watches watches;
  };

  // Of many witnesses: where they are.
  struct Slots {
    absl::flat_hash_map<Key, uint32_t> taken;  // → place in witnesses_
    std::vector<uint32_t> free;
  };
  // So many witnesses are looked through.
  static constexpr size_t kFewWitnesses = 8;

  Key KeyOf(absl::Span<const TermId> row) const;
  bool HasKey(absl::Span<const TermId> row, const Key& key) const;
  int SlotOf(const Key& key) const;  // -1: there is no witness with it
  int NewSlot(const Key& key);       // -1: there is a witness with it; only with keys
  // Takes `row` as witness of its key unless it has one. True if it is new.
  bool Take(absl::Span<const TermId> row, Edits& edits);
  void SetRow(Witness& witness, uint32_t slot, absl::Span<const TermId> row);
  void DropSlot(uint32_t slot, const Key& key);
  void Watch(Witness& witness, uint32_t slot);
  // Whether the witness and its watches stay when it is broken so. Most often it is the same again when what the query
  // says must not be has gone.
  bool KeepsWitness(uint16_t trigger) const;
  // Takes the witness that was kept, if it is one again. It still matches all patterns, or it would have been forgotten:
  // only filters are asked.
  absl::Status TakeKept(const sparql::RunOptions& run, Edits& edits);
  // Of its pattern, with the constants of the template in it.
  QuadPattern ConstantsOf(const matching::Trigger& trigger) const;
  int BlockingTrigger(const GraphVersion& version) const;
  // Whether the trigger has no match with the seed, so that there is no solution.
  bool HasNoMatch(uint16_t trigger, absl::Span<const TermId> seed, const GraphVersion& version) const;
  void WatchTrigger(uint32_t trigger);
  void Disarm();
  // The scratch seed: the constants, nothing else.
  std::vector<TermId>& BeginSeed() const { return kind_->SeedWith(constants_); }
  bool watches_one() const { return armed_ == Armed::kOne; }

  // One cache line that is read where the condition is armed or has many witnesses.
  Watches armed_watches_;
  std::unique_ptr<Slots> slots_;
  std::unique_ptr<matching::Body> own_body_;  // null: the body is the template's
  std::unique_ptr<ConditionKind> own_kind_;
  // Cache lines that every relevant update reads.
  // Without keys: the first, while present_; or kept after it was broken, if it has watches.
  alignas(64) absl::InlinedVector<Witness, 1> witnesses_;
  ConditionKind* kind_;
  const uint32_t number_;
  uint32_t touched_at_ = 0;
  uint32_t present_ = 0;        // witnesses
  int16_t armed_trigger_ = -1;  // kOne: which
  Armed armed_ : 2 = Armed::kNothing;
  bool joined_ : 1 = false;  // it waits at the template
  bool in_vain_ : 1 = false;
  bool blocked_ : 1 = false;    // kOne: nothing matches the trigger now, as a Recheck of this update saw
  bool unlooked_ : 1 = false;   // kAll: whether one would do was not looked at since it fell
  bool has_slots_ : 1 = false;  // slots_ are there, told without a look at their line
  bool grouped_ : 1 = false;
  ConditionTemplate::Constants constants_;  // what tells this condition from others of the template
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_CONDITION_H_
