// The W3C RDF 1.1 test suites (github.com/w3c/rdf-tests): syntax and evaluation of Turtle, TriG, N-Triples,
// N-Quads and RDF/XML. They are looked for in $DOCENT_W3C_TESTS, else beside the source tree; skipped where
// they are not.
//
// Every document that parses is also written in each format that can hold it, read again, and must be the
// same.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "kb_server/rdf/parser.h"
#include "kb_server/rdf/serializer.h"
#include "tests/conformance/rdf/isomorphism.h"

namespace docent {
namespace {

constexpr char kManifest[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#";
constexpr char kType[] = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";
constexpr char kTestNs[] = "http://www.w3.org/ns/rdftest#";

// Known failures, by test name, each with its reason. A test listed here that passes is an error, too.
const std::map<std::string, std::string>& KnownFailures() {
  static const auto* known = new std::map<std::string, std::string>{
      {"rdfms-xmllang-test006",
       "Raptor 2.0.15 gives property attributes no language, whatever xml:lang is in scope"},
  };
  return *known;
}

std::filesystem::path SuitesFolder() {
  const char* given = std::getenv("DOCENT_W3C_TESTS");
  std::filesystem::path root =
      given != nullptr ? given : std::filesystem::path(DOCENT_SOURCE_DIR) / "../shared/w3c-rdf-tests";
  return root / "rdf/rdf11";
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

class RdfSuites : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = SuitesFolder() / GetParam();
    if (!std::filesystem::exists(folder_ / "manifest.ttl")) {
      GTEST_SKIP() << "the W3C suites are not at " << SuitesFolder()
                   << ": clone github.com/w3c/rdf-tests and set DOCENT_W3C_TESTS to it";
    }
    base_ = std::string("https://w3c.github.io/rdf-tests/rdf/rdf11/") + GetParam() + "/";
  }

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

  ParsedRdf Parse(const std::string& iri) {
    std::string relative = iri.substr(base_.size());
    std::string text = ReadFile(folder_ / relative);
    ParseRdfOptions options{relative, iri};
    return ParseRdf(text, *FormatOfFile(relative), options);
  }

  // Empty if the test passes, else what went wrong.
  std::string Run(const W3cTest& test) {
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

  static std::string RoundTrips(const ParsedRdf& parsed) {
    for (RdfFormat format : {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kNTriples, RdfFormat::kNQuads,
                             RdfFormat::kRdfXml}) {
      absl::StatusOr<std::string> text = SerializeRdf(parsed.quads, format, parsed.prefixes);
      if (!text.ok()) continue;  // the format cannot say it
      ParsedRdf again = ParseRdf(*text, format);
      if (!again.ok()) return "written text does not parse:\n" + *text + Render(again.diagnostics, *text);
      if (!Isomorphism::Holds(parsed.quads, again.quads)) return "written text reads differently:\n" + *text;
    }
    return "";
  }

  std::filesystem::path folder_;
  std::string base_;
};

TEST_P(RdfSuites, EveryTestPassesOrIsListed) {
  std::vector<W3cTest> tests = ReadManifest();
  EXPECT_GT(tests.size(), 50u);
  std::map<std::string, std::pair<int, int>> counts;
  for (const W3cTest& test : tests) {
    std::string problem = Run(test);
    auto& [passed, all] = counts[test.type];
    ++all;
    passed += problem.empty() ? 1 : 0;
    bool known = KnownFailures().contains(test.name);
    EXPECT_EQ(problem.empty(), !known) << test.type << " " << test.name << ": " << problem;
  }
  for (const auto& [type, count] : counts) {
    std::cout << "  " << type << ": " << count.first << " of " << count.second << "\n";
  }
}

INSTANTIATE_TEST_SUITE_P(W3c, RdfSuites,
                         testing::Values("rdf-turtle", "rdf-trig", "rdf-n-triples", "rdf-n-quads",
                                         "rdf-xml"));

}  // namespace
}  // namespace docent
