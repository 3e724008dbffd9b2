// What goes on in a run while an operator steers it, in words. Values; any thread.
#ifndef DOCENT_KB_SERVER_CLI_RUNS_NODES_AT_WORK_H_
#define DOCENT_KB_SERVER_CLI_RUNS_NODES_AT_WORK_H_

#include <string>

#include "docent/v1/workflows.pb.h"

namespace docent::server {

// Names of the nodes that have begun and have not ended: "Lead, Speak"; empty: none.
std::string NodesAtWork(const v1::Run& run);

// That nodes at work keep the value of a variable that was set just now, on a line; empty: none is at work.
std::string KeptValueText(const v1::Run& run, const std::string& variable);

// That a paused run still has commands under way, on a line; empty: it has none.
std::string StillUnderWay(const v1::Run& run);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_RUNS_NODES_AT_WORK_H_
