// Workflows: check, deploy, start, look at and end runs.
#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/work/condition_cost.h"
#include "kb_server/work/graph_environment.h"
#include "workflow/cawl/check/check.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::server {
namespace {

// It ends early by `cancellation`.
absl::StatusOr<cawl::CheckReport> CheckText(const RunPorts& ports, const std::string& text,
                                            const std::string& name, Cancellation* cancellation) {
  if (absl::Status size = CheckDocumentSize(name, text, ports.limits); !size.ok()) return size;
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  const std::shared_ptr<const Catalog> catalog = ports.catalog->Get();
  auto environment = GraphEnvironment(*ports.dictionary, ports.queries->Newest(), catalog, ports.functions);
  std::vector<cawl::DocumentPtr> beside;
  for (const auto& [workflow, revision] : catalog->workflows) {
    if (catalog->disabled_workflows.count(workflow->name.value) == 0) beside.push_back(workflow);
  }
  cawl::CheckReport report =
      cawl::CheckDocument(text, name, environment.get(), ports.limits, beside, cancellation);
  if (!report.stopped.ok()) return report.stopped;
  for (Diagnostic& warning : CostWarnings(report, name, ports, cancellation))
    report.diagnostics.push_back(std::move(warning));
  if (absl::Status status = cancellation->CheckNow(); !status.ok()) return status;
  return report;
}

// Whether the flow that `start` asks for declares each of the variables, or parts of them. What names none is
// left to the engine to say, and so is the type of a value.
absl::Status CheckVariables(const Catalog& catalog, const RunRequest& start) {
  for (const auto& [workflow, flow_name] : cawl::StartTargets(start.target)) {
    const cawl::DocumentPtr document = catalog.FindWorkflow(workflow);
    const cawl::Flow* flow = document != nullptr ? document->FlowToStart(flow_name) : nullptr;
    if (flow == nullptr) continue;
    const cawl::Scope cawl(*document), of_flow(cawl, *flow);
    std::vector<std::string> names;
    const auto add = [&names](const cawl::Scope& scope) {
      for (const cawl::Variable& variable : scope.variables()) {
        for (std::string& key : scope.Keys(variable)) names.push_back(std::move(key));
      }
    };
    add(of_flow);
    add(cawl);
    const auto& activator = document->activator;
    if (activator && activator->flow.value == flow->name.value) add(cawl::Scope(cawl, *activator));
    for (const auto& [name, value] : start.arguments) {
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      const std::string near = Nearest(name, names);
      return absl::InvalidArgumentError(
          absl::StrCat("flow ", flow->name.value, " has no variable ", name,
                       !near.empty()   ? absl::StrCat("; did you mean ", near, "?")
                       : names.empty() ? "; it has none"
                                       : absl::StrCat("; it has ", absl::StrJoin(names, ", "))));
    }
    return absl::OkStatus();
  }
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* WorkflowsService::Check(grpc::CallbackServerContext* context,
                                                  const v1::CheckRequest* request, v1::CheckReply* reply) {
  const auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  const auto check = [this, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    const auto report = CheckText(ports_, request->cawl(), request->name(), cancellation.get());
    if (!report.ok()) return reactor->Finish(ToGrpc(report.status()));
    for (const Diagnostic& diagnostic : report->diagnostics) ToProto(diagnostic, reply->add_diagnostics());
    for (const cawl::ConditionText& condition : report->conditions) {
      v1::CompiledCondition* out = reply->add_conditions();
      out->set_place(condition.place);
      out->set_ask(condition.ask);
    }
    reactor->Finish(grpc::Status::OK);
  };
  return OnWorker(ports_, context, cancellation, check);
}

grpc::ServerUnaryReactor* WorkflowsService::Deploy(grpc::CallbackServerContext* context,
                                                   const v1::DeployRequest* request, v1::DeployReply* reply) {
  const auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  const auto deploy = [this, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    const auto report = CheckText(ports_, request->cawl(), request->name(), cancellation.get());
    if (!report.ok()) return reactor->Finish(ToGrpc(report.status()));
    if (!report->ok()) return reactor->Finish(ToGrpc(ToStatus(report->diagnostics, request->cawl())));
    for (const Diagnostic& diagnostic : report->diagnostics) ToProto(diagnostic, reply->add_diagnostics());
    reply->set_workflow(report->document->name.value);
    WriteBatch batch;
    Document& document = batch.documents.emplace_back(
        Document{Document::Kind::kCawl, Document::Action::kPut, request->name(), request->cawl(),
                 std::make_shared<const ParsedDocument>(report->document)});
    if (request->has_replaces()) document.replaces = request->replaces();
    ports_.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) reply->set_revision(outcome->offset);
      reactor->Finish(ToGrpc(outcome.status()));
    });
  };
  return OnWorker(ports_, context, cancellation, deploy);
}

grpc::ServerUnaryReactor* WorkflowsService::Start(grpc::CallbackServerContext* context,
                                                  const v1::StartRequest* request, v1::StartReply* reply) {
  if (absl::Status id = CheckRequestId(request->request_id()); !id.ok())
    return FinishNow(context, ToGrpc(id));
  WriteBatch batch;
  batch.request_id = request->request_id();
  batch.request_digest = DigestOf(request->request_id(), *request);
  RunRequest start;
  start.kind = RunRequest::Kind::kStart;
  start.target = request->workflow();
  if (!request->flow().empty()) absl::StrAppend(&start.target, "/", request->flow());
  auto arguments = FromProto(request->variables(), "variables", ports_.limits);
  if (!arguments.ok()) return FinishNow(context, ToGrpc(arguments.status()));
  start.arguments = *std::move(arguments);
  if (absl::Status known = CheckVariables(*ports_.catalog->Get(), start); !known.ok()) {
    return FinishNow(context, ToGrpc(known));
  }
  batch.run_requests.push_back(std::move(start));
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
    if (outcome.ok()) {
      reply->set_revision(outcome->offset);
      if (!outcome->started.empty()) reply->set_run(outcome->started.front().value());
    }
    reactor->Finish(ToGrpc(outcome.status()));
  });
  return reactor;
}

grpc::ServerUnaryReactor* WorkflowsService::Get(grpc::CallbackServerContext* context,
                                                const v1::GetRunRequest* request, v1::Run* reply) {
  const auto trace = TraceOf(*context, ports_.followed);
  const bool known = Traced(trace.get(), [&] {
    const GraphVersionPtr version = ports_.queries->Newest();
    return ReadRun(GraphReader(*ports_.dictionary, *version), request->run(), reply);
  });
  if (!known) {
    return FinishNow(context, grpc::Status(grpc::StatusCode::NOT_FOUND,
                                           absl::StrCat("there is no run \"", request->run(), "\"")));
  }
  FitRun(kTextLimits.shown_text_bytes, reply);
  return FinishNow(context, grpc::Status::OK);
}

grpc::ServerUnaryReactor* WorkflowsService::ListRuns(grpc::CallbackServerContext* context,
                                                     const v1::ListRunsRequest* request,
                                                     v1::ListRunsReply* reply) {
  const auto trace = TraceOf(*context, ports_.followed);
  return OnWorker(ports_, context, [this, request, reply, trace](grpc::ServerUnaryReactor* reactor) {
    reactor->Finish(ToGrpc(Traced(trace.get(), [&] {
      const GraphVersionPtr version = ports_.queries->Newest();
      return ReadRuns(GraphReader(*ports_.dictionary, *version), *request, reply);
    })));
  });
}

}  // namespace docent::server
