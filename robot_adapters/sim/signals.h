// Signals as function calls: blocked in all threads and received by one waiting call, so that a program shuts
// down in order.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_SIGNALS_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_SIGNALS_H_

#include <chrono>

namespace docent::robot {

// Blocks SIGINT, SIGTERM and SIGUSR1 in this thread and all threads that it starts later. Call it before any
// thread starts.
void BlockSignals();

enum class Signal { kNone, kEnd, kReport };
// kEnd: SIGINT or SIGTERM; kReport: SIGUSR1; kNone: no signal within `timeout`.
Signal WaitForSignal(std::chrono::milliseconds timeout);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_SIGNALS_H_
