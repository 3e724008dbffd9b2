// Any bytes as an update: sound diagnostics; or operations that evaluate within their limits on a small
// graph, whose quads the store accepts, and which list their reads if they depend on the graph.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/update_evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"
#include "graph/store/server_graphs.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent {
namespace {

struct SmallGraph {
  SmallGraph() {
    const TermId graph = dictionary.InternIri(kDefaultGraph), type = dictionary.InternIri(kRdfType);
    for (int i = 0; i < 12; ++i) {
      const TermId node = dictionary.InternIri("http://example.org/n" + std::to_string(i));
      writer.Add({node, type, dictionary.InternIri(DocentIri(i % 3 ? "Visitor" : "Robot")), graph});
      writer.Add({node, dictionary.InternIri("http://example.org/p"), *InlineLiteral(Term::Integer(i)),
                  dictionary.InternIri(i % 2 ? "http://example.org/g" : kInferredGraph)});
    }
    writer.Freeze(Revision(1));
  }
  Dictionary dictionary;
  GraphWriter writer{nullptr};
};

bool Fits(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kUnimplemented:  // an unresolved SERVICE
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kResourceExhausted:
      return true;
    default:
      return false;
  }
}

void CheckOne(std::string_view text) {
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  options.prefixes.emplace_back("ex", "http://example.org/");
  options.base_iri = text.size() % 2 ? "http://base/" : "";
  const sparql::ParsedUpdate parsed = sparql::ParseUpdate(text, options);
  if (!parsed.ok()) return fuzz::RequireSound(parsed.diagnostics, text);
  SmallGraph graph;
  Cancellation cancellation(std::chrono::milliseconds(20));
  sparql::UpdateOptions update_options;
  update_options.prepare.memory_bytes = 1 << 20;
  update_options.load = [](const std::string&) -> absl::StatusOr<sparql::DocumentQuads> {
    return std::make_shared<const std::vector<TermQuad>>(
        std::vector<TermQuad>{{Term::Blank("b"), Term::Iri("urn:p"), Term::Blank("b"), Term{}}});
  };
  auto effect = sparql::EvaluateUpdate(parsed.update, graph.dictionary,
                                       {&graph.writer.current(), &cancellation, 0, 1}, update_options);
  if (!effect.ok())
    return fuzz::Require(Fits(effect.status()), "an update that ends with " + effect.status().ToString());
  for (const QuadOperation& operation : effect->operations) {
    fuzz::Require(!IsServerGraph(operation.quad.graph.lexical), "a write to a graph of the server");
    fuzz::Require(operation.quad.graph.IsIri() && !operation.quad.graph.lexical.empty(),
                  "a quad without graph");
  }
  BatchApplier applier(graph.dictionary, Limits{});
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.operations = std::move(effect->operations);
  const absl::Status applied = applier.Apply(batch, graph.writer).status();
  fuzz::Require(applied.ok() || applied.code() == absl::StatusCode::kInvalidArgument,
                "the store refuses it: " + applied.ToString());
  graph.writer.current().CheckInvariants();
}

}  // namespace
}  // namespace docent

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  docent::CheckOne(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
