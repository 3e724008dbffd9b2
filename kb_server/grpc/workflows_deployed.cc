// Workflows: what is deployed and what was; undeploy, disable and enable.
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/door/workflow_removal.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/unary_reactors.h"

namespace docent::server {
namespace {

absl::Status NoWorkflow(const std::string& name, const std::vector<std::string>& known) {
  const std::string near = Nearest(name, known);
  return absl::NotFoundError(absl::StrCat("there is no workflow \"", name, "\"",
                                          near.empty() ? "" : absl::StrCat("; did you mean ", near, "?")));
}

absl::Status CheckDeployed(const Catalog& catalog, const std::string& name) {
  if (catalog.FindWorkflow(name) != nullptr) return absl::OkStatus();
  std::vector<std::string> known;
  for (const auto& [document, revision] : catalog.workflows) known.push_back(document->name.value);
  return NoWorkflow(name, known);
}

bool Invokes(const cawl::Document& document, const std::string& workflow) {
  for (const cawl::Flow& flow : document.flows) {
    for (const cawl::Node& node : flow.nodes) {
      for (const cawl::Invoke& invoke : node.invokes) {
        const std::string& name = invoke.subflow.value;
        if (name.empty() || document.FindFlow(name) != nullptr) continue;
        for (const auto& [target, flow_name] : cawl::StartTargets(name)) {
          if (target == workflow) return true;
        }
      }
    }
  }
  return false;
}

// Names of the other deployed workflows that invoke it.
std::vector<std::string> InvokedBy(const Catalog& catalog, const std::string& workflow) {
  std::vector<std::string> names;
  for (const auto& [document, revision] : catalog.workflows) {
    if (document->name.value != workflow && Invokes(*document, workflow))
      names.push_back(document->name.value);
  }
  return names;
}

void ToProto(const RunPorts& ports, const Catalog& catalog, const cawl::DocumentPtr& document,
             Revision revision, const GraphVersion& graph, v1::Workflow* out) {
  const std::string& name = document->name.value;
  out->set_name(name);
  out->set_version(document->version.value);
  for (const cawl::Flow& flow : document->flows) out->add_flows(flow.name.value);
  if (document->activator) out->set_activated_flow(document->activator->flow.value);
  out->set_revision(revision.value());
  out->set_disabled(catalog.disabled_workflows.contains(name));
  const GraphReader reader(*ports.dictionary, graph);
  out->set_paused(!reader.In(kRunsGraph).Object(WorkflowIri(name), DocentIri("pausedAt")).empty());
  out->set_live_runs(LiveRunsOf(reader, name));
  if (const DocumentVersionsPtr versions = catalog.versions.Find({Document::Kind::kCawl, name}))
    out->set_deployed_version(versions->newest().number);
}

}  // namespace

grpc::ServerUnaryReactor* WorkflowsService::List(grpc::CallbackServerContext* context,
                                                 const v1::ListWorkflowsRequest*,
                                                 v1::ListWorkflowsReply* reply) {
  const std::shared_ptr<const Catalog> catalog = ports_.catalog->Get();
  const GraphVersionPtr version = ports_.queries->Newest();
  for (const auto& [document, revision] : catalog->workflows)
    ToProto(ports_, *catalog, document, revision, *version, reply->add_workflows());
  return FinishNow(context, grpc::Status::OK);
}

grpc::ServerUnaryReactor* WorkflowsService::Undeploy(grpc::CallbackServerContext* context,
                                                     const v1::UndeployRequest* request,
                                                     v1::UndeployReply* reply) {
  if (absl::Status known = CheckDeployed(*ports_.catalog->Get(), request->workflow()); !known.ok())
    return FinishNow(context, ToGrpc(known));
  WriteBatch batch;
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, request->workflow(),
                             request->cancel_runs() ? kRemovesRuns : ""});
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(std::move(batch), [this, reactor, reply, name = request->workflow()](
                                           const absl::StatusOr<BatchOutcome>& outcome) {
    if (outcome.ok()) {
      reply->set_revision(outcome->offset);
      reply->set_cancelled_runs(static_cast<uint32_t>(outcome->cancelled_runs));
      for (std::string& by : InvokedBy(*ports_.catalog->Get(), name)) reply->add_invoked_by(std::move(by));
    }
    reactor->Finish(ToGrpc(outcome.status()));
  });
  return reactor;
}

grpc::ServerUnaryReactor* WorkflowsService::SetEnabled(grpc::CallbackServerContext* context,
                                                       const v1::SetEnabledRequest* request,
                                                       v1::Workflow* reply) {
  if (absl::Status known = CheckDeployed(*ports_.catalog->Get(), request->workflow()); !known.ok())
    return FinishNow(context, ToGrpc(known));
  WriteBatch batch;
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, request->workflow(),
                             request->enabled() ? kRemovesDisablement : kRemovesStarts});
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(std::move(batch), [this, reactor, reply, name = request->workflow()](
                                           const absl::StatusOr<BatchOutcome>& outcome) {
    if (outcome.ok()) {
      const std::shared_ptr<const Catalog> catalog = ports_.catalog->Get();
      const GraphVersionPtr version = ports_.queries->Newest();
      for (const auto& [document, revision] : catalog->workflows) {
        if (document->name.value == name) ToProto(ports_, *catalog, document, revision, *version, reply);
      }
    }
    reactor->Finish(ToGrpc(outcome.status()));
  });
  return reactor;
}

grpc::ServerUnaryReactor* WorkflowsService::ListVersions(grpc::CallbackServerContext* context,
                                                         const v1::ListVersionsRequest* request,
                                                         v1::ListVersionsReply* reply) {
  const std::shared_ptr<const Catalog> catalog = ports_.catalog->Get();
  const DocumentVersionsPtr versions = catalog->versions.Find({Document::Kind::kCawl, request->workflow()});
  if (versions == nullptr) {
    std::vector<std::string> known;
    for (const auto& [key, document] : catalog->versions.all()) {
      if (key.first == Document::Kind::kCawl) known.push_back(key.second);
    }
    return FinishNow(context, ToGrpc(NoWorkflow(request->workflow(), known)));
  }
  for (const DocumentVersionPtr& version : versions->kept) {
    v1::DeployedVersion* out = reply->add_versions();
    out->set_number(version->number);
    out->set_version(version->own_version);
    out->set_revision(version->revision.value());
    out->set_time_us(version->time_us);
    out->set_live(versions->live && version == versions->kept.back());
    if (request->with_texts()) out->set_text(version->text);
  }
  return FinishNow(context, grpc::Status::OK);
}

}  // namespace docent::server
