// The W3C SPARQL 1.0 and 1.1 query suites: syntax, evaluation, result formats. They are in $DOCENT_W3C_TESTS,
// else beside the source tree; skipped if absent. ../known_failures.txt lists the failing tests, each with
// its reason; a listed test that passes is an error, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <sstream>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/results/results.h"
#include "graph/sparql/run/describe.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/run/federation.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "tests/conformance/sparql/result_files.h"
#include "tests/conformance/sparql/suite_support.h"
#include "tests/conformance/sparql/w3c_manifest.h"

namespace docent {
namespace {

sparql::ParsedQuery Parse(const W3cQueryTest& test, const std::string& text) {
  sparql::ParseOptions options;
  options.base_iri = test.query;
  return sparql::ParseQuery(text, options);
}

absl::StatusOr<Answer> Run(sparql::Query query, bool ordered, const Dictionary& dictionary,
                           const GraphVersion& version, sparql::ServiceClient* services,
                           sparql::DefaultGraph mode) {
  sparql::PrepareOptions options;
  options.default_graph = mode;
  Cancellation cancellation(std::chrono::seconds(20));
  sparql::RunOptions run{&version, &cancellation, TimeMicros{1'700'000'000'000'000}, 1};
  absl::Status resolved = sparql::ResolveServices(&query, services, dictionary, options, run);
  if (!resolved.ok()) return resolved;
  auto prepared = sparql::PreparedQuery::Prepare(query, dictionary, options);
  if (!prepared.ok()) return prepared.status();
  Answer answer;
  if (query.form == sparql::Query::Form::kAsk) {
    const absl::StatusOr<bool> holds = (*prepared)->Ask(run);
    if (!holds.ok()) return holds.status();
    answer.boolean = *holds;
    return answer;
  }
  if (query.form != sparql::Query::Form::kSelect) {
    auto triples = sparql::AnswerGraph(**prepared, query, dictionary, options, run);
    if (!triples.ok()) return triples.status();
    answer.graph = *std::move(triples);
    return answer;
  }
  answer.variables = (*prepared)->variables();
  answer.ordered = ordered;
  const absl::Status status = (*prepared)->Select(run, {}, [&](absl::Span<const TermId> row) {
    std::map<std::string, Term> terms;
    for (size_t i = 0; i < row.size(); ++i) {
      if (!row[i].IsNone()) terms[answer.variables[i]] = (*prepared)->Decode(row[i]);
    }
    answer.rows.push_back(std::move(terms));
    return true;
  });
  if (!status.ok()) return status;
  return answer;
}

// The endpoints of a test, each a store of its own.
class Endpoints final : public sparql::ServiceClient {
 public:
  explicit Endpoints(const W3cQueryTest& test) {
    for (const auto& [endpoint, file] : test.services)
      stores_[endpoint].Load(file, std::string(kDefaultGraph));
  }
  absl::StatusOr<sparql::ServiceAnswer> Select(const std::string& endpoint, const std::string& query, bool,
                                               Cancellation*, MemoryUse*) override {
    const auto store = stores_.find(endpoint);
    if (store == stores_.end()) return absl::UnavailableError("there is no such endpoint");
    sparql::ParsedQuery parsed = sparql::ParseQuery(query);
    if (!parsed.ok()) return ToStatus(parsed.diagnostics, query);
    auto answer = Run(std::move(parsed.query), false, store->second.dictionary, *store->second.Freeze(), this,
                      sparql::DefaultGraph::kStrict);
    if (!answer.ok()) return answer.status();
    sparql::ServiceAnswer out{answer->variables, {}};
    for (const auto& given : answer->rows) {
      auto& row = out.rows.emplace_back();
      for (const std::string& name : out.variables) {
        row.push_back(given.contains(name) ? std::optional<Term>(given.at(name)) : std::nullopt);
      }
    }
    return out;
  }

 private:
  std::map<std::string, SuiteStore> stores_;
};

absl::StatusOr<Answer> Evaluate(const W3cQueryTest& test,
                                sparql::DefaultGraph mode = sparql::DefaultGraph::kStrict) {
  const std::string text = ReadText(W3cFile(test.query));
  sparql::ParsedQuery parsed = Parse(test, text);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, text);
  SuiteStore store;
  for (const std::string& file : test.data) store.Load(file, std::string(kDefaultGraph));
  for (const auto& [graph, file] : test.named) store.Load(file, graph);
  for (const auto* graphs : {&parsed.query.from, &parsed.query.from_named}) {
    for (const Term& graph : *graphs) {
      if (std::filesystem::exists(W3cFile(graph.lexical))) store.Load(graph.lexical, graph.lexical);
    }
  }
  Endpoints endpoints(test);
  const bool ordered = parsed.query.algebra->kind == sparql::Algebra::Kind::kOrderBy ||
                       text.find("ORDER") != std::string::npos;
  return Run(std::move(parsed.query), ordered, store.dictionary, *store.Freeze(), &endpoints, mode);
}

std::string Write(const Answer& answer, sparql::ResultFormat format) {
  std::string out;
  if (answer.boolean) return sparql::WriteBoolean(*answer.boolean, format);
  const auto writer = sparql::ResultWriter::Make(format, &out);
  writer->Begin(answer.variables);
  for (const auto& row : answer.rows) {
    std::vector<std::optional<Term>> cells;
    for (const std::string& name : answer.variables) {
      cells.push_back(row.contains(name) ? std::optional<Term>(row.at(name)) : std::nullopt);
    }
    writer->Row(cells);
  }
  writer->End();
  return out;
}

// The lines, sorted (CSV and TSV define no order if the query does not), with all blank nodes as
// "_:b".
std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(std::regex_replace(text, std::regex("_:[A-Za-z0-9]+"), "_:b"));
  for (std::string line; std::getline(in, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) out.push_back(line);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The answer that the suite expects.
Answer Expected(const W3cQueryTest& test, bool ordered) {
  const std::string text = ReadText(W3cFile(test.result));
  Answer expected;
  if (test.result.ends_with(".srx")) {
    expected = ReadXmlResult(text);
    expected.ordered = ordered;
  } else if (test.result.ends_with(".srj")) {
    expected = ReadJsonResult(text);
    expected.ordered = ordered;
  } else if (test.result.ends_with(".tsv")) {
    expected = ReadTsvResult(text);
  } else {
    ParseRdfOptions options;
    options.base_iri = test.result;
    const ParsedRdf parsed = ParseRdf(text, *FormatOfFile(test.result), options);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    expected = ReadRdfResult(parsed.quads);
  }
  return expected;
}

// Empty if the test passes, else the reason.
std::string RunOne(const W3cQueryTest& test) {
  using Kind = W3cQueryTest::Kind;
  const std::string text = ReadText(W3cFile(test.query));
  if (test.kind == Kind::kPositiveSyntax || test.kind == Kind::kNegativeSyntax) {
    const sparql::ParsedQuery parsed = Parse(test, text);
    if (parsed.ok() == (test.kind == Kind::kPositiveSyntax)) return "";
    return parsed.ok() ? "accepted, but it is wrong" : Render(parsed.diagnostics, text);
  }
  absl::StatusOr<Answer> answer = Evaluate(test);
  if (!answer.ok()) return std::string(answer.status().message());
  if (test.result.ends_with(".csv")) {  // CSV does not distinguish terms
    const std::string out = Write(*answer, sparql::ResultFormat::kCsv),
                      expected = ReadText(W3cFile(test.result));
    return Lines(out) == Lines(expected) ? "" : "got\n" + out + "expected\n" + expected;
  }
  if (test.result.ends_with(".tsv")) answer = ReadTsvResult(Write(*answer, sparql::ResultFormat::kTsv));
  if (test.result.ends_with(".srj")) {  // through our own writer
    const bool ordered = answer->ordered;
    answer = ReadJsonResult(Write(*answer, sparql::ResultFormat::kJson));
    answer->ordered = ordered;
  }
  const Answer expected = Expected(test, answer->ordered);
  if (SameAnswer(*answer, expected, test.lax)) return "";
  return "got\n" + ToText(*answer) + "expected\n" + ToText(expected);
}

// True if a test of a draft passes; its files may use syntax that Docent does not read.
bool TryOne(const W3cQueryTest& test) {
  using Kind = W3cQueryTest::Kind;
  const std::string text = ReadText(W3cFile(test.query));
  const sparql::ParsedQuery parsed = Parse(test, text);
  if (test.kind != Kind::kEvaluation) return parsed.ok() == (test.kind == Kind::kPositiveSyntax);
  if (!parsed.ok()) return false;
  std::vector<std::string> files = test.data;
  for (const auto& [graph, file] : test.named) files.push_back(file);
  if (test.result.ends_with(".ttl")) files.push_back(test.result);
  for (const std::string& file : files) {
    ParseRdfOptions options;
    options.base_iri = file;
    const std::optional<RdfFormat> format = FormatOfFile(file);
    if (!format || !ParseRdf(ReadText(W3cFile(file)), *format, options).ok()) return false;
  }
  return RunOne(test).empty();
}

class SparqlSuites : public testing::TestWithParam<const char*> {};

TEST_P(SparqlSuites, EveryTestPassesOrIsKnown) {
  const std::string folder = GetParam();
  if (!std::filesystem::exists(W3cRoot() / folder / "manifest.ttl")) {
    GTEST_SKIP() << "the W3C suites are not at " << W3cRoot()
                 << ": clone github.com/w3c/rdf-tests and set DOCENT_W3C_TESTS to it";
  }
  RunSuite("query " + folder, ReadQueryManifest(folder), RunOne);
}

constexpr const char* kFolders[] = {"sparql10/algebra",
                                    "sparql10/ask",
                                    "sparql10/basic",
                                    "sparql10/bnode-coreference",
                                    "sparql10/boolean-effective-value",
                                    "sparql10/bound",
                                    "sparql10/cast",
                                    "sparql10/construct",
                                    "sparql10/dataset",
                                    "sparql10/distinct",
                                    "sparql10/expr-builtin",
                                    "sparql10/expr-equals",
                                    "sparql10/expr-ops",
                                    "sparql10/graph",
                                    "sparql10/i18n",
                                    "sparql10/open-world",
                                    "sparql10/optional",
                                    "sparql10/optional-filter",
                                    "sparql10/reduced",
                                    "sparql10/regex",
                                    "sparql10/solution-seq",
                                    "sparql10/sort",
                                    "sparql10/syntax-sparql1",
                                    "sparql10/syntax-sparql2",
                                    "sparql10/syntax-sparql3",
                                    "sparql10/syntax-sparql4",
                                    "sparql10/syntax-sparql5",
                                    "sparql10/triple-match",
                                    "sparql10/type-promotion",
                                    "sparql11/aggregates",
                                    "sparql11/bind",
                                    "sparql11/bindings",
                                    "sparql11/cast",
                                    "sparql11/construct",
                                    "sparql11/csv-tsv-res",
                                    "sparql11/exists",
                                    "sparql11/functions",
                                    "sparql11/grouping",
                                    "sparql11/json-res",
                                    "sparql11/negation",
                                    "sparql11/project-expression",
                                    "sparql11/service",
                                    "sparql11/property-path",
                                    "sparql11/subquery",
                                    "sparql11/syntax-fed",
                                    "sparql11/syntax-query"};

INSTANTIATE_TEST_SUITE_P(W3c, SparqlSuites, testing::ValuesIn(kFolders), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

// With the union of all graphs as the default graph, as the server runs without --default-graph strict,
// answers may differ in tests with named graphs and no FROM. union_differences.txt lists these tests, each
// with the reason.
TEST(SparqlUnionMode, DifferencesAreThoseListed) {
  if (!std::filesystem::exists(W3cRoot() / "sparql10"))
    GTEST_SKIP() << "the W3C suites are not at " << W3cRoot();
  const std::map<std::string, std::string> listed = ReadNotes("sparql/union_differences.txt");
  size_t same = 0, total = 0;
  for (const char* folder : kFolders) {
    for (const W3cQueryTest& test : ReadQueryManifest(folder)) {
      if (test.kind != W3cQueryTest::Kind::kEvaluation || test.result.ends_with(".csv") ||
          KnownFailures().contains(test.name))
        continue;
      ++total;
      const absl::StatusOr<Answer> answer = Evaluate(test, sparql::DefaultGraph::kUnion);
      const bool equal = answer.ok() && SameAnswer(*answer, Expected(test, answer->ordered), test.lax);
      same += equal ? 1 : 0;
      EXPECT_EQ(!equal, listed.contains(test.name)) << test.name;
    }
  }
  std::printf("conformance union-mode %zu %zu\n", same, total);
}

// Report on a draft that is not a recommendation yet: numbers, no verdict.
TEST(Sparql12, Report) {
  if (!std::filesystem::exists(W3cRoot() / "sparql12"))
    GTEST_SKIP() << "the W3C suites are not at " << W3cRoot();
  for (const auto& folder : std::filesystem::directory_iterator(W3cRoot() / "sparql12")) {
    if (!std::filesystem::exists(folder.path() / "manifest.ttl")) continue;
    const std::string name = "sparql12/" + folder.path().filename().string();
    size_t passed = 0;
    const std::vector<W3cQueryTest> tests = ReadQueryManifest(name);
    for (const W3cQueryTest& test : tests) passed += TryOne(test) ? 1 : 0;
    std::printf("conformance draft %s %zu %zu\n", name.c_str(), passed, tests.size());
  }
}

}  // namespace
}  // namespace docent
