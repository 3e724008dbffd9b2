#include "kb_server/cli/part_loader.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/line_parser.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/store/server_graphs.h"

namespace docent::server {
namespace {

constexpr size_t kInFlight = 3;

// One request that is under way.
struct Call {
  grpc::ClientContext context;
  v1::LoadRequest request;
  v1::LoadReply reply;
  grpc::Status status;
  size_t bytes = 0;
  std::unique_ptr<grpc::ClientAsyncResponseReader<v1::LoadReply>> reader;
};

void CutAtLines(std::string_view text, size_t part_bytes, std::vector<std::string_view>* parts) {
  while (!text.empty()) {
    size_t end = text.size() <= part_bytes ? text.size() : text.find('\n', part_bytes);
    end = end == std::string_view::npos ? text.size() : std::min(end + 1, text.size());
    parts->push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

}  // namespace

std::unique_ptr<DocumentParts> CutDocument(std::string_view text, RdfFormat format, const std::string& file,
                                           size_t part_bytes, const std::string& base_iri) {
  auto document = std::make_unique<DocumentParts>();
  document->name = BlankLabelStart(text);
  ParseRdfOptions options;
  options.file = file;
  options.refuse_graph = RefuseGraph;
  options.base_iri = base_iri;
  options.charset = "utf-8";
  options.limits.document_bytes = std::numeric_limits<size_t>::max();
  const bool lines = format == RdfFormat::kNTriples || format == RdfFormat::kNQuads;
  document->media_type = format == RdfFormat::kNTriples ? "application/n-triples" : "application/n-quads";
  if (lines) {
    const auto count = [&document](const TermQuad&) {
      ++document->statements;
      return true;
    };
    document->diagnostics = ParseLines(text, format, options, count).diagnostics;
  } else {
    ParsedRdf parsed = ParseRdf(text, format, options);
    document->statements = parsed.quads.size();
    document->diagnostics = std::move(parsed.diagnostics);
    if (!HasErrors(document->diagnostics)) {
      document->owned =
          SerializeRdf(parsed.quads, RdfFormat::kNQuads).value_or("");  // which can say all of them
    }
    text = document->owned;
  }
  if (HasErrors(document->diagnostics)) return document;
  document->bytes = text.size();
  CutAtLines(text, part_bytes, &document->parts);
  return document;
}

PartsOutcome LoadParts(const std::shared_ptr<grpc::Channel>& channel, const DocumentParts& document,
                       const v1::LoadRequest& request, const std::function<void(size_t)>& progress) {
  auto stub = v1::Ontologies::NewStub(channel);
  grpc::CompletionQueue queue;
  PartsOutcome outcome;
  absl::flat_hash_set<std::string> warned;
  size_t next = 0, in_flight = 0, done_bytes = 0;
  while (true) {
    for (; in_flight < kInFlight && next < document.parts.size() && outcome.status.ok();
         ++next, ++in_flight) {
      auto call = std::make_unique<Call>();
      call->request = request;
      call->request.set_kind(v1::LoadRequest::DATA);
      call->request.set_media_type(document.media_type);
      call->request.set_document(document.name);
      call->request.set_text(std::string(document.parts[next]));
      call->bytes = document.parts[next].size();
      call->reader = stub->AsyncLoad(&call->context, call->request, &queue);
      Call* tag = call.release();  // the queue gives it back
      tag->reader->Finish(&tag->reply, &tag->status, tag);
    }
    if (in_flight == 0) return outcome;
    void* tag = nullptr;
    bool ok = false;
    if (!queue.Next(&tag, &ok)) return outcome;
    std::unique_ptr<Call> call(static_cast<Call*>(tag));
    --in_flight;
    if (!call->status.ok()) {
      if (outcome.status.ok()) outcome.status = call->status;
      continue;
    }
    for (v1::Diagnostic& warning : *call->reply.mutable_diagnostics()) {
      if (warned.insert(warning.message()).second) outcome.warnings.Add(std::move(warning));
    }
    outcome.added += call->reply.added();
    outcome.removed += call->reply.removed();
    outcome.inferred += call->reply.inferred();
    outcome.revision = std::max(outcome.revision, call->reply.revision());
    ++outcome.parts;
    done_bytes += call->bytes;
    progress(done_bytes);
  }
}

}  // namespace docent::server
