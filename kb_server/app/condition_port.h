// The engine's conditions, kept by the constraint set: handles ↔ constraints, text ↔ queries, ids ↔ terms,
// and the facts that made a condition hold.
//
// Journaled like the stages it stands between: Commit or Rollback at the end of a turn. Writer thread only.
#ifndef DOCENT_KB_SERVER_APP_CONDITION_PORT_H_
#define DOCENT_KB_SERVER_APP_CONDITION_PORT_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "kb_server/sparql/algebra.h"
#include "kb_server/sparql/function_registry.h"
#include "reasoner/constraints/constraint_set.h"
#include "workflow/engine/ports.h"

namespace docent {

class ConditionPort final : public ConditionView {
 public:
  // All must outlive the port.
  ConditionPort(Dictionary* dictionary, ConstraintSet* constraints,
                const sparql::FunctionRegistry* functions);

  // Registers and removes as the engine asked, on `version`, the state of the last Update. What holds at once
  // and the key bindings that are there already count as edges of the next round.
  absl::Status Arm(const std::vector<ConditionRequest>& requests, const GraphVersion& version,
                   TimeMicros now_us);
  void Disarm(const std::vector<ConditionHandle>& handles);
  // As Arm, for conditions whose edges the engine has had (a start from a snapshot).
  absl::Status Restore(const std::vector<ConditionRequest>& requests, const GraphVersion& version,
                       TimeMicros now_us);
  // What is armed now, in order of the handles.
  std::vector<ConditionRequest> Requests() const;
  // Adds the edges of these changes to the next round's.
  void Take(const std::vector<ConstraintChange>& changes);
  // Begins a round on `version`: the edges gathered so far are edges() until the next BeginRound.
  void BeginRound(const GraphVersion& version, TimeMicros now_us);

  const std::vector<ConditionEdge>& edges() const override { return edges_; }
  bool Holds(ConditionHandle handle) const override;
  absl::StatusOr<std::vector<TermBinding>> Solutions(ConditionHandle handle, const TermBinding& fixed,
                                                     size_t limit) const override;
  std::string Evidence(ConditionHandle handle, const TermBinding& binding) const override;

  void Commit();
  void Rollback();

 private:
  struct Condition {
    ConstraintId id;
    std::shared_ptr<const sparql::Query> query;
    std::shared_ptr<const ConditionRequest> request;
  };

  TermBinding Decode(const Binding& binding) const;
  // One edge a condition and round, however often it changed.
  void Gather(ConditionEdge edge);

  Dictionary* dictionary_;
  ConstraintSet* constraints_;
  const sparql::FunctionRegistry* functions_;
  absl::flat_hash_map<ConditionHandle, Condition> conditions_;
  absl::flat_hash_map<ConstraintId, ConditionHandle> handles_;
  std::vector<ConditionEdge> gathered_;
  absl::flat_hash_map<ConditionHandle, size_t> gathered_at_;  // index in gathered_
  std::vector<ConditionEdge> edges_;
  const GraphVersion* version_ = nullptr;
  TimeMicros now_us_ = 0;
  // the journal
  std::vector<ConditionHandle> armed_;
  std::vector<std::pair<ConditionHandle, Condition>> disarmed_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_APP_CONDITION_PORT_H_
