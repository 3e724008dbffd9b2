// The W3C SPARQL 1.1 Update suites: syntax and evaluation.
#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/update_evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "tests/conformance/rdf/isomorphism.h"
#include "tests/conformance/sparql/suite_support.h"
#include "tests/conformance/sparql/w3c_manifest.h"

namespace docent {
namespace {

void LoadState(const W3cUpdateTest::State& state, SuiteStore* store) {
  for (const std::string& file : state.data) store->Load(file, std::string(kDefaultGraph));
  for (const auto& [graph, file] : state.named) store->Load(file, graph);
}

std::string ToText(const std::vector<TermQuad>& quads) {
  std::string out;
  for (const TermQuad& q : quads) {
    out += "  " + ToNTriples(q.subject) + " " + ToNTriples(q.predicate) + " " + ToNTriples(q.object) + " " +
           (q.graph.lexical.empty() ? "" : ToNTriples(q.graph)) + "\n";
  }
  return out;
}

// Empty if the test passes, else the reason.
std::string RunOne(const W3cUpdateTest& test) {
  using Kind = W3cUpdateTest::Kind;
  const std::string text = ReadText(W3cFile(test.request));
  sparql::ParseOptions options;
  options.base_iri = test.request;
  const sparql::ParsedUpdate parsed = sparql::ParseUpdate(text, options);
  if (test.kind == Kind::kNegativeSyntax) return parsed.ok() ? "accepted, but it is wrong" : "";
  if (!parsed.ok()) return Render(parsed.diagnostics, text);
  if (test.kind == Kind::kPositiveSyntax) return "";
  SuiteStore store, expected;
  LoadState(test.before, &store);
  LoadState(test.after, &expected);
  const GraphVersionPtr version = store.Freeze();
  sparql::UpdateOptions update_options;
  update_options.prepare.default_graph = sparql::DefaultGraph::kStrict;
  update_options.load = [](const std::string& iri) -> absl::StatusOr<sparql::DocumentQuads> {
    return absl::NotFoundError(iri + " is not there");
  };
  auto effect =
      sparql::EvaluateUpdate(parsed.update, store.dictionary,
                             {version.get(), nullptr, TimeMicros{1'700'000'000'000'000}, 1}, update_options);
  if (!effect.ok()) return std::string(effect.status().message());
  if (absl::Status status = store.Apply(std::move(effect->operations)); !status.ok()) {
    return std::string(status.message());
  }
  if (Isomorphism::Holds(store.Quads(), expected.Quads())) return "";
  return "got\n" + ToText(store.Quads()) + "expected\n" + ToText(expected.Quads());
}

class UpdateSuites : public testing::TestWithParam<const char*> {};

TEST_P(UpdateSuites, EveryTestPassesOrIsKnown) {
  const std::string folder = GetParam();
  if (!std::filesystem::exists(W3cRoot() / folder / "manifest.ttl")) {
    GTEST_SKIP() << "the W3C suites are not at " << W3cRoot()
                 << ": clone github.com/w3c/rdf-tests and set DOCENT_W3C_TESTS to it";
  }
  RunSuite("update " + folder, ReadUpdateManifest(folder), RunOne);
}

constexpr const char* kFolders[] = {
    "sparql11/add",          "sparql11/basic-update", "sparql11/clear",           "sparql11/copy",
    "sparql11/delete",       "sparql11/delete-data",  "sparql11/delete-insert",   "sparql11/delete-where",
    "sparql11/drop",         "sparql11/move",         "sparql11/syntax-update-1", "sparql11/syntax-update-2",
    "sparql11/update-silent"};

INSTANTIATE_TEST_SUITE_P(W3c, UpdateSuites, testing::ValuesIn(kFolders), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

}  // namespace
}  // namespace docent
