// Implementation of StandingConditions. Private to this folder; split over standing_conditions.cc
// (registration) and condition_update.cc (updates).
#ifndef DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_IMPL_H_
#define DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_IMPL_H_

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"
#include "reasoner/conditions/condition.h"
#include "reasoner/conditions/condition_template.h"
#include "reasoner/conditions/numbered_places.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/conditions/threshold_group.h"
#include "reasoner/matching/computed_terms.h"

namespace docent::conditions {

struct StandingConditions::Impl {
  // A condition with its followers: direct ones, and groups of thresholds on its key variable.
  using Groups = std::array<std::unique_ptr<ThresholdGroup>, 2>;  // below, above
  // Aligned: an update reads two cache lines of it.
  struct alignas(64) Shared final : Condition {
    using Condition::Condition;
    absl::InlinedVector<ConditionId, 1> followers;
    std::unique_ptr<Groups> groups;  // null: none
    std::string fingerprint;
    std::string template_name;  // key in templates; empty: no similar conditions

    bool IsFollowed() const;
  };
  struct Threshold {
    bool above = false;
    TermId constant;
  };
  struct Subscriber {
    uint32_t condition = 0;
    bool removed = false;  // since the last Commit
    std::optional<Threshold> threshold;
  };
  struct JournalEntry {
    enum class Kind : uint8_t { kArmed, kRegistered, kRemoved } kind;
    uint32_t condition = 0;
    ConditionId id;
  };
  // Work of the running Update on one condition.
  struct Touched {
    static constexpr uint32_t kNone = ~0u;
    uint32_t condition = 0;
    int rises = 0;                         // changes that matched a rise watch
    uint32_t first = kNone, last = kNone;  // in edits, where one names the next
    bool full_done = false;                // evaluated whole: no key is left to find
    bool held = false;
    bool probed = false;
    bool edited() const { return first != kNone; }
  };
  struct Rise {
    uint32_t owner;  // condition, or template with WatchIndexes::kIsTemplate
    uint32_t trigger;
    const Quad* quad;
    bool added;  // false: removed
  };
  // Conditions that differ only in constants. The first few do not get a template.
  struct Alike {
    int64_t count = 0;
    bool shares_nothing = false;  // a template would share nothing
    std::optional<uint32_t> template_number;
    std::vector<std::pair<uint32_t, ConditionTemplate::Constants>>
        alone;  // conditions that were registered before the template
  };

  Impl(Dictionary& d, const sparql::FunctionRegistry* f) : dictionary(d), functions(f), comparer(d) {}

  // Registration.
  // The condition of `query`, created if no equal one exists.
  absl::StatusOr<uint32_t> FindOrMake(const sparql::Query& query, const GraphVersion& now,
                                      const RegisterOptions& options);
  absl::StatusOr<uint32_t> Make(const sparql::Query& query, const GraphVersion& now,
                                const RegisterOptions& options, std::string fingerprint);
  // Follows a threshold by its group if there are enough similar ones; nullopt: follow it alone.
  absl::StatusOr<std::optional<Subscriber>> JoinGroup(ConditionId id, const sparql::Query& query,
                                                      const GraphVersion& now,
                                                      const RegisterOptions& options);
  absl::StatusOr<std::optional<uint32_t>> GroupCondition(const ThresholdForm& form, const GraphVersion& now,
                                                         const RegisterOptions& options);
  // Creates a condition with the body of its template; null: the template lends no body.
  absl::StatusOr<Shared*> BorrowBody(const TemplateForm& form, const std::string& template_name,
                                     const RegisterOptions& options);
  // Counts the condition among similar ones. Gives it its template if there are enough of them.
  void JoinTemplate(uint32_t number, const TemplateForm& form, bool borrowed, const GraphVersion& now);
  void LeaveTemplate(const std::string& template_name, uint32_t number);
  ThresholdGroup& GroupOf(const Subscriber& follower) const;
  bool Holds(ConditionId id, const Subscriber& follower) const;
  // RESOURCE_EXHAUSTED if all conditions together would keep more matches than they may, or computed longer texts. Without a
  // cancellation: OK, since what the log has was decided.
  absl::Status CheckMemory(const sparql::RunOptions& run);
  bool IsRemoved(ConditionId id) const { return removals > 0 && followers.find(id)->second.removed; }
  void Unfollow(ConditionId id);

  // Update.
  // Counts an evaluation that no change narrows, and its time.
  absl::Status Whole(absl::FunctionRef<absl::Status()> evaluate);
  Touched& Touch(uint32_t number);
  // Finds the conditions affected by the change, into broken, rises and touched; counts those of templates.
  void Gather(const Delta& delta);
  void GatherOf(const Quad& quad, bool added);
  absl::Status RecheckBroken(const sparql::RunOptions& run);
  absl::Status ProbeRises(const sparql::RunOptions& run);
  absl::Status ProbeTemplate(const Rise& rise, const sparql::RunOptions& run);
  absl::Status RefreshVolatile(const sparql::RunOptions& run);
  // Links the edits from `begin` on, which belong to this update, to their conditions.
  void LinkEdits(size_t begin);
  // Adapts the condition's watches and groups to the new state.
  void Settle(const Touched& touch, const GraphVersion& version);
  // Adds the condition's change to `changes`.
  void TellOverflow(const Shared& condition);
  absl::Status CollectChanges(const Touched& touch);
  ConditionChange& NextChange(ConditionId id, ConditionChange::Edge edge);
  // Collects the keys that appeared and disappeared.
  void TellBindings(const Touched& touched, ConditionChange& change) const;
  // Updates the groups of a condition to its keys. `visit` receives the changed levels.
  absl::Status RelevelGroups(const Shared& condition, absl::FunctionRef<void(ConditionId, bool)> visit);
  void Bind(const Condition& condition, const Condition::Key& key, Binding& binding) const;
  Binding BindingOf(const Condition& condition, const Condition::Key& key) const {
    Binding binding;
    Bind(condition, key, binding);
    return binding;
  }

  // Number of changes that keep their memory from one update to the next.
  static constexpr size_t kMostKept = 64;
  // A condition matched by more changes of one update than this is evaluated whole, once.
  static constexpr int kMaxProbes = 256;
  // Up to this many thresholds that differ only in their number are followed one by one; more form a group.
  static constexpr int64_t kThresholdsAlone = 8;
  // Up to this many conditions that differ only in constants are watched one by one; more share a template.
  static constexpr int64_t kAloneAtMost = 4;
  // No group is made if its variable has more solutions than this: each value is remembered.
  static constexpr int64_t kMaxGroupSolutions = 20000;

  Dictionary& dictionary;
  const sparql::FunctionRegistry* functions;
  matching::ComputedTerms computed{dictionary};  // since the last Commit or Rollback
  NumberComparer comparer;
  const GraphVersion no_graph;  // for comparisons of numbers, which read no graph
  absl::flat_hash_map<std::string, uint32_t> by_fingerprint;
  absl::flat_hash_map<std::string, Alike> alike;               // by fingerprint of the template
  absl::flat_hash_map<std::string, int64_t> thresholds_alone;  // by fingerprint of the shared part
  absl::flat_hash_map<ConditionId, Subscriber> followers;
  uint64_t next_id = 1;
  StopWatch now_ns = nullptr;

  // Data that every Update reads.
  WatchIndexes indexes;  // declared before templates and conditions, which remove their watches at the end
  std::vector<std::unique_ptr<ConditionTemplate>> templates;  // by number; null: free
  NumberedPlaces<Shared> conditions;                          // declared after templates, which they leave
  std::vector<uint32_t> volatile_conditions;
  Counters counters;
  // Since the last Commit.
  Condition::Edits edits;
  std::vector<JournalEntry> journal;
  std::vector<uint32_t> overflowed;
  size_t removals = 0;  // number of kRemoved in it

  // The first `reported` are the changes of the last Update. The others keep their memory for the next one.
  std::vector<ConditionChange> changes;
  size_t reported = 0;

  // of the running Update
  std::vector<Touched> touched;  // a condition stores its place here
  std::vector<Rise> rises;
  std::vector<matching::PatternIndex::Reference> broken;
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_IMPL_H_
