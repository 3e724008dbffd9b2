#include "kb_server/work/query_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/memory_budget.h"
#include "kb_server/door/ports.h"
#include "kb_server/work/known_prefixes.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

// Records the calls, a line each.
class RecordingSink final : public QuerySink {
 public:
  bool OnBegin(sparql::Query::Form, Revision revision) override {
    lines.push_back(absl::StrCat("begin ", revision.value()));
    return wanted;
  }
  void OnPlan(std::string plan) override { lines.push_back("plan " + plan); }
  void OnBoolean(bool answer) override { lines.push_back(answer ? "true" : "false"); }
  void OnHeader(const std::vector<std::string>& variables) override {
    lines.push_back("header " + absl::StrJoin(variables, " "));
  }
  absl::Status CheckRow(size_t bytes) override {
    return bytes <= row_bytes ? absl::OkStatus() : absl::OutOfRangeError("the row is too long");
  }
  absl::Status OnRow(const std::vector<std::optional<Term>>& row) override {
    std::string line = "row";
    for (const auto& term : row) absl::StrAppend(&line, " ", term ? ToNTriples(*term) : "-");
    lines.push_back(line);
    return on_row;
  }
  void OnEnd() override { lines.push_back("end"); }
  absl::Status OnGraph(std::vector<TermQuad> triples,
                       const std::vector<std::pair<std::string, std::string>>& prefixes) override {
    for (const auto& [prefix, iri] : prefixes) lines.push_back("prefix " + prefix);
    for (const TermQuad& t : triples) {
      lines.push_back(
          absl::StrCat(ToNTriples(t.subject), " ", ToNTriples(t.predicate), " ", ToNTriples(t.object)));
    }
    return absl::OkStatus();
  }

  std::vector<std::string> lines;
  bool wanted = true;
  size_t row_bytes = 1u << 20;
  absl::Status on_row;
};

// A graph, a dictionary and a sink: no server.
class QueryRunnerTest : public ::testing::Test {
 protected:
  QueryRunnerTest() {
    Publish("<urn:a> <urn:p> 1 . <urn:b> <urn:p> 2 . GRAPH <urn:g> { <urn:c> <urn:p> 3 }");
    ports_.queries = &queries_;
    ports_.dictionary = &graph_.dictionary;
    ports_.workers = &workers_;
    ports_.clock = &clock_;
  }

  void Publish(const std::string& trig) {
    graph_.Add(trig);
    queries_.Publish(graph_.version);
  }

  absl::Status Run(const QueryRequest& request) {
    return QueryRunner(&ports_).Run(request, &cancellation_, &sink_);
  }
  absl::Status Run(const std::string& text) {
    QueryRequest request;
    request.text = text;
    return Run(request);
  }
  std::vector<std::string> LinesOf(const QueryRequest& request) {
    const absl::Status status = Run(request);
    EXPECT_TRUE(status.ok()) << status;
    return std::exchange(sink_.lines, {});
  }
  std::vector<std::string> LinesOf(const std::string& text) {
    QueryRequest request;
    request.text = text;
    return LinesOf(request);
  }

  sparql::TestGraph graph_;
  QueryPort queries_;
  ManualClock clock_{1800000000000000};
  WorkerPool workers_{WorkerPoolLimits{/*running=*/1, /*open=*/1, /*queue=*/1}};
  Cancellation cancellation_;
  ReadPorts ports_;
  RecordingSink sink_;
};

TEST_F(QueryRunnerTest, RowsComeBetweenHeaderAndEnd) {
  EXPECT_THAT(
      LinesOf("SELECT ?s ?none { ?s <urn:p> ?o } ORDER BY ?s"),
      ElementsAre("begin 1", "header s none", "row <urn:a> -", "row <urn:b> -", "row <urn:c> -", "end"));
  EXPECT_THAT(LinesOf("SELECT ?s { ?s <urn:none> ?o }"), ElementsAre("begin 1", "header s", "end"));
}

TEST_F(QueryRunnerTest, AskAnswersABoolean) {
  EXPECT_THAT(LinesOf("ASK { <urn:a> <urn:p> 1 }"), ElementsAre("begin 1", "true"));
  EXPECT_THAT(LinesOf("ASK { <urn:a> <urn:p> 2 }"), ElementsAre("begin 1", "false"));
}

TEST_F(QueryRunnerTest, ConstructAndDescribeAnswerAGraphWithThePrefixesOfTheQuery) {
  EXPECT_THAT(LinesOf("PREFIX x: <urn:> CONSTRUCT { ?s x:q x:o } WHERE { ?s x:p 1 }"),
              ElementsAre("begin 1", "prefix x", "<urn:a> <urn:q> <urn:o>"));
  EXPECT_THAT(LinesOf("DESCRIBE <urn:b>"),
              ElementsAre("begin 1", "<urn:b> <urn:p> \"2\"^^<http://www.w3.org/2001/XMLSchema#integer>"));
}

TEST_F(QueryRunnerTest, ExplainAnswersThePlanAlone) {
  QueryRequest request;
  request.text = "SELECT ?s { ?s <urn:p> ?o }";
  request.explain = true;
  EXPECT_THAT(LinesOf(request), ElementsAre("begin 1", StartsWith("plan ")));
}

TEST_F(QueryRunnerTest, TheRequestGivesDataSetAndBase) {
  QueryRequest request;
  request.text = "SELECT ?s { ?s <p> ?o } ORDER BY ?s";
  request.base_iri = "urn:x";
  EXPECT_THAT(LinesOf(request), SizeIs(6)) << "<p> is <urn:p>";
  request.default_graph = sparql::DefaultGraph::kStrict;
  EXPECT_THAT(LinesOf(request), ElementsAre("begin 1", "header s", "row <urn:a>", "row <urn:b>", "end"));
  request.default_graphs = {Term::Iri("urn:g")};
  EXPECT_THAT(LinesOf(request), ElementsAre("begin 1", "header s", "row <urn:c>", "end"));
}

TEST_F(QueryRunnerTest, PrefixesOfLoadedDocumentsNeedNoDeclaration) {
  QueryRequest request;
  request.text = "ASK { x:a x:p 1 }";
  EXPECT_FALSE(QueryRunner(&ports_).Run(request, &cancellation_, &sink_).ok());
  auto catalog = std::make_shared<Catalog>();
  auto workflow = std::make_shared<cawl::Document>();
  workflow->prefixes = {{"x", "urn:"}};
  catalog->workflows.emplace_back(workflow, Revision());
  CatalogPort port;
  port.Publish(catalog);
  KnownPrefixes prefixes(&port);
  ports_.prefixes = &prefixes;
  EXPECT_THAT(LinesOf(request), ElementsAre("begin 1", "true"));
  request.text = "PREFIX x: <urn:other:> " + request.text;
  EXPECT_THAT(LinesOf(request), ElementsAre("begin 1", "false")) << "a declaration counts more";
}

TEST_F(QueryRunnerTest, AnAnswerThatIsNotWantedIsNotMade) {
  sink_.wanted = false;
  EXPECT_THAT(LinesOf("SELECT * { ?s ?p ?o }"), ElementsAre("begin 1"));
}

TEST_F(QueryRunnerTest, ASyntaxErrorNamesItsPlace) {
  const absl::Status status = Run("SELECT ?s {\n  ?s <urn:p> }");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("2:14"));
  EXPECT_THAT(sink_.lines, IsEmpty());
}

TEST_F(QueryRunnerTest, ATextBeyondItsLimitIsRefused) {
  ports_.limits.query_text_bytes = 10;
  EXPECT_TRUE(Run("ASK {     }").code() == absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(Run("ASK {    }").ok());
}

TEST_F(QueryRunnerTest, MemoryOfAQueryAndOfItsLongestRowIsLimited) {
  ports_.limits.query_memory_bytes = 100'000;
  const std::string sorted = "SELECT ?s (STR(?o) AS ?text) { ?s ?p ?o . ?s2 ?p2 ?o2 } ORDER BY ?text";
  EXPECT_TRUE(Run(sorted).ok());
  const std::string label(30'000, 'x');
  Publish("<urn:long> <urn:label> '" + label + "' .");
  sink_.lines.clear();
  const absl::Status status =
      Run("SELECT ?o { <urn:long> <urn:label> ?o }");  // four copies of it are on their way
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("query_memory_bytes"));
  EXPECT_THAT(sink_.lines, ElementsAre("begin 2", "header o"));
  ports_.limits.query_memory_bytes = 200'000;
  EXPECT_TRUE(Run("SELECT ?o { <urn:long> <urn:label> ?o }").ok());
}

TEST_F(QueryRunnerTest, WhatAllQueriesKeepIsCountedAndGivenBack) {
  MemoryBudget all("queries_memory_bytes", 1u << 20);
  ports_.query_memory = &all;
  const std::string label(600'000, 'x');
  Publish("<urn:long> <urn:label> '" + label + "' .");
  const absl::Status status = Run("SELECT ?o { <urn:long> <urn:label> ?o }");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("queries_memory_bytes"));
  EXPECT_EQ(all.taken(), 0u);
}

TEST_F(QueryRunnerTest, TheSinkRefusesARow) {
  sink_.row_bytes = 8;
  EXPECT_EQ(Run("SELECT ?s ?p { ?s ?p 1 }").code(), absl::StatusCode::kOutOfRange);
  EXPECT_THAT(std::exchange(sink_.lines, {}), ElementsAre("begin 1", "header s p"));
  sink_.row_bytes = 100;
  sink_.on_row = absl::CancelledError("the client went away");
  EXPECT_EQ(Run("SELECT ?s { ?s ?p ?o }").code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(sink_.lines.size(), 3u);  // begin, header, and the row that it did not take
}

TEST_F(QueryRunnerTest, TimeoutAndCancellationEndARun) {
  std::string many;
  for (int i = 0; i < 400; ++i) absl::StrAppend(&many, "<urn:s", i, "> <urn:q> ", i, " . ");
  Publish(many);
  const std::string text = "ASK { ?a <urn:q> ?x . ?b <urn:q> ?y . ?c <urn:q> ?z . FILTER(?x + ?y + ?z < 0) }";
  QueryRequest request;
  request.text = text;
  Cancellation short_time(std::chrono::milliseconds(5));
  EXPECT_EQ(QueryRunner(&ports_).Run(request, &short_time, &sink_).code(),
            absl::StatusCode::kDeadlineExceeded);
  cancellation_.Cancel();
  EXPECT_EQ(Run(text).code(), absl::StatusCode::kCancelled);
}

TEST_F(QueryRunnerTest, ThePastNeedsAHistoryAndOtherServersAList) {
  QueryRequest request;
  request.text = "ASK {}";
  request.as_of = "1";
  EXPECT_EQ(Run(request).code(), absl::StatusCode::kUnimplemented);
  request.as_of = "yesterday";
  EXPECT_EQ(Run(request).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Run("SELECT * { SERVICE <http://localhost/> { ?s ?p ?o } }").code(),
            absl::StatusCode::kPermissionDenied);
}

}  // namespace
}  // namespace docent::server
