#include "kb_server/grpc/convert.h"

#include <optional>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "graph/base/memory_budget.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/text_bytes.h"
#include "graph/store/server_graphs.h"
#include "graph/wire/message_bytes.h"
#include "kb_server/grpc/module_requests.h"
#include "kb_server/robots/measures.h"

namespace docent::server {
namespace {

absl::Status CheckIri(std::string_view iri, const std::string& what) {
  if (IsValidTermIri(iri)) return absl::OkStatus();
  return absl::InvalidArgumentError(Concat(what, ": \"", iri, "\" is not an absolute IRI"));
}

}  // namespace

void ToProto(const Diagnostic& diagnostic, v1::Diagnostic* out) {
  out->set_file(diagnostic.file);
  out->set_line(diagnostic.span.line);
  out->set_column(diagnostic.span.column);
  out->set_message(diagnostic.message);
  out->set_hint(diagnostic.hint);
  out->set_warning(diagnostic.severity == Diagnostic::Severity::kWarning);
  out->set_rule(diagnostic.rule);
  for (const TextEdit& edit : diagnostic.fix) {
    v1::TextEdit* fix = out->add_fix();
    fix->set_offset(edit.offset);
    fix->set_length(edit.length);
    fix->set_replacement(edit.replacement);
  }
}

void ToProto(const BatchOutcome& outcome, v1::AssertReply* out) {
  out->set_offset(outcome.offset);
  out->set_added(outcome.added);
  out->set_removed(outcome.removed);
  out->set_inferred(outcome.inferred);
  out->set_repeated(outcome.repeated);
  for (const Diagnostic& warning : outcome.warnings) ToProto(warning, out->add_warnings());
}

absl::StatusOr<Term> FromProto(const v1::Term& term, const std::string& what, const Limits& limits) {
  std::optional<Term> out = FromProto(term);
  if (!out) return absl::InvalidArgumentError(absl::StrCat(what, " is not set; give iri, blank or literal"));
  if (absl::Status status = CheckTerm(*out, limits.term_bytes); !status.ok())
    return WithMessage(status, absl::StrCat(what, ": ", status.message()));
  return *std::move(out);
}

absl::StatusOr<TermQuad> FromProto(const v1::Quad& quad, const std::string& what, const Limits& limits) {
  TermQuad out;
  auto subject = FromProto(quad.subject(), what + ".subject", limits);
  if (!subject.ok()) return subject.status();
  auto predicate = FromProto(quad.predicate(), what + ".predicate", limits);
  if (!predicate.ok()) return predicate.status();
  auto object = FromProto(quad.object(), what + ".object", limits);
  if (!object.ok()) return object.status();
  out.subject = *std::move(subject);
  out.predicate = *std::move(predicate);
  out.object = *std::move(object);
  if (quad.has_graph() && quad.graph().kind_case() != v1::Term::KIND_NOT_SET) {
    auto graph = FromProto(quad.graph(), what + ".graph", limits);
    if (!graph.ok()) return graph.status();
    out.graph = *std::move(graph);
  }
  return out;
}

absl::Status CheckRobotIri(const std::string& robot, const std::string& what, const Limits& limits) {
  v1::Term term;
  term.set_iri(robot);
  return FromProto(term, what, limits).status();
}

uint64_t DigestOf(const std::string& request_id, const google::protobuf::Message& request) {
  if (request_id.empty()) return 0;
  return RequestDigest(request.GetDescriptor()->name(), {StableBytes(request)});
}

absl::Status CheckBase(const std::string& base_iri) {
  return base_iri.empty() ? absl::OkStatus() : CheckIri(base_iri, "base_iri");
}

absl::StatusOr<WriteBatch> FromProto(const v1::AssertRequest& request, const Limits& limits,
                                     Cancellation* cancellation, MemoryUse* memory) {
  if (absl::Status id = CheckRequestId(request.request_id()); !id.ok()) return id;
  if (!request.source().empty()) {
    if (absl::Status source = CheckIri(request.source(), "source"); !source.ok()) return source;
  }
  const bool only_removes = request.add_size() == 0 && request.rdf().empty() && request.readings_size() == 0;
  const Term source_graph = Term::Iri(request.source());
  if (const std::string why = only_removes ? RefuseRemoval(source_graph) : RefuseGraph(source_graph);
      !why.empty())
    return absl::InvalidArgumentError(absl::StrCat("source: ", why));
  if (!v1::AssertRequest::Mode_IsValid(request.mode())) {
    return absl::InvalidArgumentError(
        absl::StrCat("mode ", static_cast<int>(request.mode()), " is not known; give ASSERT or LOAD"));
  }
  if (request.mode() == v1::AssertRequest::LOAD && request.lifetime_ms() > 0) {
    return absl::InvalidArgumentError("lifetime_ms goes with the mode ASSERT alone: what is loaded stays");
  }
  WriteBatch batch;
  batch.request_id = request.request_id();
  batch.request_digest = DigestOf(request.request_id(), request);
  batch.source = request.source();
  batch.mode =
      request.mode() == v1::AssertRequest::LOAD ? WriteBatch::Mode::kLoad : WriteBatch::Mode::kAssert;
  batch.lifetime_ms = request.lifetime_ms();
  batch.operations.reserve(request.remove_size() + request.add_size());
  const auto count = [memory, &limits](size_t bytes) {
    if (memory == nullptr || memory->Add(bytes)) return absl::OkStatus();
    return memory->Refusal(absl::ResourceExhaustedError(absl::StrCat(
        "the batch says more than fits into the limit query_memory_bytes = ", limits.query_memory_bytes,
        "; send it in parts")));
  };
  const auto measured = [&batch](const TermQuad& quad, const std::string& what) {
    if (batch.mode != WriteBatch::Mode::kAssert) return absl::OkStatus();
    return CheckMeasure(quad.predicate.lexical, quad.object, what);
  };
  auto append = [&](const v1::Quad& quad, QuadOperation::Kind kind, const std::string& what) {
    absl::StatusOr<TermQuad> out = FromProto(quad, what, limits);
    if (!out.ok()) return out.status();
    const bool adds = kind == QuadOperation::Kind::kAdd;
    if (const std::string why = adds ? RefuseGraph(out->graph) : RefuseRemoval(out->graph); !why.empty())
      return absl::InvalidArgumentError(absl::StrCat(what, ".graph: ", why));
    if (adds) {
      if (absl::Status status = measured(*out, what); !status.ok()) return status;
    }
    if (absl::Status room = count(sizeof(QuadOperation) + TextBytes(*out)); !room.ok()) return room;
    batch.operations.push_back({kind, *std::move(out)});
    return absl::OkStatus();
  };
  for (int i = 0; i < request.remove_size(); ++i) {
    absl::Status status =
        append(request.remove(i), QuadOperation::Kind::kRemove, absl::StrCat("remove[", i, "]"));
    if (!status.ok()) return status;
  }
  for (int i = 0; i < request.add_size(); ++i) {
    absl::Status status = append(request.add(i), QuadOperation::Kind::kAdd, absl::StrCat("add[", i, "]"));
    if (!status.ok()) return status;
  }
  if (!request.rdf().empty()) {
    if (absl::Status size = CheckDocumentSize("rdf", request.rdf(), limits); !size.ok()) return size;
    std::string media_type = request.rdf_media_type().empty() ? "text/turtle" : request.rdf_media_type();
    auto format = FormatOfMediaType(media_type);
    if (!format)
      return absl::InvalidArgumentError(absl::StrCat("rdf_media_type: ", UnknownMediaType(media_type)));
    if (absl::Status base = CheckBase(request.rdf_base_iri()); !base.ok()) return base;
    ParseRdfOptions options = RdfOptionsOf(request, limits);
    options.cancellation = cancellation;
    options.memory = memory;
    ParsedRdf parsed = ParseRdf(request.rdf(), *format, options);
    if (!parsed.ok()) return ToStatus(parsed, request.rdf());
    if (absl::Status room = count(2 * parsed.quads.size() * sizeof(QuadOperation)); !room.ok()) return room;
    for (TermQuad& quad : parsed.quads) {
      if (absl::Status status = measured(quad, "rdf"); !status.ok()) return status;
      batch.operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    }
  }
  for (int i = 0; i < request.readings_size(); ++i) {
    const v1::SensorReading& in = request.readings(i);
    std::string what = absl::StrCat("readings[", i, "]");
    if (absl::Status sensor = CheckIri(in.sensor(), what + ".sensor"); !sensor.ok()) return sensor;
    auto value = FromProto(in.value(), what + ".value", limits);
    if (!value.ok()) return value.status();
    if (absl::Status status = CheckMeasure("", *value, what + ".value"); !status.ok()) return status;
    if (in.time_us() < 0) {
      return absl::InvalidArgumentError(
          absl::StrCat(what, ".time_us is ", in.time_us(), "; give microseconds since 1970, or 0 for now"));
    }
    batch.readings.push_back({in.sensor(), *std::move(value), in.time_us()});
  }
  return batch;
}

namespace {

// A status message travels in HTTP/2 headers, of which clients accept 8 KiB by default, and bytes outside of
// printable ASCII take three there (gRPC over HTTP/2, "Status-Message").
std::string CutToHeaders(absl::string_view message) {
  constexpr size_t kHeaderBytes = 6000;
  size_t encoded = 0, line_end = 0;
  for (size_t i = 0; i < message.size(); ++i) {
    encoded += message[i] < ' ' || message[i] > '~' || message[i] == '%' ? 3 : 1;
    if (encoded > kHeaderBytes) {
      size_t cut = line_end > 0 ? line_end : i;
      while (cut > 0 && (static_cast<unsigned char>(message[cut]) & 0xC0) == 0x80)
        --cut;  // whole code points
      return absl::StrCat(message.substr(0, cut), "… (", message.size() - cut, " more bytes)");
    }
    if (message[i] == '\n') line_end = i + 1;
  }
  return std::string(message);
}

}  // namespace

absl::StatusOr<std::vector<std::pair<std::string, Term>>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::NamedTerm>& terms, const std::string& what,
    const Limits& limits) {
  std::vector<std::pair<std::string, Term>> out;
  std::set<std::string> names;
  for (const v1::NamedTerm& named : terms) {
    const std::string place = absl::StrCat(what, ".", named.name());
    if (!names.insert(named.name()).second)
      return absl::InvalidArgumentError(absl::StrCat(place, " is given twice; give it one value"));
    auto term = FromProto(named.value(), place, limits);
    if (!term.ok()) return term.status();
    out.emplace_back(named.name(), *std::move(term));
  }
  return out;
}

absl::Status CheckDocumentSize(std::string_view name, std::string_view text, const Limits& limits) {
  if (text.size() <= limits.document_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(name.empty() ? "the document" : ToAbsl(name), " has ",
                                                   text.size(), " bytes; the limit document_bytes is ",
                                                   limits.document_bytes));
}

grpc::Status ToGrpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), CutToHeaders(status.message()));
}

v1::StreamError ToStreamError(const absl::Status& status) {
  v1::StreamError error;
  error.set_code(static_cast<int>(status.code()));
  error.set_message(std::string(status.message()));
  return error;
}

}  // namespace docent::server
