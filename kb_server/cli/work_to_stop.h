// Work that robots were asked to stop, and have not confirmed that they did. One thread.
#ifndef DOCENT_KB_SERVER_CLI_WORK_TO_STOP_H_
#define DOCENT_KB_SERVER_CLI_WORK_TO_STOP_H_

#include <set>
#include <string>

#include "docent/v1/fleet.grpc.pb.h"
#include "docent/v1/workflows.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {

// All robots that the server knows, a page after the other.
grpc::Status AllRobots(v1::Fleet::Stub& fleet, v1::ListRobotsReply* all);

// A line for each command of the run that is under way, after it was to stop; empty: none is. `robot`: of this one alone; empty: of all.
std::string WorkToStop(const v1::Run& run, const v1::ListRobotsReply& robots, const std::string& robot,
                       const Presenter& presenter);

// Asks the server, and writes the same for several runs to standard error; nothing where the server does not say.
void SayWorkToStop(const ClientOptions& client, const std::set<std::string>& runs, const std::string& robot);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_WORK_TO_STOP_H_
