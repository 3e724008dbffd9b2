#include "workflow/engine/state/waiting_room.h"

namespace docent::engine {

void WaitingRoom::Wait(uint64_t number, const CommandOwner& owner, RobotWish wish) {
  auto it = owners_.find(owner);
  if (it != owners_.end()) {
    if (it->second.second == wish) return;
    Leave(owner);
  }
  wishes_[wish].insert({number, owner});
  if (!wish.robot.empty()) {
    ++waiting_for_[wish.robot];
    changed_.insert(wish.robot);
  }
  owners_.emplace(owner, std::make_pair(number, std::move(wish)));
}

void WaitingRoom::Leave(const CommandOwner& owner) {
  auto it = owners_.find(owner);
  if (it == owners_.end()) return;
  const auto& [number, wish] = it->second;
  auto queue = wishes_.find(wish);
  if (!wish.robot.empty()) {
    const auto count = waiting_for_.find(wish.robot);
    if (--count->second == 0) waiting_for_.erase(count);
    changed_.insert(wish.robot);
  }
  barred_.erase(owner);
  queue->second.erase({number, owner});
  if (queue->second.empty()) wishes_.erase(queue);
  owners_.erase(it);
}

size_t WaitingRoom::WaitingFor(const RobotId& robot) const {
  const auto count = waiting_for_.find(robot);
  return count == waiting_for_.end() ? 0 : count->second;
}

void WaitingRoom::Block(uint64_t number, const RunId& run, const std::set<RobotId>& robots) {
  auto it = blocked_runs_.find(run);
  if (it != blocked_runs_.end()) {
    if (it->second.second == robots) return;
    for (const RobotId& robot : it->second.second) {
      auto queue = blocked_.find(robot);
      queue->second.erase({number, run});
      if (queue->second.empty()) blocked_.erase(queue);
    }
    blocked_runs_.erase(it);
  }
  if (robots.empty()) return;
  for (const RobotId& robot : robots) blocked_[robot].insert({number, run});
  blocked_runs_.emplace(run, std::make_pair(number, robots));
}

std::vector<RobotId> WaitingRoom::BlockedRobots() const {
  std::vector<RobotId> robots;
  for (const auto& [robot, queue] : blocked_) robots.push_back(robot);
  return robots;
}

void WaitingRoom::ForEachWish(const std::function<void(const RobotWish&)>& visit) const {
  for (const auto& [wish, queue] : wishes_) visit(wish);
}

std::vector<CommandOwner> WaitingRoom::Oldest(const RobotWish& wish, size_t count) const {
  std::vector<CommandOwner> oldest;
  auto it = wishes_.find(wish);
  if (it == wishes_.end()) return oldest;
  for (const auto& [number, owner] : it->second) {
    if (oldest.size() == count) break;
    oldest.push_back(owner);
  }
  return oldest;
}

std::optional<std::pair<uint64_t, RunId>> WaitingRoom::Next(
    const RobotId& robot, uint64_t after, const std::function<bool(const std::string& operation)>& offers,
    uint64_t before) const {
  std::optional<std::pair<uint64_t, RunId>> next;
  auto consider = [&next](uint64_t number, const RunId& run) {
    if (!next || number < next->first) next = {number, run};
  };
  for (const RobotId& wanted : {RobotId(), robot}) {
    for (auto it = wishes_.lower_bound({wanted, ""}); it != wishes_.end() && it->first.robot == wanted;
         ++it) {
      auto first = it->second.lower_bound({after + 1, CommandOwner()});
      if (first != it->second.end() && first->first < before && (!next || first->first < next->first) &&
          offers(it->first.operation)) {
        consider(first->first, first->second.run);
      }
    }
  }
  if (auto it = blocked_.find(robot); it != blocked_.end()) {
    auto first = it->second.lower_bound({after + 1, RunId()});
    if (first != it->second.end() && first->first < before) consider(first->first, first->second);
  }
  return next;
}

void WaitingRoom::Clear() {
  wishes_.clear();
  owners_.clear();
  barred_.clear();
  for (const auto& [robot, count] : waiting_for_) changed_.insert(robot);
  waiting_for_.clear();
  blocked_.clear();
  blocked_runs_.clear();
}

}  // namespace docent::engine
