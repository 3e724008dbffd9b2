// The W3C SPARQL 1.0 and 1.1 query suites: syntax, evaluation, result formats. They are looked for in
// $DOCENT_W3C_TESTS, else beside the source tree; skipped where they are not. ../known_failures.txt
// lists what fails, each with its reason; a test listed there that passes is an error, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <sstream>

#include "kb_server/rdf/parser.h"
#include "kb_server/rdf/vocabulary.h"
#include "kb_server/sparql/algebra_printer.h"
#include "kb_server/sparql/evaluator.h"
#include "kb_server/sparql/parser.h"
#include "kb_server/sparql/results.h"
#include "kb_server/store/graph_writer.h"
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

absl::StatusOr<Answer> Evaluate(const W3cQueryTest& test, std::string* csv = nullptr) {
  const std::string text = ReadText(W3cFile(test.query));
  const sparql::ParsedQuery parsed = Parse(test, text);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, text);
  SuiteStore store;
  for (const std::string& file : test.data) store.Load(file, std::string(kDefaultGraph));
  for (const auto& [graph, file] : test.named) store.Load(file, graph);
  for (const auto* graphs : {&parsed.query.from, &parsed.query.from_named}) {
    for (const Term& graph : *graphs) {
      if (std::filesystem::exists(W3cFile(graph.lexical))) store.Load(graph.lexical, graph.lexical);
    }
  }
  const GraphVersionPtr version = store.Freeze();
  sparql::PrepareOptions options;
  options.default_graph = sparql::DefaultGraph::kStrict;
  auto query = sparql::PreparedQuery::Prepare(parsed.query, store.dictionary, options);
  if (!query.ok()) return query.status();
  Cancellation cancellation(std::chrono::seconds(20));
  sparql::RunOptions run{version.get(), &cancellation, TimeMicros{1'700'000'000'000'000}, 1};
  Answer answer;
  if ((*query)->form() == sparql::Query::Form::kAsk) {
    const absl::StatusOr<bool> holds = (*query)->Ask(run);
    if (!holds.ok()) return holds.status();
    answer.boolean = *holds;
    return answer;
  }
  if ((*query)->form() == sparql::Query::Form::kConstruct) {
    auto triples = (*query)->Construct(run);
    if (!triples.ok()) return triples.status();
    answer.graph = *std::move(triples);
    return answer;
  }
  answer.variables = (*query)->variables();
  answer.ordered = parsed.query.algebra->kind == sparql::Algebra::Kind::kOrderBy ||
                   text.find("ORDER") != std::string::npos;
  std::unique_ptr<sparql::ResultWriter> writer;
  if (csv != nullptr) {
    writer = sparql::ResultWriter::Make(
        test.result.ends_with(".csv") ? sparql::ResultFormat::kCsv : sparql::ResultFormat::kTsv, csv);
    writer->Begin(answer.variables);
  }
  const absl::Status status = (*query)->Select(run, {}, [&](absl::Span<const TermId> row) {
    std::map<std::string, Term> terms;
    std::vector<std::optional<Term>> cells;
    for (size_t i = 0; i < row.size(); ++i) {
      cells.emplace_back();
      if (row[i].IsNone()) continue;
      terms[answer.variables[i]] = (*query)->Decode(row[i]);
      cells.back() = terms[answer.variables[i]];
    }
    if (writer) writer->Row(cells);
    answer.rows.push_back(std::move(terms));
    return true;
  });
  if (!status.ok()) return status;
  return answer;
}

// The lines, sorted (CSV and TSV say nothing of order where the query does not), with all blank nodes as
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

// Empty if the test passes, else why not.
std::string RunOne(const W3cQueryTest& test) {
  using Kind = W3cQueryTest::Kind;
  const std::string text = ReadText(W3cFile(test.query));
  if (test.kind == Kind::kPositiveSyntax || test.kind == Kind::kNegativeSyntax) {
    const sparql::ParsedQuery parsed = Parse(test, text);
    if (parsed.ok() == (test.kind == Kind::kPositiveSyntax)) return "";
    return parsed.ok() ? "accepted, but it is wrong" : Render(parsed.diagnostics, text);
  }
  if (test.result.ends_with(".csv") || test.result.ends_with(".tsv")) {
    std::string out;
    const absl::StatusOr<Answer> answer = Evaluate(test, &out);
    if (!answer.ok()) return std::string(answer.status().message());
    const std::string expected = ReadText(W3cFile(test.result));
    return Lines(out) == Lines(expected) ? "" : "got\n" + out + "expected\n" + expected;
  }
  const absl::StatusOr<Answer> answer = Evaluate(test);
  if (!answer.ok()) return std::string(answer.status().message());
  const std::string expected_text = ReadText(W3cFile(test.result));
  Answer expected;
  if (test.result.ends_with(".srx")) {
    expected = ReadXmlResult(expected_text);
    expected.ordered = answer->ordered;
  } else if (test.result.ends_with(".srj")) {
    expected = ReadJsonResult(expected_text);
    expected.ordered = answer->ordered;
  } else {
    ParseRdfOptions options;
    options.base_iri = test.result;
    const ParsedRdf parsed = ParseRdf(expected_text, *FormatOfFile(test.result), options);
    EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, expected_text);
    expected = ReadRdfResult(parsed.quads);
  }
  if (SameAnswer(*answer, expected, test.lax)) return "";
  return "got\n" + ToText(*answer) + "expected\n" + ToText(expected);
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
                                    "sparql11/property-path",
                                    "sparql11/subquery",
                                    "sparql11/syntax-fed",
                                    "sparql11/syntax-query"};

INSTANTIATE_TEST_SUITE_P(W3c, SparqlSuites, testing::ValuesIn(kFolders), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

}  // namespace
}  // namespace docent
