// Context.Status: which server this is, how it is, and how much it holds.
#include <algorithm>

#include "graph/base/version.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/unary_reactors.h"

namespace docent::server {
namespace {

const char* NameOf(OnViolation on_violation) {
  switch (on_violation) {
    case OnViolation::kIgnore:
      return "ignore";
    case OnViolation::kWarn:
      return "warn";
    case OnViolation::kRefuse:
      return "refuse";
  }
  return "";
}

void FillGraph(const ServicePorts& ports, v1::StatusReply* reply) {
  const GraphVersionPtr version = ports.queries->Newest();
  const GraphReader graph(*ports.dictionary, *version);
  reply->set_revision(version->revision().value());
  const std::optional<TermId> inferred = ports.dictionary->FindIri(kInferredGraph);
  reply->set_inferred(inferred ? version->Count({{}, {}, {}, *inferred}) : 0);
  reply->set_facts(version->size() - reply->inferred());
  reply->set_graphs(version->graphs().size());
  reply->set_runs(graph.Subjects(kRdfType, Term::Iri(DocentIri("Run"))).size());
  const std::vector<std::string> robots = graph.Subjects(kRdfType, Term::Iri(DocentIri("Robot")));
  reply->set_robots(robots.size());
  const auto offline = std::count_if(robots.begin(), robots.end(), [&graph](const std::string& robot) {
    return graph.Object(robot, DocentIri("status")) == DocentIri("Offline");
  });
  reply->set_robots_offline(static_cast<uint64_t>(offline));
}

void FillDocuments(const Catalog& catalog, v1::StatusReply* reply) {
  for (const ModuleEntry& module : catalog.modules) {
    if (module.kind == Document::Kind::kRules) reply->add_rule_sets(module.name);
    if (module.kind == Document::Kind::kOntology) reply->add_ontologies(module.name);
  }
  reply->set_workflows(catalog.workflows.size());
  reply->set_robot_services(catalog.services.ProcessNames().size());
}

void FillProcess(const ProcessStatus& process, v1::StatusReply* reply) {
  reply->set_grpc_address(process.grpc_address);
  reply->set_http_address(process.http_address);
  reply->set_data_folder(process.data_folder);
  reply->set_uptime_s(process.uptime_s);
  reply->set_log_bytes(process.log_bytes);
  reply->set_live_runs(process.live_runs);
  reply->set_problem(std::string(process.health.message()));
}

}  // namespace

grpc::ServerUnaryReactor* ContextService::Status(grpc::CallbackServerContext* context,
                                                 const v1::StatusRequest*, v1::StatusReply* reply) {
  return OnWorker(ports_, context, [this, reply](grpc::ServerUnaryReactor* reactor) {
    reply->set_version(std::string(Version()));
    reply->set_on_violation(NameOf(ports_.on_violation));
    FillGraph(ports_, reply);
    FillDocuments(*ports_.catalog->Get(), reply);
    if (ports_.process) FillProcess(ports_.process(), reply);
    reactor->Finish(grpc::Status::OK);
  });
}

}  // namespace docent::server
