// Events that stay in the graph because conditions wait with them.
//
// A condition that needs several events keeps those that have come since it was armed until a match has them, or until it is
// disarmed. A condition that an event has opened but for a robot keeps it in ArmedCondition::waiting_events; here stands which
// conditions do.
//
// Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_EVENT_WAITS_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_EVENT_WAITS_H_

#include <map>
#include <optional>
#include <set>
#include <string>

#include "workflow/cawl/ask_compiler.h"
#include "workflow/engine/state/ports.h"

namespace docent::engine {

class EventWaits {
 public:
  // By condition: the events that it has, of those that it needs.
  using Joint = std::map<ConditionHandle, std::set<Term>>;

  void Arm(ConditionHandle handle, const cawl::CompiledAsk& ask);
  void Disarm(ConditionHandle handle);

  void Take(const EventNews& news);
  // A match of the condition: it needs these events no longer.
  void Used(ConditionHandle handle, const TermBinding& match);
  // Whether the condition has waiting events of its own.
  void SetHolds(ConditionHandle handle, bool holds);

  const Joint& joint() const { return joint_; }
  const std::set<ConditionHandle>& holders() const { return holders_; }

  void Restore(Joint joint) { joint_ = std::move(joint); }
  // What follows from what is armed is forgotten; it is to be armed and set again.
  void ClearDerived();
  bool changed() const { return undo_.has_value(); }
  void Commit() { undo_.reset(); }
  // Before ClearDerived.
  void Rollback();

 private:
  Joint& Mutable();

  Joint joint_;
  std::optional<Joint> undo_;
  std::map<std::string, std::set<ConditionHandle>> by_operation_;  // conditions that need several events
  std::map<ConditionHandle, std::set<std::string>> operations_;
  std::set<ConditionHandle> holders_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_EVENT_WAITS_H_
