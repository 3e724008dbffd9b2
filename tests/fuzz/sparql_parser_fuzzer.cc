// Any bytes as a query: sound diagnostics; or an algebra whose printed text parses and prints the same, and
// which prepares and runs on a small graph within its limits.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent {
namespace {

struct SmallGraph {
  SmallGraph() {
    GraphWriter writer(nullptr);
    const TermId graph = dictionary.InternIri(kDefaultGraph), type = dictionary.InternIri(kRdfType);
    for (int i = 0; i < 20; ++i) {
      const TermId node = dictionary.InternIri("urn:n" + std::to_string(i));
      writer.Add({node, type, dictionary.InternIri(DocentIri(i % 3 ? "Visitor" : "Robot")), graph});
      writer.Add({node, dictionary.InternIri(DocentIri("isAt")),
                  dictionary.InternIri("urn:n" + std::to_string(i % 5)), graph});
      writer.Add({node, dictionary.InternIri(DocentIri("x")), *InlineLiteral(Term::Integer(i)),
                  dictionary.InternIri("urn:g")});
    }
    version = writer.Freeze(Revision(1));
  }
  Dictionary dictionary;
  GraphVersionPtr version;
};

void RunIt(const sparql::Query& query) {
  static const auto* graph = new SmallGraph;
  sparql::PrepareOptions options;
  options.memory_bytes = 1 << 20;
  auto prepared = sparql::PreparedQuery::Prepare(query, graph->dictionary, options);
  if (!prepared.ok()) return;
  Cancellation cancellation(std::chrono::milliseconds(20));
  const sparql::RunOptions run{graph->version.get(), &cancellation, 0, 1};
  int rows = 0;
  const absl::Status status = (*prepared)->Select(run, {}, [&](absl::Span<const TermId> row) {
    for (const TermId id : row) {
      if (!id.IsNone()) (void)(*prepared)->Decode(id);
    }
    return ++rows < 1000;
  });
  fuzz::Require(status.ok() || status.code() == absl::StatusCode::kDeadlineExceeded ||
                    status.code() == absl::StatusCode::kResourceExhausted,
                "a run that ends with " + status.ToString());
}

void CheckOne(std::string_view text) {
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  options.base_iri = text.size() % 2 ? "http://base/" : "";
  const sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (!parsed.ok()) return fuzz::RequireSound(parsed.diagnostics, text);
  RunIt(parsed.query);
  (void)sparql::PrintAlgebra(*parsed.query.algebra);
  const sparql::PrintOptions print{options.prefixes, true};
  const std::string printed = sparql::PrintQuery(parsed.query, print);
  options.limits.query_nesting *= 10;  // the printed text has more parentheses
  options.limits.query_elements *= 10;
  options.limits.query_text_bytes *= 10;
  const sparql::ParsedQuery again = sparql::ParseQuery(printed, options);
  fuzz::Require(again.ok(),
                "printed text that does not parse:\n" + printed + Render(again.diagnostics, printed));
  const std::string twice = sparql::PrintQuery(again.query, print);
  fuzz::Require(twice == printed, "text that prints differently:\n" + printed + "\nand then:\n" + twice);
}

}  // namespace
}  // namespace docent

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  docent::CheckOne(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
