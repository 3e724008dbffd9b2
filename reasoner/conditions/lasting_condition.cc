#include "reasoner/conditions/lasting_condition.h"

#include <algorithm>

namespace docent::conditions {
namespace {

constexpr size_t kLookedAt = 1000;  // solutions, for OpensAt

}  // namespace

LastingCondition::LastingCondition(std::vector<std::string> keys, std::vector<Part> parts)
    : keys_(std::move(keys)) {
  const auto column_of = [this](const std::string& name) {
    const auto found = std::find(variables_.begin(), variables_.end(), name);
    if (found == variables_.end()) {
      variables_.push_back(name);
      return variables_.size() - 1;
    }
    return static_cast<size_t>(found - variables_.begin());
  };
  for (const std::string& name : keys_) key_columns_.push_back(column_of(name));
  for (Part& part : parts) {
    PartState& state = parts_.emplace_back();
    for (const std::string& name : part.variables) state.columns.push_back(column_of(name));
    state.variables = std::move(part.variables);
    state.at_least_us = part.at_least_us;
  }
}

LastingCondition::Row LastingCondition::RowOf(const Binding& binding,
                                              const std::vector<std::string>& variables) {
  Row row(variables.size());
  for (const auto& [name, id] : binding) {
    const auto found = std::find(variables.begin(), variables.end(), name);
    if (found != variables.end()) row[static_cast<size_t>(found - variables.begin())] = id;
  }
  return row;
}

LastingCondition::Row LastingCondition::Project(const Row& whole, const std::vector<size_t>& columns) {
  Row row;
  for (const size_t column : columns) row.push_back(whole[column]);
  return row;
}

Binding LastingCondition::BindingOf(const Row& row, const std::vector<std::string>& variables) const {
  Binding binding;
  for (size_t i = 0; i < row.size(); ++i) {
    if (!row[i].IsNone()) binding.emplace_back(variables[i], row[i]);
  }
  return binding;
}

void LastingCondition::PutTime(size_t part, const Row& row, std::optional<Time> time) {
  PartState& state = parts_[part];
  Undo undo{part, row, std::nullopt, std::nullopt};
  if (const auto found = state.times.find(row); found != state.times.end()) {
    undo.time = found->second;
    if (!found->second.full) state.waiting.erase({found->second.since_us + state.at_least_us, row});
    if (!time) state.times.erase(found);
  }
  if (time) {
    state.times[row] = *time;
    if (!time->full) state.waiting.emplace(time->since_us + state.at_least_us, row);
  }
  if (!undoing_) undo_.push_back(std::move(undo));
}

void LastingCondition::CountOpen(const Row& whole, int by) {
  const Row key = Project(whole, key_columns_);
  int& count = open_[key];
  before_.try_emplace(key, count > 0);
  count += by;
  if (count == 0) open_.erase(key);
}

void LastingCondition::PutWhole(const Row& row, std::optional<bool> open) {
  Undo undo{Undo::kWhole, row, std::nullopt, std::nullopt};
  const auto found = wholes_.find(row);
  if (found != wholes_.end()) undo.open = found->second;
  if (undo.open == true && open != true) CountOpen(row, -1);
  if (undo.open != true && open == true) CountOpen(row, +1);
  if (undo.open.has_value() != open.has_value()) {
    for (PartState& part : parts_) {
      const Row binding = Project(row, part.columns);
      absl::btree_set<Row>& wholes = part.wholes[binding];
      if (open) {
        wholes.insert(row);
      } else {
        wholes.erase(row);
        if (wholes.empty()) part.wholes.erase(binding);
      }
    }
  }
  if (open) {
    wholes_[row] = *open;
  } else if (found != wholes_.end()) {
    wholes_.erase(found);
  }
  if (!undoing_) undo_.push_back(std::move(undo));
}

void LastingCondition::WholesAreStale(size_t part, const Row& row) {
  const auto found = parts_[part].wholes.find(row);
  if (found != parts_[part].wholes.end()) stale_.insert(found->second.begin(), found->second.end());
}

void LastingCondition::SetWhole(const Binding& solution, bool present) {
  const Row row = RowOf(solution, variables_);
  if (wholes_.contains(row) == present) return;
  PutWhole(row, present ? std::make_optional(false) : std::nullopt);
  if (present) stale_.insert(row);
}

void LastingCondition::SetPart(size_t part, const Binding& binding, bool present, TimeMicros now_us) {
  const Row row = RowOf(binding, parts_[part].variables);
  if (parts_[part].times.contains(row) == present) return;
  PutTime(part, row, present ? std::make_optional(Time{now_us, false}) : std::nullopt);
  WholesAreStale(part, row);
}

void LastingCondition::SetTime(const Since& since) {
  const Row row = RowOf(since.binding, parts_[since.part].variables);
  if (!parts_[since.part].times.contains(row)) return;
  PutTime(since.part, row, Time{since.since_us, since.full});
  WholesAreStale(since.part, row);
}

bool LastingCondition::AllFull(const Row& whole) const {
  return std::all_of(parts_.begin(), parts_.end(), [&whole](const PartState& part) {
    const auto found = part.times.find(Project(whole, part.columns));
    return found != part.times.end() && found->second.full;
  });
}

LastingCondition::Changes LastingCondition::Settle(TimeMicros now_us) {
  for (size_t i = 0; i < parts_.size(); ++i) {
    PartState& part = parts_[i];
    while (!part.waiting.empty() && part.waiting.begin()->first <= now_us) {
      const Row row = part.waiting.begin()->second;
      PutTime(i, row, Time{part.times[row].since_us, true});
      WholesAreStale(i, row);
    }
  }
  for (const Row& row : stale_) {
    const auto found = wholes_.find(row);
    if (found == wholes_.end()) continue;
    if (const bool open = AllFull(row); open != found->second) PutWhole(row, open);
  }
  stale_.clear();
  Changes changes;
  size_t open_before = open_.size();
  for (const auto& [key, was_open] : before_) {
    const bool is_open = open_.contains(key);
    if (is_open == was_open) continue;
    open_before += was_open ? 1 : -1;
    if (!keys_.empty()) (is_open ? changes.appeared : changes.disappeared).push_back(BindingOf(key, keys_));
  }
  before_.clear();
  changes.rose = open_before == 0 && holds();
  changes.fell = open_before > 0 && !holds();
  return changes;
}

bool LastingCondition::Admits(const Binding& solution) const {
  return AllFull(RowOf(solution, variables_));
}

std::optional<TimeMicros> LastingCondition::OpensAt() const {
  if (!open_.empty() || wholes_.size() > kLookedAt) return std::nullopt;
  std::optional<TimeMicros> first;
  for (const auto& [whole, open] : wholes_) {
    TimeMicros full_us = 0;
    bool held = true;
    for (const PartState& part : parts_) {
      const auto time = part.times.find(Project(whole, part.columns));
      held = held && time != part.times.end();
      if (held && !time->second.full) full_us = std::max(full_us, time->second.since_us + part.at_least_us);
    }
    if (held) first = std::min(first.value_or(full_us), full_us);
  }
  return first;
}

std::optional<TimeMicros> LastingCondition::NextDeadline() const {
  std::optional<TimeMicros> next;
  for (const PartState& part : parts_) {
    if (part.waiting.empty()) continue;
    const TimeMicros due = part.waiting.begin()->first;
    next = next ? std::min(*next, due) : due;
  }
  return next;
}

void LastingCondition::Rollback() {
  undoing_ = true;
  for (auto undo = undo_.rbegin(); undo != undo_.rend(); ++undo) {
    if (undo->part == Undo::kWhole) {
      PutWhole(undo->row, undo->open);
    } else {
      PutTime(undo->part, undo->row, undo->time);
    }
  }
  undoing_ = false;
  undo_.clear();
  stale_.clear();
  before_.clear();
}

std::vector<LastingCondition::Since> LastingCondition::Times() const {
  std::vector<Since> times;
  for (size_t i = 0; i < parts_.size(); ++i) {
    for (const auto& [row, time] : parts_[i].times) {
      times.push_back(
          {static_cast<uint32_t>(i), BindingOf(row, parts_[i].variables), time.since_us, time.full});
    }
  }
  return times;
}

}  // namespace docent::conditions
