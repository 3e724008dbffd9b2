// Signals as calls: blocked everywhere, taken by whoever waits here, so that a program ends in its own order.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_SIGNALS_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_SIGNALS_H_

#include <chrono>

namespace docent::robot {

// Blocks SIGINT, SIGTERM and SIGUSR1 in this thread and all that it begins later. Call it before any thread
// begins.
void BlockSignals();

enum class Signal { kNone, kEnd, kReport };
// kEnd: SIGINT or SIGTERM; kReport: SIGUSR1; kNone: none came within `timeout`.
Signal WaitForSignal(std::chrono::milliseconds timeout);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_SIGNALS_H_
