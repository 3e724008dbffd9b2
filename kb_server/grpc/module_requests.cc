#include "kb_server/grpc/module_requests.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/line_parser.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/text_bytes.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/catalog.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/work/known_prefixes.h"

namespace docent::server {
namespace {

ParseRdfOptions OptionsFor(const v1::LoadRequest& request, const Limits& limits) {
  ParseRdfOptions options;
  options.file = request.name();
  options.base_iri = request.base_iri();
  options.charset = "utf-8";  // as texts of gRPC are
  options.limits = limits;
  options.refuse_graph = RefuseGraph;
  if (request.kind() == v1::LoadRequest::ONTOLOGY) {
    options.blank_node_scope = absl::StrCat(NameInBlankLabel(request.name()), "_");
  } else {
    options.blank_node_scope =
        BlankLabelStart(request.document().empty() ? request.text() : request.document());
  }
  return options;
}

std::optional<RdfFormat> FormatFor(const v1::LoadRequest& request) {
  return FormatOfMediaType(request.media_type().empty() ? "text/turtle" : request.media_type());
}

// The quads of an RDF text, each in `graph` unless the text names one.
absl::Status ParseQuads(const v1::LoadRequest& request, const std::string& graph, const Limits& limits,
                        Cancellation* cancellation, Diagnostics* warnings, MemoryUse* memory,
                        WriteBatch* batch) {
  const auto format = FormatFor(request);
  if (!format) return absl::InvalidArgumentError(UnknownMediaType(request.media_type()));
  if (absl::Status base = CheckBase(request.base_iri()); !base.ok()) return base;
  ParseRdfOptions options = OptionsFor(request, limits);
  options.cancellation = cancellation;
  options.memory = memory;
  absl::Status other_graph;
  const auto fits = [&](size_t bytes) {
    if (memory == nullptr || memory->Add(bytes)) return true;
    other_graph = memory->Refusal(absl::ResourceExhaustedError(
        absl::StrCat(request.name(), ": the text says more than fits into the limit query_memory_bytes = ",
                     limits.query_memory_bytes, "; load it in parts")));
    return false;
  };
  const auto add = [&](TermQuad quad) {
    if (!graph.empty() && !quad.graph.lexical.empty() && quad.graph.lexical != graph) {
      other_graph = absl::InvalidArgumentError(absl::StrCat(
          request.name(), ": the text names the graph ", ToDisplay(quad.graph),
          request.kind() == v1::LoadRequest::ONTOLOGY
              ? ", and a module is one graph; load it as data"
              : "; what is loaded into one graph cannot name others; leave graph (--graph) away"));
      return false;
    }
    if (!graph.empty()) quad.graph = Term::Iri(graph);
    batch->operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    return true;
  };
  if (*format == RdfFormat::kNTriples || *format == RdfFormat::kNQuads) {
    const auto count_and_add = [&](const TermQuad& quad) {
      return fits(2 * sizeof(QuadOperation) + TextBytes(quad)) && add(quad);  // in an array that grows
    };
    const absl::Status status =
        ToStatus(ParseLines(request.text(), *format, options, count_and_add), request.text());
    return status.ok() ? other_graph : status;
  }
  ParsedRdf parsed = ParseRdf(request.text(), *format, options);
  if (!parsed.ok()) return ToStatus(parsed, request.text());
  if (warnings != nullptr) *warnings = parsed.diagnostics;
  for (Document& document : batch->documents) document.text = DeclarePrefixes(parsed.prefixes);
  if (!fits(parsed.quads.size() * sizeof(QuadOperation))) return other_graph;
  batch->operations.reserve(parsed.quads.size());
  for (TermQuad& quad : parsed.quads) {
    if (!add(std::move(quad))) break;
  }
  return other_graph;
}

}  // namespace

bool ReplacesGraph(const v1::LoadRequest& request) {
  return request.kind() == v1::LoadRequest::DATA && request.mode() == v1::LoadRequest::REPLACE;
}

LoadedText TextOf(const v1::LoadRequest& request, const Limits& limits) {
  if (!request.document().empty() || request.kind() == v1::LoadRequest::RULES) return {};
  return {request.name().empty() ? "text" : request.name(), [&request, limits] {
            return ParseLocatedRdf(request.text(), FormatFor(request).value_or(RdfFormat::kTurtle),
                                   OptionsFor(request, limits));
          }};
}

ParseRdfOptions RdfOptionsOf(const v1::AssertRequest& request, const Limits& limits) {
  ParseRdfOptions options;
  options.refuse_graph = RefuseGraph;
  options.file = "rdf";
  options.base_iri = request.rdf_base_iri();
  options.charset = "utf-8";
  options.limits = limits;
  options.blank_node_scope = BlankLabelStart(request.rdf());
  return options;
}

LoadedText TextOf(const v1::AssertRequest& request, const Limits& limits) {
  if (request.rdf().empty()) return {};
  ParseRdfOptions options = RdfOptionsOf(request, limits);
  const RdfFormat format = FormatOfMediaType(request.rdf_media_type()).value_or(RdfFormat::kTurtle);
  return {options.file,
          [&request, format, options] { return ParseLocatedRdf(request.rdf(), format, options); }};
}

absl::StatusOr<WriteBatch> ToLoadBatch(const v1::LoadRequest& request, const Limits& limits,
                                       Cancellation* cancellation, Diagnostics* warnings, MemoryUse* memory) {
  if (absl::Status size = CheckDocumentSize(request.name(), request.text(), limits); !size.ok()) return size;
  if (!v1::LoadRequest::Kind_IsValid(request.kind()) || !v1::LoadRequest::Mode_IsValid(request.mode())) {
    return absl::InvalidArgumentError("this kind or mode is not known; see ontologies.proto");
  }
  if (request.kind() != v1::LoadRequest::DATA) {
    if (const std::optional<std::string> fault = DocumentNameFault(request.name())) {
      return absl::InvalidArgumentError(
          absl::StrCat("the name ", *fault, "; an ontology or rule set is replaced and removed by its name"));
    }
  }
  if (request.kind() == v1::LoadRequest::DATA && request.mode() == v1::LoadRequest::ADD)
    return absl::InvalidArgumentError("data has no name that could be new; leave mode out");
  if (ReplacesGraph(request) && request.graph().empty())
    return absl::InvalidArgumentError("data replaces what one graph holds; name it: graph (--graph)");
  if (ReplacesGraph(request) && !request.document().empty())
    return absl::InvalidArgumentError("a part of a document replaces no graph; leave mode or document out");
  if (std::string why = request.graph().empty() ? "" : RefuseGraph(Term::Iri(request.graph())); !why.empty())
    return absl::InvalidArgumentError(why);
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
      status =
          ParseQuads(request, OntologyGraph(request.name()), limits, cancellation, warnings, memory, &batch);
      break;
    default:
      status = ParseQuads(request, request.graph(), limits, cancellation, warnings, memory, &batch);
      break;
  }
  if (!status.ok()) return status;
  return batch;
}

}  // namespace docent::server
