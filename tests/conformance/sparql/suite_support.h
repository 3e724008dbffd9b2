// Shared code of the W3C suites of this folder: known failures, a small store, the report's lines.
#ifndef DOCENT_TESTS_CONFORMANCE_SPARQL_SUITE_SUPPORT_H_
#define DOCENT_TESTS_CONFORMANCE_SPARQL_SUITE_SUPPORT_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_writer.h"
#include "graph/store/write_batch.h"

namespace docent {

// Lines of a file beneath tests/conformance: a test's name, then a remark.
std::map<std::string, std::string> ReadNotes(const std::string& file);
// known_failures.txt: the test's name → why it fails.
const std::map<std::string, std::string>& KnownFailures();

// Runs `run(test)` for each test: empty if it passes, else the reason. The test fails unless exactly one
// holds: it passes, or it is a known failure. Prints a line of the report: "conformance SUITE PASSED TOTAL".
template <typename Test, typename Run>
void RunSuite(const std::string& suite, const std::vector<Test>& tests, Run run);
void JudgeOne(const std::string& name, const std::string& why);
void ReportSuite(const std::string& suite, size_t passed, size_t total);

// The documents of a W3C test as a graph.
class SuiteStore {
 public:
  // The document at `iri` (beneath kW3cBase) into `graph`.
  void Load(const std::string& iri, const std::string& graph);
  // As the server would apply them.
  absl::Status Apply(std::vector<QuadOperation> operations);
  GraphVersionPtr Freeze() { return writer_.Freeze(Revision(++revision_)); }
  // All quads; those of docent:default without a graph.
  std::vector<TermQuad> Quads();

  Dictionary dictionary;

 private:
  GraphWriter writer_{nullptr};
  uint64_t revision_ = 0;
  int documents_ = 0;
};

template <typename Test, typename Run>
void RunSuite(const std::string& suite, const std::vector<Test>& tests, Run run) {
  size_t passed = 0;
  for (const Test& test : tests) {
    const std::string why = run(test);
    passed += why.empty() ? 1 : 0;
    JudgeOne(test.name, why);
  }
  ReportSuite(suite, passed, tests.size());
}

}  // namespace docent

#endif  // DOCENT_TESTS_CONFORMANCE_SPARQL_SUITE_SUPPORT_H_
