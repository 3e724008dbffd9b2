// Implementation of StandingConditions. Private to this folder; split over standing_conditions.cc (registration) and
// condition_update.cc (what a change does).
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

namespace docent::conditions {

struct StandingConditions::Impl {
  // A condition and who follows it: directly, or as one of many thresholds on its key variable.
  using Groups = std::array<std::unique_ptr<ThresholdGroup>, 2>;  // below, above
  // Aligned: an update reads two cache lines of it.
  struct alignas(64) Shared final : Condition {
    using Condition::Condition;
    absl::InlinedVector<ConditionId, 1> followers;
    std::unique_ptr<Groups> groups;  // null: none
    std::string fingerprint;
    std::string template_name;  // key in templates; empty: none is like it

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
  // What the running Update finds to do with a condition.
  struct Touched {
    static constexpr uint32_t kNone = ~0u;
    uint32_t condition = 0;
    int rises = 0;                         // changes that a rise watch matched
    uint32_t first = kNone, last = kNone;  // in edits, where one names the next
    bool full_done = false;                // evaluated whole: nothing is left to find
    bool held = false;
    bool probed = false;
    bool edited() const { return first != kNone; }
  };
  struct Rise {
    uint32_t owner;  // condition, or template with WatchIndexes::kIsTemplate
    uint32_t trigger;
    const Quad* quad;
    bool added;  // or removed
  };
  // Conditions that differ only in constants. The first ones have no template made for them.
  struct Alike {
    int64_t count = 0;
    bool hopeless = false;  // nothing would be shared
    std::optional<uint32_t> template_number;
    std::vector<std::pair<uint32_t, ConditionTemplate::Constants>>
        alone;  // conditions that came before there was one
  };

  Impl(Dictionary& d, const sparql::FunctionRegistry* f) : dictionary(d), functions(f), comparer(d) {}

  // Registration.
  // The condition of `query`, made if there is none like it.
  absl::StatusOr<uint32_t> FindOrMake(const sparql::Query& query, const GraphVersion& now,
                                      const RegisterOptions& options);
  absl::StatusOr<uint32_t> Make(const sparql::Query& query, const GraphVersion& now,
                                const RegisterOptions& options, std::string fingerprint);
  // Follows a threshold by its group if there are enough like it; nullopt: follow it by itself.
  absl::StatusOr<std::optional<Subscriber>> JoinGroup(ConditionId id, const sparql::Query& query,
                                                      const GraphVersion& now,
                                                      const RegisterOptions& options);
  absl::StatusOr<std::optional<uint32_t>> GroupCondition(const ThresholdForm& form, const GraphVersion& now,
                                                         const RegisterOptions& options);
  // Makes a condition with the body of its template; null: the template has none to lend.
  absl::StatusOr<Shared*> BorrowBody(const TemplateForm& form, const std::string& template_name,
                                     const RegisterOptions& options);
  // Counts the condition among those like it. Gives it its template, if there are enough of them.
  void JoinTemplate(uint32_t number, const TemplateForm& form, bool borrowed, const GraphVersion& now);
  void LeaveTemplate(const std::string& template_name, uint32_t number);
  ThresholdGroup& GroupOf(const Subscriber& follower) const;
  bool Holds(ConditionId id, const Subscriber& follower) const;
  bool IsRemoved(ConditionId id) const { return removals > 0 && followers.find(id)->second.removed; }
  void Unfollow(ConditionId id);

  // Update.
  // Counts an evaluation that no change narrows, and how long it takes.
  absl::Status Whole(absl::FunctionRef<absl::Status()> evaluate);
  Touched& Touch(uint32_t number);
  // Who is concerned by the change: into broken, rises and touched; the templates count theirs.
  void Gather(const Delta& delta);
  void GatherOf(const Quad& quad, bool added);
  absl::Status RecheckBroken(const sparql::RunOptions& run);
  absl::Status ProbeRises(const sparql::RunOptions& run);
  absl::Status ProbeTemplate(const Rise& rise, const sparql::RunOptions& run);
  absl::Status RefreshVolatile(const sparql::RunOptions& run);
  // The edits from `begin` on are those of this update: each condition that was touched knows its own.
  void LinkEdits(size_t begin);
  // Its watches and groups follow the new state.
  void Settle(const Touched& touch, const GraphVersion& version);
  // Into changes.
  absl::Status CollectChanges(const Touched& touch);
  ConditionChange& NextChange(ConditionId id, ConditionChange::Edge edge);
  // Which keys came and went.
  void TellBindings(const Touched& touched, ConditionChange& change) const;
  // The groups of a condition follow its keys. `visit` gets what changed.
  absl::Status RelevelGroups(const Shared& condition, absl::FunctionRef<void(ConditionId, bool)> visit);
  void Bind(const Condition& condition, const Condition::Key& key, Binding& binding) const;
  Binding BindingOf(const Condition& condition, const Condition::Key& key) const {
    Binding binding;
    Bind(condition, key, binding);
    return binding;
  }

  // Changes that keep their memory from one update to the next.
  static constexpr size_t kMostKept = 64;
  // A condition that more changes of one update match is evaluated whole, once.
  static constexpr int kMaxProbes = 256;
  // Thresholds that differ only in their number are followed one by one up to here, as a group beyond.
  static constexpr int64_t kThresholdsAlone = 8;
  // Conditions that differ only in constants are watched one by one up to here, by their template beyond.
  static constexpr int64_t kAloneAtMost = 4;
  // A group is not made where its variable has more solutions than this: each value is remembered.
  static constexpr int64_t kMaxGroupSolutions = 20000;

  Dictionary& dictionary;
  const sparql::FunctionRegistry* functions;
  NumberComparer comparer;
  const GraphVersion no_graph;  // comparisons of numbers read none
  absl::flat_hash_map<std::string, uint32_t> by_fingerprint;
  absl::flat_hash_map<std::string, Alike> alike;               // by fingerprint of the template
  absl::flat_hash_map<std::string, int64_t> thresholds_alone;  // by fingerprint of what they share
  absl::flat_hash_map<ConditionId, Subscriber> followers;
  uint64_t next_id = 1;
  StopWatch now_ns = nullptr;

  // What every Update looks at.
  WatchIndexes indexes;  // before templates and conditions: they take their watches out
  std::vector<std::unique_ptr<ConditionTemplate>> templates;  // by number; null: free
  NumberedPlaces<Shared> conditions;                          // after templates: they leave theirs
  std::vector<uint32_t> volatile_conditions;
  Counters counters;
  // Since the last Commit.
  Condition::Edits edits;
  std::vector<JournalEntry> journal;
  size_t removals = 0;  // kRemoved in it

  // Of the last Update: the first `told` of them. Those beyond keep their memory for the next.
  std::vector<ConditionChange> changes;
  size_t told = 0;

  // of the running Update
  std::vector<Touched> touched;  // a condition knows its place
  std::vector<Rise> rises;
  std::vector<matching::PatternIndex::Reference> broken;
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_STANDING_CONDITIONS_IMPL_H_
