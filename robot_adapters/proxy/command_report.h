// Feedback messages of adapters as reports for the server's door. Pure functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_COMMAND_REPORT_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_COMMAND_REPORT_H_

#include "docent/v1/robot_adapter.pb.h"
#include "graph/store/decisions.h"
#include "graph/store/write_batch.h"

namespace docent::proxy {

bool IsFinal(v1::Feedback::State state);
// Terms that are unset are left out of the results.
// `left_out` names the results that cannot be taken, and why; empty: none.
CommandReport ReportOf(const CommandId& command, const v1::Feedback& feedback, std::string* left_out);
v1::InvokeRequest InvokeRequestOf(const RobotCommand& command, const std::string& expected_incarnation);

}  // namespace docent::proxy

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_COMMAND_REPORT_H_
