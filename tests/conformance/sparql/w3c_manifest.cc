#include "tests/conformance/sparql/w3c_manifest.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

constexpr char kMf[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#";
constexpr char kUt[] = "http://www.w3.org/2009/sparql/tests/test-update#";
constexpr char kQt[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-query#";

}  // namespace

std::filesystem::path W3cRoot() {
  const char* given = std::getenv("DOCENT_W3C_TESTS");
  return (given != nullptr ? std::filesystem::path(given)
                           : std::filesystem::path(DOCENT_SOURCE_DIR) / "../shared/w3c-rdf-tests") /
         "sparql";
}

std::filesystem::path W3cFile(const std::string& iri) {
  const std::string base = kW3cBase;
  return W3cRoot() / (iri.starts_with(base) ? iri.substr(base.size()) : iri);
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in.good()) << path;
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string LocalName(const std::string& iri) {
  return iri.substr(iri.find_last_of("#/") + 1);
}

Manifest::Manifest(const std::string& iri) : graph(Quads(iri)) {
  const std::string mf = kMf;
  entries = graph.List(graph.One(graph.WithType(mf + "Manifest"), mf + "entries"));
}

std::vector<std::string> Manifest::Types(const Term& entry) const {
  std::vector<std::string> out;
  for (const Term& type : graph.All(entry, std::string(kRdfType))) out.push_back(LocalName(type.lexical));
  return out;
}

std::vector<TermQuad> Manifest::Quads(const std::string& iri) {
  ParseRdfOptions options;
  options.base_iri = iri;
  const std::string text = ReadText(W3cFile(options.base_iri));
  ParsedRdf parsed = ParseRdf(text, RdfFormat::kTurtle, options);
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  return std::move(parsed.quads);
}

std::vector<W3cQueryTest> ReadQueryManifest(const std::string& folder) {
  const Manifest manifest(kW3cBase + folder + "/manifest.ttl");
  const ManifestGraph& graph = manifest.graph;
  const std::string mf = kMf, qt = kQt;
  std::vector<W3cQueryTest> tests;
  for (const Term& entry : manifest.entries) {
    W3cQueryTest test;
    bool query_test = true;
    for (const std::string& kind : manifest.Types(entry)) {
      if (kind == "QueryEvaluationTest" || kind == "CSVResultFormatTest") {
        test.kind = W3cQueryTest::Kind::kEvaluation;
      } else if (kind == "PositiveSyntaxTest" || kind == "PositiveSyntaxTest11") {
        test.kind = W3cQueryTest::Kind::kPositiveSyntax;
      } else if (kind == "NegativeSyntaxTest" || kind == "NegativeSyntaxTest11") {
        test.kind = W3cQueryTest::Kind::kNegativeSyntax;
      } else {
        query_test = false;
      }
    }
    if (!query_test) continue;
    test.name = folder + "/" + LocalName(entry.lexical);
    const Term action = graph.One(entry, mf + "action");
    test.query = action.IsIri() ? action.lexical : graph.One(action, qt + "query").lexical;
    for (const Term& data : graph.All(action, qt + "data")) test.data.push_back(data.lexical);
    for (const Term& data : graph.All(action, qt + "graphData")) {
      if (data.IsIri()) {
        test.named.emplace_back(data.lexical, data.lexical);
      } else {
        const std::string file = graph.One(data, qt + "graph").lexical;
        const Term label = graph.One(data, Concat(kRdfsNs, "label"));
        test.named.emplace_back(label.lexical.empty() ? file : label.lexical, file);
      }
    }
    for (const Term& service : graph.All(action, qt + "serviceData")) {
      test.services.emplace_back(graph.One(service, qt + "endpoint").lexical,
                                 graph.One(service, qt + "data").lexical);
    }
    test.result = graph.One(entry, mf + "result").lexical;
    test.lax = LocalName(graph.One(entry, mf + "resultCardinality").lexical) == "LaxCardinality";
    tests.push_back(std::move(test));
  }
  return tests;
}

std::vector<W3cUpdateTest> ReadUpdateManifest(const std::string& folder) {
  const Manifest manifest(kW3cBase + folder + "/manifest.ttl");
  const ManifestGraph& graph = manifest.graph;
  const std::string mf = kMf, ut = kUt;
  const auto state = [&](const Term& node) {
    W3cUpdateTest::State out;
    for (const Term& data : graph.All(node, ut + "data")) out.data.push_back(data.lexical);
    for (const Term& data : graph.All(node, ut + "graphData")) {
      out.named.emplace_back(graph.One(data, Concat(kRdfsNs, "label")).lexical,
                             graph.One(data, ut + "graph").lexical);
    }
    return out;
  };
  std::vector<W3cUpdateTest> tests;
  for (const Term& entry : manifest.entries) {
    W3cUpdateTest test;
    bool update_test = false;
    for (const std::string& kind : manifest.Types(entry)) {
      update_test = true;
      const bool request = graph.One(entry, mf + "action").lexical.ends_with(".ru");
      if (kind == "UpdateEvaluationTest") {
        test.kind = W3cUpdateTest::Kind::kEvaluation;
      } else if (kind == "PositiveUpdateSyntaxTest" || kind == "PositiveUpdateSyntaxTest11") {
        test.kind = W3cUpdateTest::Kind::kPositiveSyntax;
      } else if (kind == "NegativeUpdateSyntaxTest" || kind == "NegativeUpdateSyntaxTest11" ||
                 (kind == "NegativeSyntaxTest11" && request)) {
        test.kind = W3cUpdateTest::Kind::kNegativeSyntax;
      } else {
        update_test = false;
      }
    }
    if (!update_test) continue;
    test.name = folder + "/" + LocalName(entry.lexical);
    const Term action = graph.One(entry, mf + "action");
    test.request = action.IsIri() ? action.lexical : graph.One(action, ut + "request").lexical;
    test.before = state(action);
    test.after = state(graph.One(entry, mf + "result"));
    tests.push_back(std::move(test));
  }
  return tests;
}

}  // namespace docent
