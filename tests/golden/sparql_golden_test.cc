// Golden cases of tests/golden/sparql: a query's algebra and answer, and the diagnostics of a wrong query.
#include <gtest/gtest.h>

#include <algorithm>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/results/results.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "tests/golden/golden_file.h"

namespace docent {
namespace {

class SparqlGolden : public testing::TestWithParam<std::string> {};

std::string Answer(const sparql::Query& query, const std::string& trig) {
  Dictionary dictionary;
  GraphWriter writer(nullptr);
  const ParsedRdf data = ParseRdf(trig, RdfFormat::kTriG);
  EXPECT_TRUE(data.ok()) << Render(data.diagnostics, trig);
  for (const TermQuad& q : data.quads) {
    writer.Add({dictionary.Intern(q.subject), dictionary.Intern(q.predicate), dictionary.Intern(q.object),
                q.graph.lexical.empty() ? dictionary.InternIri(kDefaultGraph) : dictionary.Intern(q.graph)});
  }
  const GraphVersionPtr version = writer.Freeze(Revision(1));
  auto prepared = sparql::PreparedQuery::Prepare(query, dictionary);
  if (!prepared.ok()) return std::string(prepared.status().message()) + "\n";
  const sparql::RunOptions run{version.get(), nullptr, TimeMicros{1'700'000'000'000'000}, 1};
  if (query.form == sparql::Query::Form::kAsk) return *(*prepared)->Ask(run) ? "true\n" : "false\n";
  std::string out;
  if (query.form == sparql::Query::Form::kConstruct) {
    std::vector<std::string> lines;
    const absl::StatusOr<std::vector<TermQuad>> triples = (*prepared)->Construct(run);
    EXPECT_TRUE(triples.ok()) << triples.status();
    if (!triples.ok()) return out;
    for (const TermQuad& t : *triples) {
      lines.push_back(ToNTriples(t.subject) + " " + ToNTriples(t.predicate) + " " + ToNTriples(t.object) +
                      " .\n");
    }
    std::sort(lines.begin(), lines.end());
    for (const std::string& line : lines) out += line;
    return out;
  }
  const auto rows = sparql::ResultWriter::Make(sparql::ResultFormat::kTsv, &out);
  rows->Begin((*prepared)->variables());
  EXPECT_TRUE((*prepared)
                  ->Select(run, {},
                           [&](absl::Span<const TermId> row) {
                             std::vector<std::optional<Term>> cells;
                             for (const TermId id : row)
                               cells.push_back(id.IsNone() ? std::optional<Term>() : (*prepared)->Decode(id));
                             rows->Row(cells);
                             return true;
                           })
                  .ok());
  rows->End();
  return out;
}

TEST_P(SparqlGolden, MeansAndAnswersAsExpected) {
  const std::filesystem::path root = std::filesystem::path(DOCENT_SOURCE_DIR) / "tests/golden/sparql";
  const std::filesystem::path folder = root / GetParam();
  const std::string text = golden::ReadFile(folder / "query.rq");
  const bool own_data = std::filesystem::exists(folder / "data.trig");
  sparql::ParseOptions options;
  options.file = "query.rq";
  const sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  std::string got;
  if (!parsed.ok()) {
    got = Render(parsed.diagnostics, text);
  } else {
    got = "# algebra\n" + sparql::PrintAlgebra(*parsed.query.algebra) + "\n# text\n" +
          sparql::PrintQuery(parsed.query, {parsed.query.prefixes, true}) + "# answer\n" +
          Answer(parsed.query, golden::ReadFile(own_data ? folder / "data.trig" : root / "hall.trig"));
  }
  golden::Compare(folder, got);
}

INSTANTIATE_TEST_SUITE_P(Cases, SparqlGolden, testing::ValuesIn(golden::Cases("sparql")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent
