#include "kb_server/cli/work_to_stop.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "graph/rdf/date_time.h"

namespace docent::server {
namespace {

// "expo:R07, which is offline (last seen 2026-12-01T14:30:00Z),".
std::string WhoIs(const std::string& robot, const v1::ListRobotsReply& robots, const Presenter& presenter) {
  for (const v1::RobotStatus& each : robots.robots()) {
    if (each.robot() != robot || each.state() != "offline") continue;
    const std::string seen =
        each.last_seen_us() == 0
            ? ""
            : absl::StrCat(" (last seen ", DateTimeTerm(each.last_seen_us()).lexical, ")");
    return absl::StrCat(presenter.Iri(robot), ", which is offline", seen, ",");
  }
  return presenter.Iri(robot);
}

}  // namespace

grpc::Status AllRobots(v1::Fleet::Stub& fleet, v1::ListRobotsReply* all) {
  v1::ListRobotsRequest request;
  do {
    v1::ListRobotsReply page;
    grpc::ClientContext context;
    if (grpc::Status status = fleet.List(&context, request, &page); !status.ok()) return status;
    all->mutable_robots()->MergeFrom(page.robots());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return grpc::Status::OK;
}

std::string WorkToStop(const v1::Run& run, const v1::ListRobotsReply& robots, const std::string& robot,
                       const Presenter& presenter) {
  std::string text;
  for (const v1::Node& node : run.nodes()) {
    for (const v1::Invocation& invocation : node.invocations()) {
      const bool meant = robot.empty() || invocation.robot() == robot;
      if (!meant || invocation.command().empty() || invocation.state() != "running") continue;
      absl::StrAppend(&text, run.id(), "/", node.name(), " ",
                      invocation.step().empty() ? invocation.operation() : invocation.step(),
                      " is asked to stop; ", WhoIs(invocation.robot(), robots, presenter),
                      " has not yet confirmed it. It is told until it has; docent runs ", run.id(),
                      " shows it\n");
    }
  }
  return text;
}

void SayWorkToStop(const ClientOptions& client, const std::set<std::string>& runs, const std::string& robot) {
  const auto channel = Connect(client);
  v1::ListRobotsReply robots;
  if (!AllRobots(*v1::Fleet::NewStub(channel), &robots).ok()) return;
  const auto workflows = v1::Workflows::NewStub(channel);
  const Presenter presenter(client);
  std::cout << std::flush;
  for (const std::string& id : runs) {
    v1::GetRunRequest get;
    get.set_run(id);
    v1::Run run;
    grpc::ClientContext context;
    if (workflows->Get(&context, get, &run).ok()) std::cerr << WorkToStop(run, robots, robot, presenter);
  }
}

}  // namespace docent::server
