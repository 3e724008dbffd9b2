// Reads the manifests of the W3C SPARQL test suites (github.com/w3c/rdf-tests).
#ifndef DOCENT_TESTS_CONFORMANCE_SPARQL_W3C_MANIFEST_H_
#define DOCENT_TESTS_CONFORMANCE_SPARQL_W3C_MANIFEST_H_

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace docent {

struct W3cQueryTest {
  enum class Kind { kEvaluation, kPositiveSyntax, kNegativeSyntax };
  Kind kind = Kind::kEvaluation;
  std::string name;                                        // folder/name-of-the-entry
  std::string query;                                       // files below are IRIs beneath kBase
  std::vector<std::string> data;                           // default graph
  std::vector<std::pair<std::string, std::string>> named;  // graph IRI, file
  std::string result;
  std::vector<std::pair<std::string, std::string>> services;  // endpoint IRI, the file that it serves
  bool lax = false;  // REDUCED: how often a solution comes does not count
};

// An update test: a request, and the graph store before and after it.
struct W3cUpdateTest {
  enum class Kind { kEvaluation, kPositiveSyntax, kNegativeSyntax };
  struct State {
    std::vector<std::string> data;                           // default graph
    std::vector<std::pair<std::string, std::string>> named;  // graph IRI, file
  };
  Kind kind = Kind::kEvaluation;
  std::string name;
  std::string request;
  State before, after;
};

inline constexpr char kW3cBase[] = "http://w3c.test/";

// $DOCENT_W3C_TESTS, else beside the source tree; may not exist.
std::filesystem::path W3cRoot();
// The file of an IRI beneath kW3cBase.
std::filesystem::path W3cFile(const std::string& iri);
std::string ReadText(const std::filesystem::path& path);
// The query and the update tests of a folder such as "sparql11/aggregates", in manifest order. Others are
// left out.
std::vector<W3cQueryTest> ReadQueryManifest(const std::string& folder);
std::vector<W3cUpdateTest> ReadUpdateManifest(const std::string& folder);

}  // namespace docent

#endif  // DOCENT_TESTS_CONFORMANCE_SPARQL_W3C_MANIFEST_H_
