// Ontologies: modules, rule sets and data files.
#include "absl/strings/str_cat.h"
#include "kb_server/rdf/line_parser.h"
#include "kb_server/rdf/parser.h"
#include "kb_server/service/convert.h"
#include "kb_server/service/grpc_services.h"

namespace docent {
namespace {

grpc::ServerUnaryReactor* Finish(grpc::CallbackServerContext* context, const grpc::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(status);
  return reactor;
}

void Fill(const BatchOutcome& outcome, v1::LoadReply* reply) {
  reply->set_revision(outcome.offset);
  reply->set_added(outcome.added);
  reply->set_removed(outcome.removed);
  reply->set_inferred(outcome.inferred);
}

// The quads of an RDF text, each in `graph` unless the text names one.
absl::Status ParseQuads(const v1::LoadRequest& request, const std::string& graph, const Limits& limits,
                        WriteBatch* batch) {
  std::string media_type = request.media_type().empty() ? "text/turtle" : request.media_type();
  auto format = FormatOfMediaType(media_type);
  if (!format)
    return absl::InvalidArgumentError(absl::StrCat("media type \"", media_type, "\" is not known"));
  ParseRdfOptions options;
  options.file = request.name();
  options.limits = limits;
  options.blank_node_scope = absl::StrCat(request.name(), "_");
  const auto add = [&](TermQuad quad) {
    if (quad.graph.lexical.empty() && !graph.empty()) quad.graph = Term::Iri(graph);
    batch->operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    return true;
  };
  if (*format == RdfFormat::kNTriples || *format == RdfFormat::kNQuads) {
    return ToStatus(ParseLines(request.text(), *format, options, add), request.text());
  }
  ParsedRdf parsed = ParseRdf(request.text(), *format, options);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, request.text());
  batch->operations.reserve(parsed.quads.size());
  for (TermQuad& quad : parsed.quads) add(std::move(quad));
  return absl::OkStatus();
}

absl::StatusOr<WriteBatch> ToBatch(const v1::LoadRequest& request, const Limits& limits) {
  if (absl::Status size = CheckDocumentSize(request.name(), request.text(), limits); !size.ok()) return size;
  if (request.name().empty() && request.kind() != v1::LoadRequest::DATA) {
    return absl::InvalidArgumentError(
        "name is empty; an ontology or rule set is replaced and removed by its name");
  }
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  absl::Status status;
  switch (request.kind()) {
    case v1::LoadRequest::RULES:
      batch.documents.push_back(
          {Document::Kind::kRules, Document::Action::kPut, request.name(), request.text()});
      break;
    case v1::LoadRequest::ONTOLOGY:
      batch.documents.push_back({Document::Kind::kOntology, Document::Action::kPut, request.name(), ""});
      status = ParseQuads(request, OntologyGraph(request.name()), limits, &batch);
      break;
    default:
      status = ParseQuads(request, request.graph(), limits, &batch);
      break;
  }
  if (!status.ok()) return status;
  return batch;
}

}  // namespace

std::string OntologyGraph(const std::string& name) {
  return absl::StrCat("https://w3id.org/docent/ontology/", name);
}

grpc::ServerUnaryReactor* OntologiesService::Load(grpc::CallbackServerContext* context,
                                                  const v1::LoadRequest* request, v1::LoadReply* reply) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  bool accepted = ports_.workers->Submit([this, reactor, request, reply] {
    absl::StatusOr<WriteBatch> batch = ToBatch(*request, ports_.limits);
    if (!batch.ok()) return reactor->Finish(ToGrpc(batch.status()));
    ports_.inbox->Push(*std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) Fill(*outcome, reply);
      reactor->Finish(ToGrpc(outcome.status()));
    });
  });
  if (!accepted)
    reactor->Finish(grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "too much work waits; try again"));
  return reactor;
}

grpc::ServerUnaryReactor* OntologiesService::List(grpc::CallbackServerContext* context,
                                                  const v1::ListOntologiesRequest*,
                                                  v1::ListOntologiesReply* reply) {
  for (const ModuleEntry& module : ports_.catalog->Get()->modules) {
    auto* out = reply->add_modules();
    out->set_name(module.name);
    out->set_kind(module.kind == Document::Kind::kRules ? v1::LoadRequest::RULES : v1::LoadRequest::ONTOLOGY);
    out->set_size(module.size);
    out->set_revision(module.revision.value());
  }
  return Finish(context, grpc::Status::OK);
}

grpc::ServerUnaryReactor* OntologiesService::Remove(grpc::CallbackServerContext* context,
                                                    const v1::RemoveOntologyRequest* request,
                                                    v1::LoadReply* reply) {
  Document::Kind kind =
      request->kind() == v1::LoadRequest::RULES ? Document::Kind::kRules : Document::Kind::kOntology;
  if (request->kind() == v1::LoadRequest::DATA) {
    return Finish(context,
                  grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "data is removed with Context.Assert"));
  }
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.documents.push_back({kind, Document::Action::kRemove, request->name(), ""});
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  ports_.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
    if (outcome.ok()) Fill(*outcome, reply);
    reactor->Finish(ToGrpc(outcome.status()));
  });
  return reactor;
}

}  // namespace docent
