// Ontologies.Validate and Ontologies.Check: SHACL on the newest version, and on what it would be after a load.
#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/store/graph_writer.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/module_requests.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/grpc/validation_proto.h"
#include "kb_server/work/load_judge.h"
#include "kb_server/work/rule_change.h"
#include "reasoner/shapes/shape_reader.h"
#include "reasoner/shapes/source_map.h"
#include "reasoner/shapes/validator.h"

namespace docent::server {
namespace {

// The shapes of a request's texts, in a graph of their own. Its dictionary knows the server's terms.
struct GivenShapes {
  explicit GivenShapes(const Dictionary* base) : dictionary(base), writer(nullptr) {}
  Dictionary dictionary;
  GraphWriter writer;
  shapes::SourceMap places;
};

// `memory` counts what is kept.
absl::Status ReadTexts(const v1::ValidateRequest& request, const Limits& limits, Cancellation* cancellation,
                       MemoryUse* memory, GivenShapes* given) {
  constexpr size_t kCopies = 2;  // of a quad: where it stands, and in the graph, its indexes included
  const TermId graph = given->dictionary.InternIri("urn:docent:shapes");
  int number = 0;
  for (const v1::ShapesText& text : request.shapes()) {
    if (absl::Status size = CheckDocumentSize(text.name(), text.text(), limits); !size.ok()) return size;
    const std::string media_type = text.media_type().empty() ? "text/turtle" : text.media_type();
    const auto format = FormatOfMediaType(media_type);
    if (!format) return absl::InvalidArgumentError(UnknownMediaType(media_type));
    if (absl::Status base = CheckBase(text.base_iri()); !base.ok()) return base;
    ParseRdfOptions options;
    options.file = text.name();
    options.base_iri = text.base_iri();
    options.charset = "utf-8";
    options.limits = limits;
    options.cancellation = cancellation;
    options.memory = memory;
    options.blank_node_scope = absl::StrCat("shapes", number++, "_");
    const LocatedRdf document = ParseLocatedRdf(text.text(), *format, options);
    if (!document.rdf.ok()) return ToStatus(document.rdf, text.text());
    if (!memory->Add(kCopies * document.rdf.quads.size() * sizeof(TermQuad))) {
      return memory->Refusal(absl::ResourceExhaustedError(
          absl::StrCat(text.name(), ": the shapes are more than fit into the limit query_memory_bytes = ",
                       limits.query_memory_bytes, "; give fewer at a time")));
    }
    for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
      const TermQuad& q = document.rdf.quads[i];
      const Quad quad{given->dictionary.Intern(q.subject), given->dictionary.Intern(q.predicate),
                      given->dictionary.Intern(q.object), graph};
      given->writer.Add(quad);
      given->places.Add(quad, {text.name(), document.places[i].subject},
                        {text.name(), document.places[i].object});
    }
  }
  return absl::OkStatus();
}

// As much of the report as fits into half a message.
absl::Status Fill(const shapes::ValidationReport& report, const Dictionary& dictionary,
                  const shapes::SourceMap& shape_places, bool rdf, const Limits& limits,
                  v1::ValidateReply* reply) {
  reply->set_conforms(report.conforms());
  reply->set_total(report.total);
  reply->set_focus_nodes(report.focus_nodes);
  reply->set_summary(shapes::Summary(report, dictionary));
  const size_t room = limits.grpc_message_bytes / 2;
  size_t bytes = 0;
  if (rdf) {
    for (const TermQuad& triple : shapes::ToRdf(report, dictionary)) {
      v1::Quad* out = reply->add_report();
      docent::ToProto(triple, out);
      bytes += out->ByteSizeLong();
      if (bytes > room) {
        return absl::ResourceExhaustedError(
            absl::StrCat("the report as RDF is larger than half of the limit grpc_message_bytes = ",
                         limits.grpc_message_bytes, "; ask for it as text"));
      }
    }
    return absl::OkStatus();
  }
  for (const shapes::ValidationResult& result : report.results) {
    v1::ValidationResult* out = reply->add_results();
    const Term value = shapes::ValueOf(result, dictionary).value_or(Term());
    ToProto(shapes::Describe(result, dictionary, nullptr, &shape_places), dictionary.Decode(result.focus),
            value, dictionary.Decode(result.shape), out);
    bytes += out->ByteSizeLong();
    if (bytes > room) {
      reply->mutable_results()->RemoveLast();
      break;
    }
  }
  return absl::OkStatus();
}

absl::Status Validate(const RunPorts& ports, const v1::ValidateRequest& request, Cancellation* cancellation,
                      v1::ValidateReply* reply) {
  const GraphVersionPtr version = ports.queries->Newest();
  GivenShapes given(ports.dictionary);  // it knows the terms of the version
  const std::shared_ptr<MemoryUse> memory = MemoryOfRequest(ports);
  if (absl::Status status = ReadTexts(request, ports.limits, cancellation, memory.get(), &given);
      !status.ok())
    return status;
  const bool own = request.shapes().empty();
  Dictionary& dictionary = given.dictionary;
  const shapes::GraphView graph = own ? shapes::GraphView(*version, ModuleGraphs(*version, dictionary))
                                      : shapes::GraphView(given.writer.current());
  const shapes::ParsedShapes parsed =
      shapes::ReadShapes(graph, dictionary, {}, &given.places, ports.functions,
                         {RegimesOf(ports), Diagnostic::Severity::kError});
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, "");
  if (!parsed.shapes.HasTargets()) {
    return absl::InvalidArgumentError(
        own ? "no shape is loaded that has a target; load one as an ontology, or give shapes"
            : "no shape has a target: give them sh:targetClass, sh:targetNode, "
              "sh:targetSubjectsOf, sh:targetObjectsOf or sh:target");
  }
  for (const Diagnostic& diagnostic : parsed.diagnostics)
    server::ToProto(diagnostic, reply->add_diagnostics());
  const shapes::ValidateOptions options = ValidateOptionsOf(ports, cancellation);
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  auto report = shapes::Validate(parsed.shapes, shapes::GraphView(*version), dictionary, options);
  if (!report.ok()) return report.status();
  reply->set_revision(version->revision().value());
  return Fill(*report, dictionary, given.places, request.rdf(), ports.limits, reply);
}

absl::Status Check(const RunPorts& ports, const v1::LoadRequest& request, Cancellation* cancellation,
                   v1::CheckModuleReply* reply) {
  const std::shared_ptr<MemoryUse> memory = MemoryOfRequest(ports);
  absl::StatusOr<WriteBatch> batch = ToLoadBatch(request, ports.limits, cancellation, nullptr, memory.get());
  if (!batch.ok()) return batch.status();
  const GraphVersionPtr version = ports.queries->Newest();
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  RuleTexts rules;
  const auto catalog = ports.catalog->Get();
  for (const ModuleEntry& module : catalog->modules) {
    if (module.kind == Document::Kind::kRules && module.text != nullptr)
      rules.push_back({module.name, *module.text});
  }
  auto verdict = JudgeLoad(ports, *batch, *version, TextOf(request, ports.limits), rules, cancellation);
  if (!verdict.ok()) return verdict.status();
  reply->set_revision(version->revision().value());
  reply->set_conforms(!verdict->HasViolations());
  for (const Diagnostic& diagnostic : verdict->diagnostics)
    server::ToProto(diagnostic, reply->add_diagnostics());
  size_t bytes = 0;
  for (const JudgedResult& result : verdict->results) {
    v1::ValidationResult* out = reply->add_results();
    ToProto(result.text, result.focus, result.value, result.shape, out);
    bytes += out->ByteSizeLong();
    if (bytes > ports.limits.grpc_message_bytes / 2) {
      reply->mutable_results()->RemoveLast();
      break;
    }
  }
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* OntologiesService::Validate(grpc::CallbackServerContext* context,
                                                      const v1::ValidateRequest* request,
                                                      v1::ValidateReply* reply) {
  int timeout_ms = ports_.limits.query_timeout_ms;
  if (request->timeout_ms() > 0) timeout_ms = std::min<int64_t>(timeout_ms, request->timeout_ms());
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(timeout_ms));
  const auto validate = [this, request, reply, cancellation](grpc::ServerUnaryReactor* reactor) {
    reactor->Finish(ToGrpc(server::Validate(ports_, *request, cancellation.get(), reply)));
  };
  return OnWorker(ports_, context, cancellation, validate, Revision(request->min_revision()));
}

grpc::ServerUnaryReactor* OntologiesService::Check(grpc::CallbackServerContext* context,
                                                   const v1::LoadRequest* request,
                                                   v1::CheckModuleReply* reply) {
  auto cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  const auto check = [this, request, reply, cancellation](grpc::ServerUnaryReactor* reactor) {
    reactor->Finish(ToGrpc(server::Check(ports_, *request, cancellation.get(), reply)));
  };
  return OnWorker(ports_, context, cancellation, check);
}

}  // namespace docent::server
