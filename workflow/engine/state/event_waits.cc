#include "workflow/engine/state/event_waits.h"

#include <utility>

namespace docent::engine {

EventWaits::Joint& EventWaits::Mutable() {
  if (!undo_) undo_ = joint_;
  return joint_;
}

void EventWaits::Arm(ConditionHandle handle, const cawl::CompiledAsk& ask) {
  for (const std::string& operation : ask.joint_events) {
    by_operation_[operation].insert(handle);
    operations_[handle].insert(operation);
  }
}

void EventWaits::Disarm(ConditionHandle handle) {
  holders_.erase(handle);
  if (joint_.contains(handle)) Mutable().erase(handle);
  const auto known = operations_.find(handle);
  if (known == operations_.end()) return;
  for (const std::string& operation : known->second) {
    const auto place = by_operation_.find(operation);
    place->second.erase(handle);
    if (place->second.empty()) by_operation_.erase(place);
  }
  operations_.erase(known);
}

void EventWaits::Take(const EventNews& news) {
  for (const Term& event : news.gone) {
    std::set<ConditionHandle> with;
    for (const auto& [handle, events] : joint_) {
      if (events.contains(event)) with.insert(handle);
    }
    for (const ConditionHandle handle : with) {
      std::set<Term>& events = Mutable().at(handle);
      events.erase(event);
      if (events.empty()) joint_.erase(handle);
    }
  }
  for (const ToldEvent& told : news.told) {
    for (const std::string& operation : told.operations) {
      const auto needed = by_operation_.find(operation);
      if (needed == by_operation_.end()) continue;
      for (const ConditionHandle handle : needed->second) Mutable()[handle].insert(told.event);
    }
  }
}

void EventWaits::Used(ConditionHandle handle, const TermBinding& match) {
  const auto has = joint_.find(handle);
  if (has == joint_.end()) return;
  for (const auto& [name, value] : match) {
    if (!has->second.contains(value)) continue;
    std::set<Term>& events = Mutable().at(handle);
    events.erase(value);
    if (!events.empty()) continue;
    joint_.erase(handle);
    return;
  }
}

void EventWaits::SetHolds(ConditionHandle handle, bool holds) {
  if (holds)
    holders_.insert(handle);
  else
    holders_.erase(handle);
}

void EventWaits::ClearDerived() {
  by_operation_.clear();
  operations_.clear();
  holders_.clear();
}

void EventWaits::Rollback() {
  if (undo_) joint_ = *std::move(undo_);
  undo_.reset();
}

}  // namespace docent::engine
