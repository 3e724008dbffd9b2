// The W3C RDF 1.1 test suites (github.com/w3c/rdf-tests): syntax and evaluation of Turtle, TriG,
// N-Triples, N-Quads and RDF/XML. They are in $DOCENT_W3C_TESTS, else beside the source tree; skipped if
// absent.
//
// Every document that parses is also written in each format that can express it and parsed again; the
// result must be the same.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/serializer.h"
#include "tests/conformance/rdf/isomorphism.h"
#include "tests/conformance/sparql/suite_support.h"

namespace docent {
namespace {

constexpr char kManifest[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#";
constexpr char kType[] = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";
constexpr char kTestNs[] = "http://www.w3.org/ns/rdftest#";

std::filesystem::path SuitesFolder() {
  const char* given = std::getenv("DOCENT_W3C_TESTS");
  std::filesystem::path root =
      given != nullptr ? given : std::filesystem::path(DOCENT_SOURCE_DIR) / "../shared/w3c-rdf-tests";
  return root / "rdf";
}

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in.good()) << path;
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

struct W3cTest {
  std::string name;
  std::string type;  // local name: TestTurtleEval …
  std::string action;
  std::string result;
};

// The suite in a folder such as "rdf11/rdf-turtle".
class Suite {
 public:
  explicit Suite(const std::string& folder)
      : folder_(SuitesFolder() / folder), base_("https://w3c.github.io/rdf-tests/rdf/" + folder + "/") {}

  std::vector<W3cTest> ReadManifest() {
    ParseRdfOptions options{"manifest.ttl", base_ + "manifest.ttl"};
    std::string text = ReadFile(folder_ / "manifest.ttl");
    ParsedRdf manifest = ParseRdf(text, RdfFormat::kTurtle, options);
    EXPECT_TRUE(manifest.ok()) << Render(manifest.diagnostics, text);
    std::map<std::string, W3cTest> tests;
    for (const TermQuad& quad : manifest.quads) {
      W3cTest& test = tests[quad.subject.lexical];
      const std::string& predicate = quad.predicate.lexical;
      if (predicate == kType && quad.object.lexical.starts_with(kTestNs)) {
        test.type = quad.object.lexical.substr(sizeof(kTestNs) - 1);
      }
      if (predicate == std::string(kManifest) + "name") test.name = quad.object.lexical;
      if (predicate == std::string(kManifest) + "action") test.action = quad.object.lexical;
      if (predicate == std::string(kManifest) + "result") test.result = quad.object.lexical;
    }
    std::vector<W3cTest> found;
    for (auto& [iri, test] : tests) {
      if (!test.type.empty()) found.push_back(std::move(test));
    }
    return found;
  }

  // Empty if the test passes, else the failure.
  std::string Run(const W3cTest& test) {
    if (!test.action.starts_with(base_)) return "its document lies elsewhere";
    ParsedRdf parsed = Parse(test.action);
    bool negative = test.type.find("Negative") != std::string::npos;
    if (negative && parsed.ok()) return "accepted a bad document";
    if (negative) return "";
    if (!parsed.ok()) return Render(parsed.diagnostics, "");
    if (!test.result.empty()) {
      ParsedRdf expected = Parse(test.result);
      if (!expected.ok()) return "the expected result does not parse: " + Render(expected.diagnostics, "");
      if (!Isomorphism::Holds(parsed.quads, expected.quads)) return "other triples than expected";
    }
    return RoundTrips(parsed);
  }

 private:
  ParsedRdf Parse(const std::string& iri) {
    std::string relative = iri.substr(base_.size());
    std::string text = ReadFile(folder_ / relative);
    ParseRdfOptions options{relative, iri};
    return ParseRdf(text, *FormatOfFile(relative), options);
  }

  static std::string RoundTrips(const ParsedRdf& parsed) {
    for (RdfFormat format : {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kNTriples, RdfFormat::kNQuads,
                             RdfFormat::kRdfXml}) {
      absl::StatusOr<std::string> text = SerializeRdf(parsed.quads, format, parsed.prefixes);
      if (!text.ok()) continue;  // the format cannot express it
      ParsedRdf again = ParseRdf(*text, format);
      if (!again.ok()) return "written text does not parse:\n" + *text + Render(again.diagnostics, *text);
      if (!Isomorphism::Holds(parsed.quads, again.quads)) return "written text reads differently:\n" + *text;
    }
    return "";
  }

  std::filesystem::path folder_;
  std::string base_;
};

class RdfSuites : public testing::TestWithParam<const char*> {};

TEST_P(RdfSuites, EveryTestPassesOrIsListed) {
  const std::string folder = std::string("rdf11/") + GetParam();
  if (!std::filesystem::exists(SuitesFolder() / folder / "manifest.ttl")) {
    GTEST_SKIP() << "the W3C suites are not at " << SuitesFolder()
                 << ": clone github.com/w3c/rdf-tests and set DOCENT_W3C_TESTS to it";
  }
  Suite suite(folder);
  std::vector<W3cTest> tests = suite.ReadManifest();
  EXPECT_GT(tests.size(), 50u);
  for (W3cTest& test : tests) test.name = std::string(GetParam()) + "/" + test.name;
  RunSuite("rdf " + folder, tests, [&suite](const W3cTest& test) { return suite.Run(test); });
}

INSTANTIATE_TEST_SUITE_P(W3c, RdfSuites,
                         testing::Values("rdf-turtle", "rdf-trig", "rdf-n-triples", "rdf-n-quads",
                                         "rdf-xml"));

// Report on a draft that is not a recommendation yet: numbers, no verdict.
TEST(Rdf12, Report) {
  if (!std::filesystem::exists(SuitesFolder() / "rdf12"))
    GTEST_SKIP() << "the W3C suites are not at " << SuitesFolder();
  for (const char* format : {"rdf-turtle", "rdf-trig", "rdf-n-triples", "rdf-n-quads", "rdf-xml"}) {
    const std::filesystem::path root = SuitesFolder() / "rdf12" / format;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      if (entry.path().filename() != "manifest.ttl") continue;
      const std::string folder =
          std::filesystem::relative(entry.path().parent_path(), SuitesFolder()).string();
      Suite suite(folder);
      size_t passed = 0, all = 0;
      for (const W3cTest& test : suite.ReadManifest()) {
        if (test.type.find("C14N") != std::string::npos)
          continue;  // for the canonical form, which Docent does not write
        ++all;
        passed += suite.Run(test).empty() ? 1 : 0;
      }
      if (all > 0) std::printf("conformance draft %s %zu %zu\n", folder.c_str(), passed, all);
    }
  }
}

}  // namespace
}  // namespace docent
