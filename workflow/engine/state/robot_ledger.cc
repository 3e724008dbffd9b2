#include "workflow/engine/state/robot_ledger.h"

#include <algorithm>

namespace docent::engine {

bool Collide(const Occupation& a, const Occupation& b) {
  if (a.empty() || b.empty()) return true;
  return std::any_of(a.begin(), a.end(), [&b](const std::string& resource) { return b.contains(resource); });
}

Occupation Both(const Occupation& a, const Occupation& b) {
  Occupation both;
  if (a.empty() || b.empty()) return both;
  both.insert(a.begin(), a.end());
  both.insert(b.begin(), b.end());
  return both;
}

const RunId* RobotLedger::Holder(const RobotId& robot) const {
  const auto holder = holders_.find(robot);
  return holder == holders_.end() ? nullptr : &holder->second;
}

bool RobotLedger::IsFree(const RobotId& robot, const RunId& root) const {
  const RunId* holder = Holder(robot);
  return holder == nullptr || *holder == root;
}

void RobotLedger::Begin(const RobotId& robot, const CommandOwner& owner, Occupation occupies) {
  tasks_[robot][owner] = std::move(occupies);
}

void RobotLedger::End(const RobotId& robot, const CommandOwner& owner) {
  const auto tasks = tasks_.find(robot);
  if (tasks == tasks_.end()) return;
  tasks->second.erase(owner);
  if (tasks->second.empty()) tasks_.erase(tasks);
}

const std::map<CommandOwner, Occupation>& RobotLedger::Tasks(const RobotId& robot) const {
  static const std::map<CommandOwner, Occupation> kNone;
  const auto tasks = tasks_.find(robot);
  return tasks == tasks_.end() ? kNone : tasks->second;
}

void RobotLedger::Index(const EndingCommand& ending) {
  ending_of_[ending.command.robot].insert(ending.command.id);
  for (const CommandOwner& owner : ending.owners) ++ending_by_owner_[owner];
}

void RobotLedger::Unindex(const EndingCommand& ending) {
  const auto of_robot = ending_of_.find(ending.command.robot);
  of_robot->second.erase(ending.command.id);
  if (of_robot->second.empty()) ending_of_.erase(of_robot);
  for (const CommandOwner& owner : ending.owners) {
    const auto count = ending_by_owner_.find(owner);
    if (--count->second == 0) ending_by_owner_.erase(count);
  }
}

void RobotLedger::Await(EndingCommand ending) {
  const CommandId id = ending.command.id;
  undo_.emplace_back(id, std::nullopt);
  Index(ending);
  ending_.emplace(id, std::move(ending));
}

std::optional<EndingCommand> RobotLedger::Ended(const CommandId& command) {
  const auto found = ending_.find(command);
  if (found == ending_.end()) return std::nullopt;
  EndingCommand ending = std::move(found->second);
  ending_.erase(found);
  Unindex(ending);
  undo_.emplace_back(command, ending);
  return ending;
}

const std::set<CommandId>& RobotLedger::EndingOn(const RobotId& robot) const {
  static const std::set<CommandId> kNone;
  const auto of_robot = ending_of_.find(robot);
  return of_robot == ending_of_.end() ? kNone : of_robot->second;
}

size_t RobotLedger::EndingOf(const CommandOwner& owner) const {
  const auto count = ending_by_owner_.find(owner);
  return count == ending_by_owner_.end() ? 0 : count->second;
}

bool RobotLedger::HasEndingOf(const RunId& run, size_t node) const {
  const auto first = ending_by_owner_.lower_bound({run, node, 0});
  return first != ending_by_owner_.end() && first->first.run == run && first->first.node == node;
}

std::optional<CommandId> RobotLedger::LastEndingOf(const RunId& run) const {
  std::optional<CommandId> last;
  for (const auto& [id, ending] : ending_) {
    const bool of_run = std::any_of(ending.owners.begin(), ending.owners.end(),
                                    [&run](const CommandOwner& owner) { return owner.run == run; });
    if (of_run) last = id;
  }
  return last;
}

void RobotLedger::Keep(const CommandId& command, const RunId& run, std::vector<TermQuad> facts) {
  EndingCommand& ending = ending_.at(command);
  undo_.emplace_back(command, ending);
  std::vector<TermQuad>& kept = ending.kept[run];
  kept.insert(kept.end(), facts.begin(), facts.end());
}

bool RobotLedger::Occupied(const RobotId& robot, const Occupation& wanted, const CommandOwner& self) const {
  for (const CommandId& id : EndingOn(robot)) {
    if (Collide(ending_.at(id).occupies, wanted)) return true;
  }
  const auto& tasks = Tasks(robot);
  return std::any_of(tasks.begin(), tasks.end(),
                     [&](const auto& task) { return task.first != self && Collide(task.second, wanted); });
}

void RobotLedger::ClearDerived() {
  holders_.clear();
  tasks_.clear();
}

void RobotLedger::Restore(Ending ending) {
  ClearDerived();
  undo_.clear();
  ending_ = std::move(ending);
  ending_of_.clear();
  ending_by_owner_.clear();
  for (const auto& [id, one] : ending_) Index(one);
}

void RobotLedger::Rollback() {
  for (auto change = undo_.rbegin(); change != undo_.rend(); ++change) {
    if (change->second)
      ending_.insert_or_assign(change->first, *change->second);
    else
      ending_.erase(change->first);
  }
  Restore(std::move(ending_));
}

}  // namespace docent::engine
