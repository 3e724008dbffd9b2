// Robots that runs outside of this engine hold.
#include <utility>

#include "workflow/engine/engine_core.h"

namespace docent::engine {

void Engine::HoldForOthers(std::map<RobotId, RunId> holds) {
  for (const auto& [robot, run] : std::exchange(core_->held_by_others, std::move(holds))) {
    const RunId* holder = core_->ledger.Holder(robot);
    if (holder != nullptr && *holder == run) core_->ledger.Release(robot);
  }
  for (const auto& [robot, run] : core_->held_by_others) core_->ledger.Hold(robot, run);
  core_->services_changed = true;  // what waits for a robot is looked at again
}

}  // namespace docent::engine
