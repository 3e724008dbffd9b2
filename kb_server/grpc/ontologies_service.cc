// Ontologies: modules, rule sets and data files.
#include <algorithm>
#include <chrono>
#include <optional>

#include "absl/strings/str_cat.h"
#include "graph/base/cancellation.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/module_requests.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/load_runner.h"
#include "kb_server/work/rule_change.h"
#include "kb_server/work/update_runner.h"

namespace docent::server {
namespace {

constexpr uint32_t kMostShown = 10000;  // facts of each kind in one preview

void Fill(const BatchOutcome& outcome, v1::LoadReply* reply) {
  reply->set_revision(outcome.offset);
  reply->set_added(outcome.added);
  reply->set_removed(outcome.removed);
  reply->set_inferred(outcome.inferred);
  for (const Diagnostic& warning : outcome.warnings) ToProto(warning, reply->add_diagnostics());
}

// DROP of the graph, then LOAD of the batch's quads: evaluated beside the writer, and one turn.
UpdateRequest ReplaceGraph(const Term& graph, WriteBatch batch) {
  UpdateRequest request;
  std::vector<sparql::UpdateOperation>& operations = request.update.operations;
  for (const auto kind : {sparql::UpdateOperation::Kind::kDrop, sparql::UpdateOperation::Kind::kLoad}) {
    sparql::UpdateOperation& operation = operations.emplace_back();
    operation.kind = kind;
    operation.silent = kind == sparql::UpdateOperation::Kind::kDrop;
    const bool is_default = graph.lexical == kDefaultGraph;
    operation.target = {is_default ? sparql::GraphTarget::Kind::kDefault : sparql::GraphTarget::Kind::kGraph,
                        graph};
  }
  auto quads = std::make_shared<std::vector<TermQuad>>();
  for (QuadOperation& operation : batch.operations) {
    operation.quad.graph = Term();
    quads->push_back(std::move(operation.quad));
  }
  request.load = [triples = sparql::DocumentQuads(std::move(quads))](
                     const std::string&) -> absl::StatusOr<sparql::DocumentQuads> { return triples; };
  return request;
}

// Whether there is a module of that name, on the writer's turn, when that is exact. A graph that was filled otherwise
// counts, too.
BatchPreparation CheckMode(const v1::LoadRequest& request, const ReadPorts& ports) {
  if (request.mode() == v1::LoadRequest::PUT || request.kind() == v1::LoadRequest::DATA) return nullptr;
  return [name = request.name(), kind = request.kind(), mode = request.mode(), &ports](
             const TurnView& view, WriteBatch*) -> absl::Status {
    const bool rules = kind == v1::LoadRequest::RULES;
    bool there = view.has_document(rules ? Document::Kind::kRules : Document::Kind::kOntology, name);
    if (const auto graph = ports.dictionary->FindIri(OntologyGraph(name)); graph && !rules)
      there = there || view.graph.Count({{}, {}, {}, *graph}) > 0;
    if (mode == v1::LoadRequest::ADD && there) {
      return absl::AlreadyExistsError(absl::StrCat("there is a module \"", name,
                                                   "\" already; replace it, or name the new one otherwise"));
    }
    if (mode == v1::LoadRequest::REPLACE && !there) {
      return absl::NotFoundError(absl::StrCat("there is no module \"", name, "\" to replace"));
    }
    return absl::OkStatus();
  };
}

// The imports of a module that nothing in the graph is.
void FillMissingImports(const GraphVersion& version, const Dictionary& dictionary, TermId graph, TermId type,
                        TermId ontology, v1::ListOntologiesReply::Module* out) {
  const auto imports = dictionary.FindIri(absl::StrCat(std::string(kOwlNs), "imports"));
  if (!imports) return;
  const auto version_iri = dictionary.FindIri(absl::StrCat(std::string(kOwlNs), "versionIRI"));
  for (QuadCursor found = version.Scan({{}, *imports, {}, graph}); found.Valid(); found.Next()) {
    const TermId imported = found.quad().object;
    const bool there = version.Count({imported, type, ontology, {}}) > 0 ||
                       (version_iri && version.Count({{}, *version_iri, imported, {}}) > 0);
    if (!there) out->add_missing_imports(dictionary.Decode(imported).lexical);
  }
}

// What a module says of itself, from its graph.
void FillVersion(const GraphVersion& version, const Dictionary& dictionary,
                 v1::ListOntologiesReply::Module* out) {
  const auto graph = dictionary.FindIri(OntologyGraph(out->name()));
  const auto type = dictionary.FindIri(kRdfType),
             ontology = dictionary.FindIri(absl::StrCat(std::string(kOwlNs), "Ontology"));
  if (!graph || !type || !ontology) return;
  QuadCursor found = version.Scan({{}, *type, *ontology, *graph});
  if (!found.Valid()) return;
  const TermId subject = found.quad().subject;
  const auto text_of = [&](const char* word) -> std::string {
    const auto property = dictionary.FindIri(absl::StrCat(std::string(kOwlNs), word));
    if (!property) return "";
    QuadCursor cursor = version.Scan({subject, *property, {}, *graph});
    return cursor.Valid() ? dictionary.Decode(cursor.quad().object).lexical : "";
  };
  out->set_ontology(dictionary.Decode(subject).lexical);
  out->set_version_iri(text_of("versionIRI"));
  out->set_version_info(text_of("versionInfo"));
  FillMissingImports(version, dictionary, *graph, *type, *ontology, out);
}

}  // namespace

grpc::ServerUnaryReactor* OntologiesService::Load(grpc::CallbackServerContext* context,
                                                  const v1::LoadRequest* request, v1::LoadReply* reply) {
  auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  const ClientPtr client = ClientOf(*context, ports_.clients);
  const auto work = [this, client, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    Diagnostics of_text;
    const std::shared_ptr<MemoryUse> memory = MemoryOfRequest(ports_);
    absl::StatusOr<WriteBatch> batch = [&] {
      const WorkerPool::SharedWork shared(ports_.workers, cancellation.get());
      return ToLoadBatch(*request, ports_.limits, cancellation.get(), &of_text, memory.get());
    }();
    if (!batch.ok()) return reactor->Finish(ToGrpc(batch.status()));
    LoadCallback done = [reactor, reply, memory, of_text = std::move(of_text)](
                            const absl::StatusOr<BatchOutcome>& outcome, const Diagnostics& warnings) {
      if (outcome.ok()) Fill(*outcome, reply);
      for (const Diagnostic& warning : of_text) ToProto(warning, reply->add_diagnostics());
      for (const Diagnostic& warning : warnings) ToProto(warning, reply->add_diagnostics());
      reactor->Finish(ToGrpc(outcome.status()));
    };
    if (ReplacesGraph(*request)) {
      UpdateRequest update = ReplaceGraph(Term::Iri(request->graph()), *std::move(batch));
      update.text = TextOf(*request, ports_.limits);
      update.cancellation = cancellation;
      update.client = client;
      update.timeout = absl::Milliseconds(ports_.limits.query_timeout_ms);
      return ports_.updates->Submit(
          std::move(update), [done](const absl::StatusOr<BatchOutcome>& outcome) { done(outcome, {}); });
    }
    LoadJob job;
    job.batch = *std::move(batch);
    job.text = TextOf(*request, ports_.limits);
    job.prepare = CheckMode(*request, ports_);
    job.cancellation = cancellation;
    job.done = std::move(done);
    ports_.loads->Run(std::move(job));
  };
  return OnWorker(ports_, context, cancellation, work);
}

grpc::ServerUnaryReactor* OntologiesService::List(grpc::CallbackServerContext* context,
                                                  const v1::ListOntologiesRequest*,
                                                  v1::ListOntologiesReply* reply) {
  return OnWorker(ports_, context, [this, reply](grpc::ServerUnaryReactor* reactor) {
    const GraphVersionPtr version = ports_.queries->Newest();
    const auto catalog = ports_.catalog->Get();
    for (const ModuleEntry& module : catalog->modules) {
      auto* out = reply->add_modules();
      out->set_name(module.name);
      out->set_kind(module.kind == Document::Kind::kRules ? v1::LoadRequest::RULES
                                                          : v1::LoadRequest::ONTOLOGY);
      out->set_size(module.size);
      out->set_revision(module.revision.value());
      if (module.kind == Document::Kind::kOntology) FillVersion(*version, *ports_.dictionary, out);
    }
    reactor->Finish(grpc::Status::OK);
  });
}

grpc::ServerUnaryReactor* OntologiesService::Prefixes(grpc::CallbackServerContext* context,
                                                      const v1::PrefixesRequest*, v1::PrefixesReply* reply) {
  return OnWorker(ports_, context, [this, reply](grpc::ServerUnaryReactor* reactor) {
    const auto names = ports_.prefixes->Get();
    for (const auto& [prefix, name_space] : names->prefixes()) {
      v1::PrefixesReply::Prefix* out = reply->add_prefixes();
      out->set_name(prefix);
      out->set_namespace_(name_space);
    }
    reactor->Finish(grpc::Status::OK);
  });
}

grpc::ServerUnaryReactor* OntologiesService::Remove(grpc::CallbackServerContext* context,
                                                    const v1::RemoveOntologyRequest* request,
                                                    v1::LoadReply* reply) {
  Document::Kind kind =
      request->kind() == v1::LoadRequest::RULES ? Document::Kind::kRules : Document::Kind::kOntology;
  if (request->kind() == v1::LoadRequest::DATA) {
    return FinishNow(context,
                     grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "data is removed with Context.Assert"));
  }
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.documents.push_back({kind, Document::Action::kRemove, request->name(), ""});
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  BringJudged(ports_, std::move(batch), {}, nullptr, /*made_on_turn=*/false,
              ClientOf(*context, ports_.clients),
              [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
                if (outcome.ok()) Fill(*outcome, reply);
                reactor->Finish(ToGrpc(outcome.status()));
              });
  return reactor;
}

grpc::ServerUnaryReactor* OntologiesService::PreviewRules(grpc::CallbackServerContext* context,
                                                          const v1::PreviewRulesRequest* request,
                                                          v1::PreviewRulesReply* reply) {
  auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  const auto work = [this, cancellation, request, reply](grpc::ServerUnaryReactor* reactor) {
    if (absl::Status size = CheckDocumentSize(request->name(), request->text(), ports_.limits); !size.ok())
      return reactor->Finish(ToGrpc(size));
    if (const auto fault = DocumentNameFault(request->name()); fault && !request->remove()) {
      return reactor->Finish(ToGrpc(absl::InvalidArgumentError(
          absl::StrCat("the name of the rule set ", *fault, "; name it otherwise"))));
    }
    const WorkerPool::SharedWork shared(ports_.workers, cancellation.get());
    std::optional<std::string> text;
    if (!request->remove()) text = request->text();
    const auto change = PreviewRuleChange(ports_, request->name(), text,
                                          std::min(request->shown(), kMostShown), cancellation.get());
    if (!change.ok()) return reactor->Finish(ToGrpc(change.status()));
    const rules::RulePreview& facts = change->facts;
    reply->set_revision(change->revision.value());
    reply->set_added(facts.added);
    reply->set_removed(facts.removed);
    for (const std::string& triple : facts.added_triples) reply->add_added_triples(triple);
    for (const std::string& triple : facts.removed_triples) reply->add_removed_triples(triple);
    reactor->Finish(grpc::Status::OK);
  };
  return OnWorker(ports_, context, cancellation, work);
}

}  // namespace docent::server
