// Scheduler of runs: which are advanced in a Step, and which gets a free robot. Private to this folder. Writer
// thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_SCHEDULER_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_SCHEDULER_H_

#include "workflow/engine/engine_core.h"

namespace docent::engine {

// Robots came, went or changed, or robot services did: wakes as many of each queue as can be served, and
// everybody whose reason to wait is another one now.
void ReconsiderWaiting(Engine::Core* core);

// Calls back commands that robots have not begun which take none any more.
void RecallFromOutOfService(Engine::Core* core);

// Takes touched runs as far as they go, parents after their children, and gives the robots of runs that ended
// to those that wait.
void AdvanceAll(Engine::Core* core);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_SCHEDULER_H_
