// A request has one memory and one cancellation from its first byte on: each production of the grammar, repeated, ends at the
// memory of the request, really holds about what is counted, and ends when it is cancelled.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "graph/base/memory_budget.h"
#include "graph/sparql/run/update_evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "tests/graph/sparql/budget/counted_memory.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

constexpr size_t kMiB = 1u << 20;

// `first`, then `more` with N for a number, `times` times, then `last`.
struct Bomb {
  const char* name;
  std::string first, more, last;

  std::string Text(size_t times) const {
    std::string text = first;
    for (size_t i = 0; i < times; ++i) {
      for (const char c : more) {
        if (c == 'N') {
          text += std::to_string(i);
        } else {
          text.push_back(c);
        }
      }
    }
    return text + last;
  }
};

const Bomb kQueries[] = {
    {"in", "SELECT * { FILTER(1 IN (0", ",N", ")) }"},
    {"same in", "SELECT * { FILTER(1 IN (0", ",1", ")) }"},
    {"long texts in", "SELECT * { FILTER(1 IN (0", ",\"a text that is not short N\"", ")) }"},
    {"or", "SELECT * { FILTER(1=0", "||1=0", ") }"},
    {"arguments", "SELECT (CONCAT(\"\"", ",\"a\"", ") AS ?x) {}"},
    {"variables in arguments", "SELECT (COALESCE(?x", ",?vN", ") AS ?y) {}"},
    {"values", "SELECT * { VALUES ?x {", " N", "} }"},
    {"texts in values", "SELECT * { VALUES ?x {", " \"a text that is not short N\"", "} }"},
    {"columns of values", "SELECT * { VALUES (", " ?vN", ") {} }"},
    {"rows of values", "SELECT * { VALUES () {", "()", "} }"},
    {"path", "SELECT * { ?s <u:p>", "/<u:p>", " ?o }"},
    {"path of others", "SELECT * { ?s <u:p>", "/<u:N>", " ?o }"},
    {"alternatives", "SELECT * { ?s <u:p>", "|<u:N>", " ?o }"},
    {"closure", "SELECT * { ?s (<u:p>", "/<u:N>", ")* ?o }"},
    {"negated", "SELECT * { ?s !(<u:p>", "|^<u:N>", ") ?o }"},
    {"path to many", "SELECT * { ?s <u:p>/<u:q>/<u:r> 0", ",N", " }"},
    {"closure to many", "SELECT * { ?s (<u:p>/<u:q>/<u:r>)+ 0", ",N", " }"},
    {"patterns", "SELECT * {", "?xN <u:p> ?yN .", "}"},
    {"chain", "SELECT * {", "?xN <u:p> ?x .", "}"},
    {"objects", "SELECT * { ?x ?p 0", ",N", " }"},
    {"lists", "SELECT * { ?x ?p (0", " N", ") }"},
    {"blank nodes", "SELECT * { ?x ?p []", ",[]", " }"},
    {"labels", "SELECT * { ?x ?p _:b", ",_:bN", " }"},
    {"unions", "SELECT * { {}", "UNION{}", " }"},
    {"groups", "SELECT * { ", "{?a ?b ?c}", " }"},
    {"optional", "SELECT * { ", "OPTIONAL{?a ?b ?cN}", " }"},
    {"minus", "SELECT * { ?a ?b ?c ", "MINUS{?a ?b ?cN}", " }"},
    {"binds", "SELECT * { ", "BIND(1 AS ?vN)", " }"},
    {"exists", "SELECT * { ?a ?b ?c ", "FILTER EXISTS{?a ?b ?vN}", " }"},
    {"filters on many", "SELECT * { ?a ?b ?c ", ". ?a ?b ?dN FILTER(?dN > 1)", " }"},
    {"graphs", "SELECT * { ", "GRAPH ?g {?a ?b ?c}", " }"},
    {"paths", "SELECT * { ", "?a <u:p>* ?b . ", " }"},
    {"select", "SELECT ", " ?vN", " { ?a ?b ?c }"},
    {"computed", "SELECT ?a ", "(1 AS ?vN)", " { ?a ?b ?c }"},
    {"keys", "SELECT * { SELECT (COUNT(*) AS ?n) { ?a ?b ?c } GROUP BY ?a ", " ?vN", "}"},
    {"having", "SELECT (COUNT(*) AS ?n) { ?a ?b ?c } HAVING (1=1)", "(1=1)", ""},
    {"order", "SELECT * { ?a ?b ?c } ORDER BY ?a", " ?vN", ""},
    {"aggregates", "SELECT (1", "+COUNT(?a)", " AS ?n) { ?a ?b ?c }"},
    {"construct", "CONSTRUCT {", "?s ?p N .", "} { ?s ?p ?o }"},
    {"construct where", "CONSTRUCT WHERE {", "?s ?p N .", "}"},
    {"describe", "DESCRIBE <u:a>", "<u:N>", ""},
    {"from", "SELECT * ", "FROM <u:N> ", "{ ?s ?p ?o }"},
    {"prefixes", "", "PREFIX pN: <u:N> ", "ASK {}"},
    {"base", "", "BASE <u:N> ", "ASK {}"},
    {"comments", "ASK {", "# N\n", "}"},
    {"escapes", "SELECT * {", "?s \\u003fp\\u0061 ?o .", "}"},
    {"escaped texts", "SELECT * { FILTER(1 IN (0", ",\"\\t\\tN\"", ")) }"},
    {"long name", "SELECT * { ?s <u:", "aaaaaaaaaaaaaaaa", "> 1,2,3,4,5,6,7,8,9 }"},
    {"long subject",
     "SELECT * { <u:aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa> ?p 0", ",N", " }"},
    {"prefixed",
     "PREFIX p: <u:aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa> ASK { ?s ?p p:a", ",p:N",
     "}"},
    {"errors", "ASK {", "%", "}"},
    {"words", "ASK {", "wordN ", "}"},
    {"expressions", "SELECT * { FILTER(1 IN (0", ",REGEX(STR(?x),\"aN\")", ")) }"},
    {"service", "SELECT * { ", "SERVICE <u:s> {?a ?b ?cN}", " }"},
};

const Bomb kUpdates[] = {
    {"insert data", "INSERT DATA {", "<u:a><u:b>1.", "}"},
    {"insert other data", "INSERT DATA {", "<u:N><u:b>N.", "}"},
    {"insert objects", "INSERT DATA {<u:a><u:b>0", ",N", "}"},
    {"insert into a graph", "INSERT DATA { GRAPH <u:aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa> {",
     "<u:a><u:b>N.", "}}"},
    {"insert into graphs", "INSERT DATA {", "GRAPH<u:N>{<u:a><u:b>1}", "}"},
    {"labels", "INSERT DATA {", "_:bN<u:b>1.", "}"},
    {"delete data", "DELETE DATA {", "<u:a><u:b>N.", "}"},
    {"delete where", "DELETE WHERE {", "<u:a><u:b>N.", "}"},
    {"operations", "", "INSERT DATA{};", ""},
    {"clear", "", "CLEAR SILENT ALL;", ""},
    {"clear graphs", "", "CLEAR SILENT GRAPH<u:N>;", ""},
    {"modify", "", "INSERT{?s ?p N}WHERE{?s ?p ?o};", ""},
    {"modify its own", "INSERT DATA{<u:a><u:b>0}", ";INSERT{?s ?p N}WHERE{?s ?p ?o}", ""},
    {"using", "INSERT {<u:a> <u:b> <u:c>} ", "USING <u:N> ", "WHERE {}"},
    {"template", "INSERT {", "?s ?p N.", "} WHERE { ?s ?p ?o }"},
    {"template of blank nodes", "INSERT {", "[] ?p [].", "} WHERE { ?s ?p ?o }"},
    {"values", "INSERT {<u:a> <u:b> ?x} WHERE { VALUES ?x {", "N ", "} }"},
    {"in", "INSERT {<u:a> <u:b> ?x} WHERE { BIND(IF(1 IN (", "1,", "1), 1, 2) AS ?x) }"},
    {"path", "INSERT { ?s <urn:q> ?o } WHERE { ?s <u:p>", "/<u:p>", " ?o }"},
};

class RequestBudget : public testing::Test {
 public:
  RequestBudget() : g_("ex:a ex:p ex:b . ex:b ex:p ex:c .") {
    parse_.limits.query_text_bytes = parse_.limits.update_text_bytes = 64 * kMiB;
    parse_.query_limits = {SIZE_MAX, SIZE_MAX, SIZE_MAX, SIZE_MAX, SIZE_MAX};
  }

  absl::Status Query(const std::string& text, MemoryUse* memory, Cancellation* cancellation) {
    parse_.memory = memory;
    parse_.cancellation = cancellation;
    ParsedQuery parsed = ParseQuery(text, parse_);
    if (!parsed.ok()) return ToStatus(parsed, text);
    PrepareOptions options;
    options.memory = memory;
    options.cancellation = cancellation;
    auto prepared = PreparedQuery::Prepare(std::move(parsed.query), g_.dictionary, options);
    if (!prepared.ok()) return prepared.status();
    RunOptions run = g_.Run();
    run.cancellation = cancellation;
    return (*prepared)->Select(run, {}, [](absl::Span<const TermId>) { return true; });
  }

  absl::Status Update(const std::string& text, MemoryUse* memory, Cancellation* cancellation) {
    parse_.memory = memory;
    parse_.cancellation = cancellation;
    const ParsedUpdate parsed = ParseUpdate(text, parse_);
    if (!parsed.ok()) return ToStatus(parsed, text);
    UpdateOptions options;
    options.prepare.memory = memory;
    RunOptions run = g_.Run();
    run.cancellation = cancellation;
    return EvaluateUpdate(parsed.update, g_.dictionary, run, options).status();
  }

  using Evaluate = absl::Status (RequestBudget::*)(const std::string&, MemoryUse*, Cancellation*);

  // What is really held stays near what may be held, however long the text.
  void ExpectBounded(const Bomb& bomb, Evaluate evaluate) {
    constexpr size_t kLimit = 8 * kMiB;
    for (const size_t times : {1000, 10000, 100000}) {
      const std::string text = bomb.Text(times);
      MemoryUse memory(kLimit);
      const CountedMemory counted;
      const absl::Status status = (this->*evaluate)(text, &memory, nullptr);
      EXPECT_LT(counted.peak(), kLimit + kLimit / 2) << bomb.name << " " << times << " " << status;
      if (times == 1000 || status.ok()) continue;
      EXPECT_TRUE(absl::IsResourceExhausted(status) || absl::IsInvalidArgument(status) ||
                  absl::IsUnimplemented(status))
          << bomb.name << " " << times << " " << status;
    }
  }

  // Cancelled at each of the first looks, it ends there.
  void ExpectEnds(const Bomb& bomb, Evaluate evaluate) {
    const std::string text = bomb.Text(20000);
    for (int last = 1; last < 1000; last *= 2) {
      MemoryUse memory(size_t{1} << 30);
      Cancellation cancellation;
      int looks = 0;
      cancellation.OnLook([&](const Cancellation&) {
        if (++looks == last) cancellation.Cancel();
      });
      const absl::Status status = (this->*evaluate)(text, &memory, &cancellation);
      if (looks < last) return;  // it is done before, or wrong
      EXPECT_TRUE(absl::IsCancelled(status)) << bomb.name << " " << last << " " << status;
      EXPECT_LE(looks, last + 64) << bomb.name;
    }
  }

  TestGraph g_;
  ParseOptions parse_;
};

TEST_F(RequestBudget, QueriesHoldWhatIsCounted) {
  for (const Bomb& bomb : kQueries) ExpectBounded(bomb, &RequestBudget::Query);
}

TEST_F(RequestBudget, UpdatesHoldWhatIsCounted) {
  for (const Bomb& bomb : kUpdates) ExpectBounded(bomb, &RequestBudget::Update);
}

TEST_F(RequestBudget, ParsingAndPlanningEndWhenTheyAreCancelled) {
  for (const Bomb& bomb : kQueries) ExpectEnds(bomb, &RequestBudget::Query);
  for (const Bomb& bomb : kUpdates) ExpectEnds(bomb, &RequestBudget::Update);
}

TEST_F(RequestBudget, AllIsGivenBack) {
  MemoryBudget all("all_bytes", size_t{1} << 30);
  for (const Bomb& bomb : kUpdates) {
    MemoryUse memory(64 * kMiB, &all);
    Update(bomb.Text(5000), &memory, nullptr).IgnoreError();
  }
  for (const Bomb& bomb : kQueries) {
    MemoryUse memory(64 * kMiB, &all);
    Query(bomb.Text(5000), &memory, nullptr).IgnoreError();
  }
  EXPECT_EQ(all.taken(), 0u);
}

}  // namespace
}  // namespace docent::sparql
