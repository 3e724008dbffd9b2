// The SPARQL engine alone: standing ASKs with constants prepared once and run again and again, joins over
// 100k triples, parsing and preparing. Beside the two-pattern ASK stands its floor, the same lookups written
// by hand on the store. Numbers with machine and date: bench/README.md.
#include <benchmark/benchmark.h>

#include <string>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"

namespace docent::sparql {
namespace {

// 10,000 visitors and robots: type, place, name, and seven readings each, in all 100,000 triples.
struct Hall {
  Hall() {
    GraphWriter writer(nullptr);
    const auto iri = [&](const std::string& name) { return dictionary.InternIri("urn:" + name); };
    const TermId graph = dictionary.InternIri(kDefaultGraph), type = dictionary.InternIri(kRdfType);
    std::vector<Quad> quads;
    for (int i = 0; i < 10000; ++i) {
      const TermId who = iri("a" + std::to_string(i));
      quads.push_back({who, type, iri(i % 10 == 0 ? "Robot" : "Visitor"), graph});
      quads.push_back({who, iri("isAt"), iri("B" + std::to_string(i % 200)), graph});
      quads.push_back(
          {who, iri("name"), dictionary.Intern(Term::Literal("name " + std::to_string(i))), graph});
      for (int k = 0; k < 7; ++k) {
        quads.push_back(
            {who, iri("reading" + std::to_string(k)), dictionary.Intern(Term::Integer(i * 7 + k)), graph});
      }
    }
    writer.AddAll(quads);
    version = writer.Freeze(Revision(1));
  }
  std::unique_ptr<PreparedQuery> Prepare(const std::string& text, std::vector<std::string> bound = {}) {
    ParseOptions options;
    options.prefixes = {{"", "urn:"}};
    const ParsedQuery parsed = ParseQuery(text, options);
    PrepareOptions prepare;
    prepare.bound = std::move(bound);
    return *PreparedQuery::Prepare(parsed.query, dictionary, prepare);
  }
  RunOptions Run() { return {version.get(), nullptr, 0, 0}; }

  Dictionary dictionary;
  GraphVersionPtr version;
};

Hall& TheHall() {
  static auto* hall = new Hall;
  return *hall;
}

void RunAsk(benchmark::State& state, const std::string& text) {
  const auto ask = TheHall().Prepare(text);
  const RunOptions run = TheHall().Run();
  for (auto _ : state) benchmark::DoNotOptimize(*ask->Ask(run));
}

void BM_AskTwoPatternsConstant(benchmark::State& state) {
  RunAsk(state, "ASK { :a10 :isAt :B10 . :a210 :isAt :B10 }");
}
void BM_AskTwoPatternsJoin(benchmark::State& state) {
  RunAsk(state, "ASK { :a10 :isAt ?b . :a210 :isAt ?b }");
}
void BM_AskTwoPatternsFalse(benchmark::State& state) {
  RunAsk(state, "ASK { :a10 :isAt ?b . :a11 :isAt ?b }");
}
void BM_AskWithFilter(benchmark::State& state) {
  RunAsk(state, "ASK { :a10 :reading3 ?x FILTER(?x > 50.5) }");
}
void BM_AskNotExists(benchmark::State& state) {
  RunAsk(state, "ASK { :a10 :isAt ?b FILTER NOT EXISTS { ?v a :Visitor ; :isAt ?b } }");
}

void BM_AskFloorByHand(benchmark::State& state) {
  Hall& hall = TheHall();
  const TermId at = *hall.dictionary.FindIri("urn:isAt"), b = *hall.dictionary.FindIri("urn:B10");
  const TermId x = *hall.dictionary.FindIri("urn:a10"), y = *hall.dictionary.FindIri("urn:a210");
  for (auto _ : state) {
    benchmark::DoNotOptimize(hall.version->Scan({x, at, b, {}}).Valid() &&
                             hall.version->Scan({y, at, b, {}}).Valid());
  }
}

void BM_SeededAsk(benchmark::State& state) {
  const auto ask =
      TheHall().Prepare("ASK { ?r :isAt ?b . ?v :isAt ?b . ?v a :Robot FILTER(?v != ?r) }", {"r"});
  const TermId robot = *TheHall().dictionary.FindIri("urn:a10");
  const RunOptions run = TheHall().Run();
  for (auto _ : state) benchmark::DoNotOptimize(*ask->Ask(run, {robot}));
}

void RunSelect(benchmark::State& state, const std::string& text) {
  const auto query = TheHall().Prepare(text);
  int64_t rows = 0;
  for (auto _ : state) {
    (void)query->Select(TheHall().Run(), {}, [&](absl::Span<const TermId>) { return ++rows > 0; });
  }
  state.SetItemsProcessed(rows);
}

void BM_SelectStar(benchmark::State& state) {
  RunSelect(state, "SELECT * { ?s :isAt ?b }");
}
void BM_SelectJoin(benchmark::State& state) {
  RunSelect(state, "SELECT ?r ?v { ?v :isAt ?b . ?r a :Robot . ?r :isAt ?b }");
}
void BM_CountGroups(benchmark::State& state) {
  RunSelect(state, "SELECT ?b (COUNT(*) AS ?n) { ?s :isAt ?b } GROUP BY ?b");
}

constexpr char kText[] =
    "PREFIX : <urn:>\nASK { ?r a :Robot ; :isAt ?b . ?v a :Visitor ; :isAt ?b . FILTER(?r != ?v) }";
void BM_Parse(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(ParseQuery(kText));
}
void BM_PrepareAndPlan(benchmark::State& state) {
  const ParsedQuery parsed = ParseQuery(kText);
  for (auto _ : state) {
    auto query = *PreparedQuery::Prepare(parsed.query, TheHall().dictionary);
    benchmark::DoNotOptimize(query->Start(TheHall().Run()));
  }
}

BENCHMARK(BM_AskFloorByHand);
BENCHMARK(BM_AskTwoPatternsConstant);
BENCHMARK(BM_AskTwoPatternsJoin);
BENCHMARK(BM_AskTwoPatternsFalse);
BENCHMARK(BM_AskWithFilter);
BENCHMARK(BM_AskNotExists);
BENCHMARK(BM_SeededAsk);
BENCHMARK(BM_SelectStar)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_SelectJoin)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_CountGroups)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Parse)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_PrepareAndPlan)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace docent::sparql

BENCHMARK_MAIN();
