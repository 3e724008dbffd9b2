// Ledger of robots: which run holds which robot, and what of the robot is occupied by what.
//
//   run tree   A run and its sub-flows. Named by its outermost run, the root.
//   hold       A robot is held by one run tree: from the first invocation that takes it until the root has ended and
//              every command of the tree to this robot has its final report. Meanwhile no other tree gets it.
//   task       A running invocation of the holding tree. It occupies what its operations occupy, from the turn that
//              gives it the robot until it ends.
//   command    One operation under way. It occupies its own part of the robot until its final report: what the adapter
//              says last, or that the adapter's incarnation is gone.
//   ending     A command that its run waits for no longer (cancelled, timed out, its run ended) and whose final report
//              has not come. The robot goes on being held and occupied by it.
//
// Two occupations collide if one of them is the whole robot, or if they share a resource. The ledger of ending commands is
// state (it is saved, and journaled until Commit); holds and tasks follow from the runs and are put in again by
// Engine::Core::RebuildDerived. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_ROBOT_LEDGER_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_ROBOT_LEDGER_H_

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/store/decisions.h"
#include "workflow/engine/state/ports.h"
#include "workflow/engine/state/waiting_room.h"

namespace docent::engine {

bool Collide(const Occupation& a, const Occupation& b);
// What both together occupy.
Occupation Both(const Occupation& a, const Occupation& b);

struct EndingCommand {
  RobotCommand command;
  Occupation occupies;
  RunId root;
  std::string invocation;  // RUN/NODE/NUMBER, of segments
  // The invocation that sent it, then those that its run is nested in.
  std::vector<CommandOwner> owners;
  TimeMicros since_us = 0;
  // Facts that runs told for as long as they last (lifetime="run"). The runs have ended; this is the last of their commands.
  std::map<RunId, std::vector<TermQuad>> kept = {};
};

class RobotLedger {
 public:
  using Ending = std::map<CommandId, EndingCommand>;

  // holds
  void Hold(const RobotId& robot, const RunId& root) { holders_.emplace(robot, root); }
  void Release(const RobotId& robot) { holders_.erase(robot); }
  // Null: the robot is free.
  const RunId* Holder(const RobotId& robot) const;
  bool IsFree(const RobotId& robot, const RunId& root) const;
  const std::map<RobotId, RunId>& holders() const { return holders_; }

  // tasks
  void Begin(const RobotId& robot, const CommandOwner& owner, Occupation occupies);
  void End(const RobotId& robot, const CommandOwner& owner);
  // Nothing for an unknown robot.
  const std::map<CommandOwner, Occupation>& Tasks(const RobotId& robot) const;

  // ending commands
  void Await(EndingCommand ending);
  // The command has its final report; nullopt: it is not one of these.
  std::optional<EndingCommand> Ended(const CommandId& command);
  bool Awaits(const RobotId& robot) const { return ending_of_.contains(robot); }
  const std::set<CommandId>& EndingOn(const RobotId& robot) const;
  // How many commands of this invocation, and of runs nested in it, are ending.
  size_t EndingOf(const CommandOwner& owner) const;
  // Whether commands of invocations of this node are ending, also of those that the node has no more.
  bool HasEndingOf(const RunId& run, size_t node) const;
  // The last one that the run, or a run nested in it, sent; nullopt: none is ending.
  std::optional<CommandId> LastEndingOf(const RunId& run) const;
  // Facts of the run stay until this command, which is ending, has its final report.
  void Keep(const CommandId& command, const RunId& run, std::vector<TermQuad> facts);
  const Ending& ending() const { return ending_; }

  // False: nothing occupies the robot.
  bool HasWork(const RobotId& robot) const { return tasks_.contains(robot) || Awaits(robot); }
  // Whether something other than the task of `self` occupies some of what `wanted` does.
  bool Occupied(const RobotId& robot, const Occupation& wanted, const CommandOwner& self) const;

  // Replaces the ending commands and forgets all holds and tasks.
  void Restore(Ending ending);
  // Forgets holds and tasks.
  void ClearDerived();
  void Commit() { undo_.clear(); }
  // Ending commands are as at the last Commit; holds and tasks are forgotten.
  void Rollback();
  bool changed() const { return !undo_.empty(); }

 private:
  void Index(const EndingCommand& ending);
  void Unindex(const EndingCommand& ending);

  std::map<RobotId, RunId> holders_;
  std::map<RobotId, std::map<CommandOwner, Occupation>> tasks_;
  Ending ending_;
  std::map<RobotId, std::set<CommandId>> ending_of_;
  std::map<CommandOwner, size_t> ending_by_owner_;
  std::vector<std::pair<CommandId, std::optional<EndingCommand>>>
      undo_;  // what was before, in order of the changes
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_ROBOT_LEDGER_H_
