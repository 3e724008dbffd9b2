// A small graph from TriG text, and queries on it, for the tests of this folder.
#ifndef DOCENT_TESTS_GRAPH_SPARQL_TEST_GRAPH_H_
#define DOCENT_TESTS_GRAPH_SPARQL_TEST_GRAPH_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"

namespace docent::sparql {

class TestGraph {
 public:
  TestGraph() = default;
  explicit TestGraph(const std::string& trig) { Add(trig); }

  // `text` knows the well-known prefixes and ex:.
  void Add(const std::string& text) {
    std::string all = "PREFIX ex: <http://example.org/>\n";
    for (const auto& [prefix, iri] : WellKnownPrefixes()) all += "PREFIX " + prefix + ": <" + iri + ">\n";
    all += text;
    const ParsedRdf parsed = ParseRdf(all, RdfFormat::kTriG);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, all);
    for (const TermQuad& q : parsed.quads) {
      const TermId graph =
          q.graph.lexical.empty() ? dictionary.InternIri(kDefaultGraph) : dictionary.Intern(q.graph);
      writer_.Add(
          {dictionary.Intern(q.subject), dictionary.Intern(q.predicate), dictionary.Intern(q.object), graph});
    }
    version = writer_.Freeze(Revision(++revision_));
  }

  RunOptions Run() const { return {version.get(), nullptr, TimeMicros{1'700'000'000'000'000}, 7}; }

  Query Parse(const std::string& text) const {
    ParseOptions options;
    options.prefixes = WellKnownPrefixes();
    options.prefixes.emplace_back("ex", "http://example.org/");
    ParsedQuery parsed = ParseQuery(text, options);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    return std::move(parsed.query);
  }

  std::unique_ptr<PreparedQuery> Prepare(const std::string& text, const PrepareOptions& options = {}) const {
    auto prepared = PreparedQuery::Prepare(Parse(text), dictionary, options);
    EXPECT_TRUE(prepared.ok()) << prepared.status();
    return prepared.ok() ? *std::move(prepared) : nullptr;
  }

  bool Ask(const std::string& text, const PrepareOptions& options = {}) const {
    const absl::StatusOr<bool> holds = Prepare(text, options)->Ask(Run());
    EXPECT_TRUE(holds.ok()) << holds.status();
    return holds.ok() && *holds;
  }

  // Each row as its terms in display form separated by spaces ("-" where unbound); sorted unless `ordered`.
  std::vector<std::string> Rows(const std::string& text, const PrepareOptions& options = {},
                                bool ordered = false) const {
    const auto query = Prepare(text, options);
    std::vector<std::string> out;
    if (!query) return out;
    const absl::Status status = query->Select(Run(), {}, [&](absl::Span<const TermId> row) {
      std::string line;
      for (const TermId id : row) {
        const std::string cell = id.IsNone() ? "-" : Show(query->Decode(id));
        line += (line.empty() ? "" : " ") + cell;
      }
      out.push_back(line);
      return true;
    });
    EXPECT_TRUE(status.ok()) << status;
    if (!ordered) std::sort(out.begin(), out.end());
    return out;
  }

  Dictionary dictionary;
  GraphVersionPtr version = std::make_shared<const GraphVersion>();

 private:
  static std::string Show(const Term& t) {
    const std::string ex = "http://example.org/";
    if (t.IsIri() && t.lexical.starts_with(ex)) return t.lexical.substr(ex.size());
    if (t.IsLiteral() && t.language.empty()) return t.lexical;
    return ToNTriples(t);
  }

  GraphWriter writer_{nullptr};
  uint64_t revision_ = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_TESTS_GRAPH_SPARQL_TEST_GRAPH_H_
