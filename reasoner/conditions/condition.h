// One distinct standing query: its witnesses (solutions), and its watches in the discrimination indexes.
// Private to this folder. Writer thread only.
//
// A condition without key variables has at most one witness; it *holds* if it has one. With key variables it
// has a witness for each distinct binding of them.
//
// Invariant between updates: every change that could give a new witness, or break an existing one, is matched
// by a watch.
#ifndef DOCENT_REASONER_CONDITIONS_CONDITION_H_
#define DOCENT_REASONER_CONDITIONS_CONDITION_H_

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
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

  // `keys`: columns of `body`. `number`: its number in references. Does not evaluate: call Refresh.
  Condition(uint32_t number, std::unique_ptr<matching::Body> body, Keys keys, WatchIndexes& indexes);
  // A member of `condition_template`: the template's body with these constants. `condition_template` must
  // outlive the condition.
  Condition(uint32_t number, ConditionTemplate* condition_template, ConditionTemplate::Constants constants,
            const Keys& keys);
  ~Condition();
  // For a condition with a body of its own: the template takes over the watches that all its conditions
  // share. Arm the condition afterwards. The template must outlive the condition.
  void SetTemplate(ConditionTemplate* condition_template, ConditionTemplate::Constants constants);
  Condition(const Condition&) = delete;
  Condition& operator=(const Condition&) = delete;

  matching::Body& body() { return kind_->body; }
  const std::vector<matching::Body::Column>& columns() const { return kind_->body.columns(); }
  bool has_keys() const { return kind_->has_keys; }
  const Keys& keys() const { return kind_->keys; }
  bool holds() const { return present_ > 0; }
  bool Has(const Key& key) const { return SlotOf(key) >= 0; }
  // The seed for body(): only the constants are bound.
  std::vector<TermId> Seed() const { return BeginSeed(); }
  std::vector<Key> Present() const;

  // Whether a change of a quad with this subject and predicate may change the answer; `type`: rdf:type, of which the object
  // counts, too.
  bool MayChange(const Quad& quad, std::optional<TermId> type) const;

  // A change of a witness, for reports and for undo.
  struct Edit {
    uint32_t condition = 0;  // its number
    uint32_t next = 0;       // for use by the caller
    bool was_present = false;
    bool is_present = false;
    Key key;
    Row before;  // the old witness
  };
  using Edits = std::vector<Edit>;

  // The witness `slot` may be broken: looks for another with its key. `trigger`: the trigger that lost or
  // gained a match, or kSomeTrigger.
  absl::Status Recheck(uint32_t slot, uint16_t trigger, const sparql::RunOptions& run, Edits& edits);
  // A change matched a watch of the kept witness while the condition does not hold: keeping it was useless.
  bool keeps_witness() const { return present_ == 0 && !has_keys(); }
  void ForgetKept();
  // True if Probe has a binding to start from: from a change that matches `trigger`, or from a constant of
  // the query. Otherwise Probe evaluates the whole query, which costs more the larger the graph is.
  bool narrows(uint32_t trigger) const { return kind_->Narrows(trigger); }
  // `quad` was added or removed and matches `trigger`: adds the new keys that follow from it. `full_done`:
  // true if a whole evaluation was already made in this update, so that no key is left to find; set to true
  // if this call makes one because nothing can be bound.
  absl::Status Probe(uint32_t trigger, const Quad& quad, bool added, const sparql::RunOptions& run,
                     bool& full_done, Edits& edits);
  // Adds a solution that its template found, if its key is new. `row`: in the template's columns.
  void Offer(absl::Span<const TermId> row, const sparql::RunOptions& run, Edits& edits);
  // True if rise watches do not matter now. Remembers that one was hit.
  bool IgnoresRise() {
    if (overflowed_) return true;
    if (!holds() || has_keys()) return false;
    rise_watch_hit_ = true;
    return true;
  }
  // Adds all new keys, by a whole evaluation.
  absl::Status ProbeAll(const sparql::RunOptions& run, Edits& edits);
  // Whole evaluation: adds new keys and removes broken ones.
  absl::Status Refresh(const sparql::RunOptions& run, Edits& edits);
  void Undo(const Edit& edit);

  // Adapts the rise watches to the state on `version`. True if they changed. Without a version it watches
  // every trigger that the state needs. `probed`: a change matched one of them, and the condition did not
  // rise.
  bool Arm(const GraphVersion* version, bool probed = false);
  // True if it holds and one of its rise watches was hit. A condition that holds keeps these watches until
  // then: usually it falls before, and needs them again.
  bool rise_watch_hit() const { return rise_watch_hit_; }

  // More keys than WatchIndexes::most_matches: no more are looked for.
  bool overflowed() const { return overflowed_; }
  void TakeBackOverflow() { overflowed_ = false; }

  // For use by the caller: its place in the running update, and whether it has groups.
  uint32_t& touched_at() { return touched_at_; }
  bool is_grouped() const { return grouped_; }
  void set_grouped() { grouped_ = true; }

 private:
  enum class Armed : uint8_t { kNothing, kOne, kAll };
  using Watches = absl::InlinedVector<WatchIndexes::Watch, 4>;
  struct Witness {
    Row row;  // contains its key; with keys an empty row means no witness
    Watches watches;
  };

  // Index of the witnesses by key, if there are many.
  struct Slots {
    absl::flat_hash_map<Key, uint32_t> taken;  // → place in witnesses_
    std::vector<uint32_t> free;
  };
  // Up to this many witnesses are searched linearly.
  static constexpr size_t kFewWitnesses = 8;

  Key KeyOf(absl::Span<const TermId> row) const;
  bool HasKey(absl::Span<const TermId> row, const Key& key) const;
  int SlotOf(const Key& key) const;  // -1: no witness has this key
  int NewSlot(const Key& key);       // -1: a witness has this key; only with keys
  // Makes `row` the witness of its key unless the key has one, and counts its steps. False: no more are wanted.
  bool Take(absl::Span<const TermId> row, const sparql::RunOptions& run, Edits& edits);
  // False: no key beside those that are kept may be kept.
  bool MayKeepMore(const sparql::RunOptions& run);
  void SetRow(Witness& witness, uint32_t slot, absl::Span<const TermId> row);
  void DropSlot(uint32_t slot, const Key& key);
  void Watch(Witness& witness, uint32_t slot);
  // True if a broken witness and its watches are kept. Usually the same witness is valid again when the match
  // of a forbidden pattern is gone.
  bool KeepsWitness(uint16_t trigger) const;
  // Restores the kept witness if it is valid again. It still matches all patterns, or it would have been
  // dropped: only the filters are checked.
  absl::Status TakeKept(const sparql::RunOptions& run, Edits& edits);
  // The constants of its pattern, with the constants of the template.
  QuadPattern ConstantsOf(const matching::Trigger& trigger) const;
  int BlockingTrigger(const GraphVersion& version) const;
  // True if the trigger has no match with the seed, so that there is no solution.
  bool HasNoMatch(uint16_t trigger, absl::Span<const TermId> seed, const GraphVersion& version) const;
  void WatchTrigger(uint32_t trigger);
  void Disarm();
  // The scratch seed: only the constants are bound.
  std::vector<TermId>& BeginSeed() const { return kind_->SeedWith(constants_); }
  bool watches_one() const { return armed_ == Armed::kOne; }

  // A cache line that is read only for arming, or with many witnesses.
  Watches armed_watches_;
  std::unique_ptr<Slots> slots_;
  std::unique_ptr<matching::Body> own_body_;  // null: the body is the template's
  std::unique_ptr<ConditionKind> own_kind_;
  // Cache lines that every relevant update reads.
  // Without keys: the first, while present_; or a broken one that was kept, if it has watches.
  alignas(64) absl::InlinedVector<Witness, 1> witnesses_;
  ConditionKind* kind_;
  const uint32_t number_;
  uint32_t touched_at_ = 0;
  uint32_t present_ = 0;        // number of witnesses
  int16_t armed_trigger_ = -1;  // kOne: the watched trigger
  Armed armed_ : 2 = Armed::kNothing;
  bool joined_ : 1 = false;  // it has joined the template's waiting conditions
  bool rise_watch_hit_ : 1 = false;
  bool blocked_ : 1 = false;  // kOne: a Recheck of this update found that the trigger has no match
  bool single_watch_untried_ : 1 = false;  // kAll: since it fell, a single watch was not tried
  bool has_slots_ : 1 = false;             // slots_ exists; saves a read of its cache line
  bool grouped_ : 1 = false;
  bool overflowed_ : 1 = false;
  ConditionTemplate::Constants constants_;  // they distinguish the conditions of the template
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_CONDITION_H_
