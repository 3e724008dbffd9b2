// Workflows: what steers runs. Cancel, pause and resume, incidents settled, variables set.
#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/base/cut_text.h"
#include "graph/base/text_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/unary_reactors.h"

namespace docent::server {
namespace {

grpc::Status Invalid(const std::string& why) {
  return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, why);
}

// Asks, and answers with the run as it is then.
grpc::ServerUnaryReactor* Ask(const RunPorts& ports, grpc::CallbackServerContext* context, RunRequest request,
                              v1::Run* reply) {
  WriteBatch batch;
  const std::string run = request.target;
  batch.run_requests.push_back(std::move(request));
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports.inbox->Push(std::move(batch),
                    [&ports, reactor, reply, run](const absl::StatusOr<BatchOutcome>& outcome) {
                      if (outcome.ok()) {
                        GraphVersionPtr version = ports.queries->Newest();
                        ReadRun(GraphReader(*ports.dictionary, *version), run, reply);
                        FitRun(kTextLimits.shown_text_bytes, reply);
                      }
                      reactor->Finish(ToGrpc(outcome.status()));
                    });
  return reactor;
}

// Pause and Resume are alike, but for the kinds of what they ask.
template <typename Request, typename Reply>
grpc::ServerUnaryReactor* PauseOrResume(const RunPorts& ports, grpc::CallbackServerContext* context,
                                        const Request& request, RunRequest::Kind of_run,
                                        RunRequest::Kind of_workflow, RunRequest asked, Reply* reply) {
  if (request.what_case() == Request::WHAT_NOT_SET)
    return FinishNow(context, Invalid("name a run or a workflow"));
  const bool run = request.what_case() == Request::kRun;
  asked.kind = run ? of_run : of_workflow;
  asked.target = run ? request.run() : request.workflow();
  WriteBatch batch;
  batch.run_requests.push_back(std::move(asked));
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
    if (outcome.ok()) {
      reply->set_revision(outcome->offset);
      for (const RunId& steered : outcome->steered) reply->add_runs(steered.value());
    }
    reactor->Finish(ToGrpc(outcome.status()));
  });
  return reactor;
}

}  // namespace

grpc::ServerUnaryReactor* WorkflowsService::Cancel(grpc::CallbackServerContext* context,
                                                   const v1::CancelRunRequest* request, v1::Run* reply) {
  RunRequest asked;
  asked.kind = RunRequest::Kind::kCancel;
  asked.target = request->run();
  asked.reason = CutText(request->reason(), kTextLimits.message_bytes);
  asked.compensates = request->compensate();
  return Ask(ports_, context, std::move(asked), reply);
}

grpc::ServerUnaryReactor* WorkflowsService::Pause(grpc::CallbackServerContext* context,
                                                  const v1::PauseRequest* request, v1::PauseReply* reply) {
  RunRequest asked;
  asked.reason = CutText(request->reason(), kTextLimits.message_bytes);
  asked.cancels_commands = request->cancel_commands();
  return PauseOrResume(ports_, context, *request, RunRequest::Kind::kPause, RunRequest::Kind::kPauseWorkflow,
                       std::move(asked), reply);
}

grpc::ServerUnaryReactor* WorkflowsService::Resume(grpc::CallbackServerContext* context,
                                                   const v1::ResumeRequest* request, v1::ResumeReply* reply) {
  return PauseOrResume(ports_, context, *request, RunRequest::Kind::kResume,
                       RunRequest::Kind::kResumeWorkflow, {}, reply);
}

grpc::ServerUnaryReactor* WorkflowsService::Settle(grpc::CallbackServerContext* context,
                                                   const v1::SettleRequest* request, v1::Run* reply) {
  RunRequest asked;
  switch (request->how()) {
    case v1::SettleRequest::RETRY:
      asked.kind = RunRequest::Kind::kRetryNode;
      break;
    case v1::SettleRequest::SKIP:
      asked.kind = RunRequest::Kind::kSkipNode;
      break;
    case v1::SettleRequest::FAIL:
      asked.kind = RunRequest::Kind::kFailNode;
      break;
    default:
      return FinishNow(context, Invalid("how is not given; it is RETRY, SKIP or FAIL"));
  }
  if (!request->robot().empty() && request->how() != v1::SettleRequest::RETRY)
    return FinishNow(context, Invalid("robot is given, and only RETRY takes one"));
  if (!request->values().empty() && request->how() != v1::SettleRequest::SKIP)
    return FinishNow(context, Invalid("values are given, and only SKIP takes them"));
  if (!request->robot().empty()) {
    if (absl::Status robot = CheckRobotIri(request->robot(), "robot", ports_.limits); !robot.ok())
      return FinishNow(context, ToGrpc(robot));
    const GraphVersionPtr version = ports_.queries->Newest();
    const std::vector<Term> types =
        GraphReader(*ports_.dictionary, *version).Objects(request->robot(), kRdfType);
    if (std::find(types.begin(), types.end(), Term::Iri(DocentIri("Robot"))) == types.end()) {
      return FinishNow(
          context,
          ToGrpc(absl::NotFoundError(absl::StrCat("there is no robot <", request->robot(),
                                                  ">; docent robots lists those that have joined"))));
    }
  }
  auto values = FromProto(request->values(), "values", ports_.limits);
  if (!values.ok()) return FinishNow(context, ToGrpc(values.status()));
  asked.target = request->run();
  asked.node = request->node();
  asked.robot = request->robot();
  asked.reason = CutText(request->reason(), kTextLimits.message_bytes);
  asked.arguments = *std::move(values);
  return Ask(ports_, context, std::move(asked), reply);
}

grpc::ServerUnaryReactor* WorkflowsService::SetVariable(grpc::CallbackServerContext* context,
                                                        const v1::SetVariableRequest* request,
                                                        v1::Run* reply) {
  if (request->variable().name().empty()) return FinishNow(context, Invalid("variable.name is empty"));
  auto value = FromProto(request->variable().value(), absl::StrCat("variable ", request->variable().name()),
                         ports_.limits);
  if (!value.ok()) return FinishNow(context, ToGrpc(value.status()));
  RunRequest asked;
  asked.kind = RunRequest::Kind::kSetVariable;
  asked.target = request->run();
  asked.arguments = {{request->variable().name(), *std::move(value)}};
  return Ask(ports_, context, std::move(asked), reply);
}

}  // namespace docent::server
