// The engine's conditions, kept by the standing conditions: handles ↔ conditions, text ↔ queries, ids ↔ terms,
// and the facts that made a condition hold.
//
// Conditions with parts that must have held for some time are several conditions and a LastingCondition; when the
// next of those times is full, a clock tick is needed.
//
// Journaled like the stages it stands between: Commit or Rollback at the end of a turn. Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_CONDITION_PORT_H_
#define DOCENT_KB_SERVER_TURN_CONDITION_PORT_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/btree_set.h"
#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/sparql/syntax/algebra.h"
#include "kb_server/turn/condition_evidence.h"
#include "reasoner/conditions/lasting_condition.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/rules/rule_engine.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

// Since when a binding of a condition's part has held, for snapshots.
struct LastingSince {
  engine::ConditionHandle handle = 0;
  uint32_t part = 0;
  engine::TermBinding binding;
  TimeMicros since_us = 0;
  bool full = false;
};

class ConditionPort final : public engine::ConditionView {
 public:
  // All must outlive the port. `rules` (null: none) say what may follow from a fact.
  ConditionPort(Dictionary* dictionary, conditions::StandingConditions* standing,
                const rules::RuleEngine* rules = nullptr);

  // Registers and removes as the engine asked, on `version`, the state of the last Update. What holds at once
  // and the key bindings that are there already count as edges of the next round.
  // `cancellation`, here and below: null: none.
  absl::Status Arm(const std::vector<engine::ConditionRequest>& requests, const GraphVersion& version,
                   TimeMicros now_us, Cancellation* cancellation = nullptr);
  void Disarm(const std::vector<engine::ConditionHandle>& handles);
  // As Arm, for conditions whose edges the engine has had and whose times run already (a start from a snapshot).
  absl::Status Restore(const std::vector<engine::ConditionRequest>& requests,
                       const std::vector<LastingSince>& times, const GraphVersion& version, TimeMicros now_us,
                       Cancellation* cancellation = nullptr);
  // The times that run, in order of handle, part and binding.
  std::vector<LastingSince> Times() const;
  // When a clock tick is needed, if ever.
  std::optional<TimeMicros> NextDeadline() const;
  // What is armed now, in order of the handles.
  std::vector<engine::ConditionRequest> Requests() const;
  // Adds the edges of these changes to the next round's.
  void Take(absl::Span<const conditions::ConditionChange> changes, TimeMicros now_us);
  // Begins a round on `version`: the edges gathered so far are edges() until the next BeginRound.
  // `cancellation` (null: none) ends Solutions of this round early; the turn is then to be refused, since the engine goes on.
  void BeginRound(const GraphVersion& version, TimeMicros now_us, Cancellation* cancellation = nullptr);

  const std::vector<engine::ConditionEdge>& edges() const override { return edges_; }
  bool Holds(engine::ConditionHandle handle) const override;
  std::optional<TimeMicros> OpensAt(engine::ConditionHandle handle) const override;
  absl::StatusOr<std::vector<engine::TermBinding>> Solutions(engine::ConditionHandle handle,
                                                             const engine::TermBinding& fixed,
                                                             size_t limit) const override;
  bool MayChange(engine::ConditionHandle handle, const TermQuad& written) const override;
  std::string Evidence(engine::ConditionHandle handle, const engine::TermBinding& binding) const override;

  void Commit();
  void Rollback();

 private:
  struct Lasting {
    Lasting(engine::ConditionHandle handle_in, const engine::ConditionRequest& request);
    const engine::ConditionHandle handle;
    conditions::LastingCondition condition;
    std::vector<conditions::ConditionId> parts;
    std::optional<TimeMicros> listed_us;  // its place in deadlines_
    std::optional<TimeMicros> opens_us;   // as the engine knows it
  };
  struct Condition {
    conditions::ConditionId id;
    std::shared_ptr<const ConditionEvidence> evidence;
    std::shared_ptr<const engine::ConditionRequest> request;
    std::shared_ptr<Lasting> lasting;  // null: it has no such parts
  };

  // `query`, or what `ask` says where it is null.
  static absl::StatusOr<std::shared_ptr<const sparql::Query>> QueryOf(
      const std::string& ask, const std::shared_ptr<const sparql::Query>& query);
  engine::TermBinding Decode(const conditions::Binding& binding) const;
  std::vector<engine::TermBinding> Decode(const std::vector<conditions::Binding>& bindings) const;
  absl::StatusOr<conditions::ConditionId> Register(const sparql::Query& query, const std::string& text,
                                                   const std::vector<std::string>& key_variables,
                                                   const GraphVersion& version, TimeMicros now_us,
                                                   Cancellation* cancellation);
  // Registers the parts and tells the condition what holds now.
  absl::Status ArmParts(const engine::ConditionRequest& request, const Condition& condition,
                        const GraphVersion& version, TimeMicros now_us, Cancellation* cancellation);
  // What a condition with parts is like at once. False: the change is not about one.
  bool TakeLasting(const conditions::ConditionChange& change, TimeMicros now_us);
  // Something changed about it in this round.
  void Touch(const std::shared_ptr<Lasting>& lasting);
  void SettleLasting(TimeMicros now_us);
  void RestoreTimes(const std::vector<LastingSince>& times);
  // Which condition is which part.
  void RememberParts(Lasting& lasting);
  void ForgetParts(Lasting& lasting);
  void DisarmParts(Lasting& lasting);
  // Brings its place in deadlines_ in line; nullopt: none.
  void List(Lasting& lasting, std::optional<TimeMicros> due_us);
  // One edge a condition and round, however often it changed.
  void Gather(engine::ConditionEdge edge);
  // The condition has more matches than are kept.
  void GatherOverflow(engine::ConditionHandle handle);

  Dictionary* dictionary_;
  conditions::StandingConditions* standing_;
  const rules::RuleEngine* rules_;
  absl::flat_hash_map<engine::ConditionHandle, Condition> conditions_;
  absl::flat_hash_map<conditions::ConditionId, engine::ConditionHandle> handles_;
  absl::flat_hash_map<conditions::ConditionId, std::pair<engine::ConditionHandle, size_t>>
      parts_;  // → condition and which part of it
  absl::btree_set<std::pair<TimeMicros, engine::ConditionHandle>> deadlines_;
  absl::btree_set<engine::ConditionHandle> unsettled_;  // of which something changed in this round
  std::vector<engine::ConditionEdge> gathered_;
  absl::flat_hash_map<engine::ConditionHandle, size_t> gathered_at_;  // index in gathered_
  std::vector<engine::ConditionEdge> edges_;
  const GraphVersion* version_ = nullptr;
  TimeMicros now_us_ = 0;
  Cancellation* cancellation_ = nullptr;
  // the journal
  std::vector<engine::ConditionHandle> armed_;
  std::vector<std::pair<engine::ConditionHandle, Condition>> disarmed_;
  std::vector<std::shared_ptr<Lasting>> changed_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_CONDITION_PORT_H_
