// What the graph docent:runs says of a robot: when it was used last, its load, and if it is held, by which run, for which
// invocations, and which commands have yet to end. Pure, but for new terms that are interned: writer thread only. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_ROBOT_FACTS_H_
#define DOCENT_WORKFLOW_ENGINE_ROBOT_FACTS_H_

#include <vector>

#include "workflow/engine/engine_core.h"

namespace docent::engine {

// Sorted, none twice; none for a robot that is free and was never used.
std::vector<Quad> RobotFacts(const RobotId& robot, Engine::Core* core);

// Brings the graph in line for the robots that changed in this Step.
void TellRobots(Engine::Core* core);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_ROBOT_FACTS_H_
