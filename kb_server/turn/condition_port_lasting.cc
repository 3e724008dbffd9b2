// Conditions with parts that must have held for some time.
#include <algorithm>
#include <tuple>
#include <utility>

#include "kb_server/turn/condition_port.h"

namespace docent::server {
namespace {

std::vector<conditions::LastingCondition::Part> PartsOf(const engine::ConditionRequest& request) {
  std::vector<conditions::LastingCondition::Part> parts;
  for (const engine::LastingPart& part : request.lasting) parts.push_back({part.variables, part.at_least_us});
  return parts;
}

// The bindings that a change tells of; of a condition without key variables there is one, the empty one.
template <typename Set>
void Apply(const conditions::ConditionChange& change, Set set) {
  if (change.appeared.empty() && change.disappeared.empty()) {
    if (change.edge == conditions::ConditionChange::Edge::kRose) set(conditions::Binding(), true);
    if (change.edge == conditions::ConditionChange::Edge::kFell) set(conditions::Binding(), false);
  }
  for (const conditions::Binding& binding : change.disappeared) set(binding, false);
  for (const conditions::Binding& binding : change.appeared) set(binding, true);
}

}  // namespace

ConditionPort::Lasting::Lasting(engine::ConditionHandle handle_in, const engine::ConditionRequest& request)
    : handle(handle_in), condition(request.key_variables, PartsOf(request)) {}

absl::Status ConditionPort::ArmParts(const engine::ConditionRequest& request, const Condition& condition,
                                     const GraphVersion& version, TimeMicros now_us,
                                     Cancellation* cancellation) {
  Lasting& lasting = *condition.lasting;
  changed_.push_back(condition.lasting);
  for (size_t i = 0; i < request.lasting.size(); ++i) {
    const engine::LastingPart& part = request.lasting[i];
    auto query = QueryOf(part.ask, part.query);
    if (!query.ok()) return query.status();
    auto id = Register(**query, part.ask, part.variables, version, now_us, cancellation);
    if (!id.ok()) return id.status();
    lasting.parts.push_back(*id);
    if (standing_->Overflowed(*id)) GatherOverflow(lasting.handle);
    for (const conditions::Binding& key : standing_->Keys(*id))
      lasting.condition.SetPart(i, key, true, now_us);
  }
  RememberParts(lasting);
  if (standing_->Overflowed(condition.id)) GatherOverflow(lasting.handle);
  for (const conditions::Binding& key : standing_->Keys(condition.id)) lasting.condition.SetWhole(key, true);
  lasting.condition.Settle(now_us);
  List(lasting, lasting.condition.NextDeadline());
  lasting.opens_us = lasting.condition.OpensAt();
  if (lasting.opens_us) Gather({.handle = lasting.handle, .moved = true});
  return absl::OkStatus();
}

void ConditionPort::RememberParts(Lasting& lasting) {
  for (size_t i = 0; i < lasting.parts.size(); ++i) parts_[lasting.parts[i]] = {lasting.handle, i};
  List(lasting, lasting.condition.NextDeadline());
}

void ConditionPort::ForgetParts(Lasting& lasting) {
  for (const conditions::ConditionId id : lasting.parts) parts_.erase(id);
  List(lasting, std::nullopt);
}

void ConditionPort::DisarmParts(Lasting& lasting) {
  for (const conditions::ConditionId id : lasting.parts) standing_->Remove(id);
  ForgetParts(lasting);
}

void ConditionPort::List(Lasting& lasting, std::optional<TimeMicros> due_us) {
  if (lasting.listed_us == due_us) return;
  if (lasting.listed_us) deadlines_.erase({*lasting.listed_us, lasting.handle});
  if (due_us) deadlines_.emplace(*due_us, lasting.handle);
  lasting.listed_us = due_us;
}

std::optional<TimeMicros> ConditionPort::OpensAt(engine::ConditionHandle handle) const {
  const auto it = conditions_.find(handle);
  return it == conditions_.end() || !it->second.lasting ? std::nullopt : it->second.lasting->opens_us;
}

std::optional<TimeMicros> ConditionPort::NextDeadline() const {
  if (deadlines_.empty()) return std::nullopt;
  return deadlines_.begin()->first;
}

bool ConditionPort::TakeLasting(const conditions::ConditionChange& change, TimeMicros now_us) {
  if (const auto part = parts_.find(change.id); part != parts_.end()) {
    const auto [handle, number] = part->second;
    const std::shared_ptr<Lasting>& lasting = conditions_[handle].lasting;
    Apply(change, [&lasting, number = number, now_us](const conditions::Binding& binding, bool present) {
      lasting->condition.SetPart(number, binding, present, now_us);
    });
    Touch(lasting);
    return true;
  }
  const auto whole = handles_.find(change.id);
  if (whole == handles_.end()) return false;
  const std::shared_ptr<Lasting>& lasting = conditions_[whole->second].lasting;
  if (!lasting) return false;
  Apply(change, [&lasting](const conditions::Binding& binding, bool present) {
    lasting->condition.SetWhole(binding, present);
  });
  Touch(lasting);
  return true;
}

void ConditionPort::Touch(const std::shared_ptr<Lasting>& lasting) {
  if (unsettled_.insert(lasting->handle).second) changed_.push_back(lasting);
}

void ConditionPort::SettleLasting(TimeMicros now_us) {
  for (auto due = deadlines_.begin(); due != deadlines_.end() && due->first <= now_us; ++due) {
    Touch(conditions_[due->second].lasting);
  }
  for (const engine::ConditionHandle handle : unsettled_) {
    const auto found = conditions_.find(handle);
    if (found == conditions_.end()) continue;
    const std::shared_ptr<Lasting>& lasting = found->second.lasting;
    const conditions::LastingCondition::Changes changes = lasting->condition.Settle(now_us);
    List(*lasting, lasting->condition.NextDeadline());
    const std::optional<TimeMicros> before_us =
        std::exchange(lasting->opens_us, lasting->condition.OpensAt());
    const bool moved = before_us != lasting->opens_us;
    if (!changes.any() && !moved) continue;
    engine::ConditionEdge edge{handle, changes.rose, changes.fell, Decode(changes.appeared),
                               Decode(changes.disappeared)};
    edge.moved = moved;
    std::sort(edge.appeared.begin(), edge.appeared.end());
    std::sort(edge.disappeared.begin(), edge.disappeared.end());
    Gather(std::move(edge));
  }
  unsettled_.clear();
}

std::vector<LastingSince> ConditionPort::Times() const {
  std::vector<LastingSince> times;
  for (const auto& [handle, condition] : conditions_) {
    if (!condition.lasting) continue;
    for (const conditions::LastingCondition::Since& since : condition.lasting->condition.Times()) {
      times.push_back({handle, since.part, Decode(since.binding), since.since_us, since.full});
    }
  }
  std::sort(times.begin(), times.end(), [](const LastingSince& a, const LastingSince& b) {
    return std::tie(a.handle, a.part, a.binding) < std::tie(b.handle, b.part, b.binding);
  });
  return times;
}

void ConditionPort::RestoreTimes(const std::vector<LastingSince>& times) {
  for (const LastingSince& time : times) {
    const auto found = conditions_.find(time.handle);
    if (found == conditions_.end() || !found->second.lasting) continue;
    if (time.part >= found->second.lasting->parts.size()) continue;
    conditions::LastingCondition::Since since{time.part, {}, time.since_us, time.full};
    for (const auto& [name, term] : time.binding) {
      if (const std::optional<TermId> id = dictionary_->Find(term)) since.binding.emplace_back(name, *id);
    }
    found->second.lasting->condition.SetTime(since);
    Touch(found->second.lasting);
  }
  SettleLasting(0);
}

}  // namespace docent::server
