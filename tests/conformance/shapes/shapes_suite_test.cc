// The W3C SHACL test suite (github.com/w3c/data-shapes, data-shapes-test-suite/tests: core and sparql). It is
// in $DOCENT_W3C_SHAPES, else beside the source tree; skipped if absent.
//
// A test passes if the report is the expected one, up to blank nodes. A sh:resultMessage counts only if the
// expected report has one, as the suite asks (core/misc/message-001); sh:detail is left out.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/store/graph_writer.h"
#include "reasoner/shapes/report.h"
#include "reasoner/shapes/shape_reader.h"
#include "reasoner/shapes/validator.h"
#include "tests/conformance/rdf/isomorphism.h"
#include "tests/conformance/sparql/suite_support.h"
#include "tests/conformance/sparql/w3c_manifest.h"

namespace docent::shapes {
namespace {

constexpr char kBase[] = "http://shapes.test/";
constexpr char kMf[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#";
constexpr char kSht[] = "http://www.w3.org/ns/shacl-test#";

std::filesystem::path SuiteFolder() {
  const char* given = std::getenv("DOCENT_W3C_SHAPES");
  return given != nullptr ? given : std::filesystem::path(DOCENT_SOURCE_DIR) / "../shared/w3c-data-shapes";
}

std::vector<TermQuad> Document(const std::string& iri, const std::string& scope) {
  const std::string file = iri.substr(sizeof(kBase) - 1);
  const std::string text = ReadText(SuiteFolder() / file);
  ParseRdfOptions options;
  options.file = file;
  options.base_iri = iri;
  options.blank_node_scope = scope;
  ParsedRdf parsed = ParseRdf(text, RdfFormat::kTurtle, options);
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  return std::move(parsed.quads);
}

struct ShapesTest {
  std::string name;
  std::string manifest, data, shapes;  // IRIs of documents
  Term entry;
};

void ReadManifest(const std::string& iri, std::vector<ShapesTest>* tests) {
  const std::vector<TermQuad> quads = Document(iri, "");
  const ManifestGraph graph(quads);
  const Term manifest = graph.WithType(std::string(kMf) + "Manifest");
  for (const Term& include : graph.All(manifest, std::string(kMf) + "include"))
    ReadManifest(include.lexical, tests);
  for (const Term& entries : graph.All(manifest, std::string(kMf) + "entries")) {
    for (const Term& entry : graph.List(entries)) {
      const Term action = graph.One(entry, std::string(kMf) + "action");
      ShapesTest test;
      const std::string folder = iri.substr(sizeof(kBase) - 1, iri.rfind('/') - sizeof(kBase) + 1);
      test.name = "shapes/" + folder + entry.lexical.substr(entry.lexical.rfind('/'));
      test.manifest = iri;
      test.data = graph.One(action, std::string(kSht) + "dataGraph").lexical;
      test.shapes = graph.One(action, std::string(kSht) + "shapesGraph").lexical;
      test.entry = entry;
      tests->push_back(std::move(test));
    }
  }
}

// The triples of a report: its own, those of its results and of their paths.
std::vector<TermQuad> ReportTriples(const std::vector<TermQuad>& quads, const Term& root,
                                    const std::set<Term>& messages) {
  const std::set<std::string> followed = {Shacl("result"), Shacl("resultPath")};
  const std::set<std::string> parts = {
      Shacl("inversePath"),   Shacl("alternativePath"), Shacl("zeroOrMorePath"), Shacl("oneOrMorePath"),
      Shacl("zeroOrOnePath"), Concat(kRdfNs, "first"),  Concat(kRdfNs, "rest")};
  std::vector<TermQuad> out;
  std::set<Term> seen = {root};
  std::vector<std::pair<Term, bool>> open = {{root, false}};  // node, inside a path
  while (!open.empty()) {
    const auto [node, in_path] = open.back();
    open.pop_back();
    for (const TermQuad& quad : quads) {
      if (!(quad.subject == node)) continue;
      const std::string& predicate = quad.predicate.lexical;
      if (in_path && !parts.contains(predicate)) continue;
      if (predicate == Shacl("detail") ||
          (predicate == Shacl("resultMessage") && !messages.contains(quad.object)))
        continue;
      out.push_back({quad.subject, quad.predicate, quad.object, Term()});
      const bool path = in_path || predicate == Shacl("resultPath");
      if ((in_path || followed.contains(predicate)) && quad.object.IsBlank() &&
          seen.insert(quad.object).second) {
        open.push_back({quad.object, path});
      }
    }
  }
  return out;
}

Term RootOf(const std::vector<TermQuad>& quads) {
  return ManifestGraph(quads).WithType(Shacl("ValidationReport"));
}

TermId LoadInto(GraphWriter& writer, Dictionary& dictionary, const std::vector<TermQuad>& quads,
                const std::string& graph) {
  const TermId name = dictionary.InternIri(graph);
  for (const TermQuad& q : quads) {
    writer.Add(
        {dictionary.Intern(q.subject), dictionary.Intern(q.predicate), dictionary.Intern(q.object), name});
  }
  return name;
}

std::string RunOne(const ShapesTest& test) {
  Dictionary dictionary;
  GraphWriter writer(nullptr);
  const TermId data = LoadInto(writer, dictionary, Document(test.data, "d"), "urn:data");
  // One document that is both keeps its blank nodes.
  const TermId shapes_graph = test.data == test.shapes
                                  ? data
                                  : LoadInto(writer, dictionary, Document(test.shapes, "s"), "urn:shapes");
  const GraphVersion& version = writer.current();
  const ParsedShapes shapes = ReadShapes(GraphView(version, {shapes_graph}), dictionary);
  const std::vector<TermQuad> expected = Document(test.manifest, "d");
  const Term root = ManifestGraph(expected).One(test.entry, std::string(kMf) + "result");
  const bool failure = root.lexical == std::string(kSht) + "Failure";
  if (!shapes.ok()) return failure ? "" : "refused: " + Render(shapes.diagnostics, "");
  const auto report = Validate(shapes.shapes, GraphView(version, {data}), dictionary);
  if (!report.ok()) return failure ? "" : std::string(report.status().message());
  if (failure) return "expected a failure";
  std::set<Term> messages;
  for (const TermQuad& quad : expected) {
    if (quad.predicate.lexical == Shacl("resultMessage")) messages.insert(quad.object);
  }
  const std::vector<TermQuad> got = ToRdf(*report, dictionary);
  const auto wanted_triples = ReportTriples(expected, root, messages);
  const auto triples = ReportTriples(got, RootOf(got), messages);
  if (Isomorphism::Holds(wanted_triples, triples)) return "";
  std::string why = "another report than expected:\n";
  for (const ValidationResult& result : report->results)
    why += Render(Describe(result, dictionary, nullptr, nullptr));
  return why + std::to_string(triples.size()) + " triples, expected " + std::to_string(wanted_triples.size());
}

class ShapesSuite : public testing::TestWithParam<std::pair<const char*, size_t>> {};

TEST_P(ShapesSuite, EveryTestPassesOrIsListed) {
  const auto& [part, least] = GetParam();
  const std::string manifest = std::string("tests/") + part + "/manifest.ttl";
  if (!std::filesystem::exists(SuiteFolder() / manifest)) {
    GTEST_SKIP()
        << "the SHACL suite is not at " << SuiteFolder()
        << ": clone github.com/w3c/data-shapes and set DOCENT_W3C_SHAPES to its data-shapes-test-suite";
  }
  std::vector<ShapesTest> tests;
  ReadManifest(kBase + manifest, &tests);
  EXPECT_GE(tests.size(), least);
  RunSuite(std::string("shacl ") + part, tests, RunOne);
}

INSTANTIATE_TEST_SUITE_P(OfW3c, ShapesSuite,
                         testing::Values(std::pair("core", size_t{98}), std::pair("sparql", size_t{20})),
                         [](const auto& info) { return info.param.first; });

}  // namespace
}  // namespace docent::shapes
