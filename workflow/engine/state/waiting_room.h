// Queue for robots, oldest run first: invocations that no robot can take now, and runs with a condition
// that holds but only with robots that serve other runs. When one robot is freed, one who can use it is
// woken, not everybody.
//
// Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_WAITING_ROOM_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_WAITING_ROOM_H_

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/ids.h"

namespace docent::engine {

// One invocation of a run.
struct CommandOwner {
  RunId run;
  size_t node = 0;
  size_t invocation = 0;
  friend auto operator<=>(const CommandOwner&, const CommandOwner&) = default;
};

// What a pending invocation waits for.
struct RobotWish {
  RobotId robot;          // empty: any that offers the operation
  std::string operation;  // of the invoke: a robot service or a robot's own operation
  friend auto operator<=>(const RobotWish&, const RobotWish&) = default;
};

class WaitingRoom {
 public:
  // `number`: the run's place among all (Engine::Core::RankOf), the smaller, the sooner. Replaces what `owner` waited for before.
  void Wait(uint64_t number, const CommandOwner& owner, RobotWish wish);
  void Leave(const CommandOwner& owner);

  // A reservation keeps `owner`, which waits, from a robot. So it is until it leaves.
  void Bar(const CommandOwner& owner) { barred_.insert(owner); }
  const std::set<CommandOwner>& barred() const { return barred_; }

  // The run has conditions that hold with one of these robots only. Replaces what was said of it before;
  // none: it is not blocked.
  void Block(uint64_t number, const RunId& run, const std::set<RobotId>& robots);

  // Nobody waits.
  bool empty() const { return owners_.empty() && blocked_runs_.empty(); }
  // How many invocations wait for this robot alone.
  size_t WaitingFor(const RobotId& robot) const;
  // Robots for which WaitingFor may have changed since this was asked last.
  std::set<RobotId> TakeChanged() { return std::exchange(changed_, {}); }

  // Those with which a run is blocked.
  std::vector<RobotId> BlockedRobots() const;

  // Calls `visit` for each wish that somebody has.
  void ForEachWish(const std::function<void(const RobotWish&)>& visit) const;
  // The oldest `count` invocations with this wish.
  std::vector<CommandOwner> Oldest(const RobotWish& wish, size_t count) const;
  // The first run behind `after` and before `before` that could use `robot`; `offers` says whether the robot does an
  // operation.
  std::optional<std::pair<uint64_t, RunId>> Next(
      const RobotId& robot, uint64_t after, const std::function<bool(const std::string& operation)>& offers,
      uint64_t before = UINT64_MAX) const;
  void Clear();

 private:
  using Queue = std::set<std::pair<uint64_t, CommandOwner>>;
  using BlockedQueue = std::set<std::pair<uint64_t, RunId>>;

  std::map<RobotWish, Queue> wishes_;
  std::map<CommandOwner, std::pair<uint64_t, RobotWish>> owners_;
  std::set<CommandOwner> barred_;
  std::map<RobotId, size_t> waiting_for_;
  std::set<RobotId> changed_;
  std::map<RobotId, BlockedQueue> blocked_;
  std::map<RunId, std::pair<uint64_t, std::set<RobotId>>> blocked_runs_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_WAITING_ROOM_H_
