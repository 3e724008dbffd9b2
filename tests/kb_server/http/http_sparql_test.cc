#include "kb_server/http/http_sparql.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "graph/base/gzip.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr char kJson[] = "application/sparql-results+json";

// A server over a small graph: <urn:r1> at <urn:b3> in the default graph, <urn:r2> at <urn:b4> in graph
// <urn:g>.
class HttpSparqlTest : public ::testing::Test {
 protected:
  void SetUp() override { Start({}); }

  void Start(Limits limits, int workers = 2, size_t queue = 100) {
    server_.reset();
    pool_ = std::make_unique<WorkerPool>(WorkerPoolLimits{workers, /*open=*/8, queue});
    GraphWriter writer(std::make_shared<const GraphVersion>());
    Tell(writer, "urn:r1", Term::Iri("urn:b3"), kDefaultGraph);
    Tell(writer, "urn:r2", Term::Iri("urn:b4"), "urn:g");
    for (int i = 0; i < 300; ++i)
      writer.Add({Id("urn:s" + std::to_string(i)), Id("urn:many"), Id("urn:o"), Id(kDefaultGraph)});
    queries_.Publish(writer.Freeze(Revision(7)));
    ports_.queries = &queries_;
    ports_.dictionary = &dictionary_;
    ports_.workers = pool_.get();
    ports_.clock = &clock_;
    ports_.limits = limits;
    HttpRoutes routes;
    AddSparqlRoutes(&routes, &ports_, &metrics_);
    HttpServerOptions options;
    options.listen = "127.0.0.1:0";
    auto server = HttpServer::Start(options, std::move(routes));
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }

  TermId Id(std::string_view iri) { return dictionary_.InternIri(iri); }
  void Tell(GraphWriter& writer, std::string_view subject, const Term& object, std::string_view graph) {
    writer.Add({Id(subject), Id("urn:isAt"), dictionary_.Intern(object), Id(graph)});
  }

  static std::string Escape(const std::string& text) {
    std::string out;
    for (const unsigned char c : text) {
      out += absl::StrCat("%", absl::Hex(c, absl::kZeroPad2));
    }
    return out;
  }

  HttpReply Get(const std::string& query, const std::string& accept = "", const std::string& more = "") {
    HttpClient client(server_->port());
    return client.Ask("GET", "/sparql?query=" + Escape(query) + more,
                      accept.empty() ? "" : "Accept: " + accept + "\r\n");
  }

  Dictionary dictionary_;
  QueryPort queries_;
  ManualClock clock_{1800000000000000};
  Metrics metrics_;
  ServicePorts ports_;
  std::unique_ptr<WorkerPool> pool_;
  std::unique_ptr<HttpServer> server_;  // goes first
};

// The network's threads serve everybody: unpacking is for a worker, of which there is none free here.
TEST_F(HttpSparqlTest, APackedOrLargeBodyIsReadByAWorker) {
  Start({}, 1);
  HttpRoutes routes;
  AddSparqlRoutes(&routes, &ports_,
                  &metrics_);  // it outlives the pool, whose work counts there when it is done
  const auto ask = [&](const std::string& type, const std::string& body, bool packed) {
    HttpRequest request;
    request.method = "POST";
    request.path = request.raw_path = "/sparql";
    request.headers = {{"content-type", type}};
    if (packed) request.headers.emplace_back("content-encoding", "gzip");
    request.body = body;
    HttpResponse refusal;
    const auto answer = std::make_shared<HttpAnswer>();
    routes.Find(request, &refusal)->handler(std::make_shared<HttpExchange>(std::move(request), answer));
    return answer;
  };
  absl::Notification busy, go;
  pool_->Submit({.run =
                     [&] {
                       busy.Notify();
                       go.WaitForNotification();
                     },
                 .refuse = nullptr});
  busy.WaitForNotification();
  const std::string large = "query=" + std::string(100000, 'x');
  const std::vector<std::shared_ptr<HttpAnswer>> answers = {
      ask("application/sparql-update", "this is not gzip", true),
      ask("application/x-www-form-urlencoded", large, false),
      ask("application/sparql-query", Gzip("ASK {}"), true)};
  for (const auto& answer : answers) EXPECT_FALSE(answer->Take().head) << "the network's thread read it";
  go.Notify();
  std::vector<int> statuses;
  for (const auto& answer : answers) {
    absl::Notification answered;
    answer->OnProgress([&answered] { answered.Notify(); });
    answered.WaitForNotification();
    statuses.push_back(answer->Take().head->status);
  }
  EXPECT_EQ(statuses, (std::vector<int>{400, 400, 200}));
}

TEST_F(HttpSparqlTest, SelectInEachForm) {
  const std::string query = "SELECT ?b WHERE { <urn:r1> <urn:isAt> ?b }";
  const HttpReply json = Get(query);
  EXPECT_EQ(json.status, 200) << json.body;
  EXPECT_EQ(json.headers.at("content-type"), kJson);
  EXPECT_EQ(json.headers.at("docent-revision"), "7");
  EXPECT_THAT(json.body, HasSubstr("\"urn:b3\""));
  const HttpReply csv = Get(query, "text/csv");
  EXPECT_EQ(csv.headers.at("content-type"), "text/csv; charset=utf-8");
  EXPECT_EQ(csv.body, "b\r\nurn:b3\r\n");
  const HttpReply tsv = Get(query, "text/tab-separated-values");
  EXPECT_EQ(tsv.body, "?b\n<urn:b3>\n");
  const HttpReply xml = Get(query, "application/sparql-results+xml");
  EXPECT_EQ(xml.headers.at("content-type"), "application/sparql-results+xml");
  EXPECT_THAT(xml.body, HasSubstr("<uri>urn:b3</uri>"));
  EXPECT_EQ(Get(query, "application/json").headers.at("content-type"), "application/json");
  const HttpReply picture = Get(query, "image/png");
  EXPECT_EQ(picture.status, 406);
  EXPECT_THAT(picture.body, HasSubstr("text/csv"));
}

TEST_F(HttpSparqlTest, AskAndConstruct) {
  const HttpReply ask = Get("ASK { <urn:r1> <urn:isAt> <urn:b3> }");
  EXPECT_EQ(ask.status, 200) << ask.body;
  EXPECT_THAT(ask.body, HasSubstr("true"));
  EXPECT_THAT(Get("ASK { <urn:r1> <urn:isAt> <urn:b9> }").body, HasSubstr("false"));
  const std::string construct = "CONSTRUCT { ?b <urn:has> ?r } WHERE { ?r <urn:isAt> ?b }";
  const HttpReply triples = Get(construct, "application/n-triples");
  EXPECT_EQ(triples.headers.at("content-type"), "application/n-triples");
  EXPECT_THAT(triples.body, HasSubstr("<urn:b3> <urn:has> <urn:r1> .\n"));
  EXPECT_THAT(triples.body, HasSubstr("<urn:b4> <urn:has> <urn:r2> .\n"));
  const HttpReply turtle = Get(construct);
  EXPECT_EQ(turtle.headers.at("content-type"), "text/turtle; charset=utf-8");
  EXPECT_EQ(turtle.headers.at("docent-revision"), "7");
  EXPECT_THAT(turtle.body, HasSubstr("<urn:has>"));
}

TEST_F(HttpSparqlTest, ALargeGraphIsSentInPieces) {
  const std::string construct =
      "CONSTRUCT { ?s ?p ?t } WHERE { ?s ?p <urn:o> . ?x <urn:many> <urn:o> BIND(CONCAT(STR(?s), STR(?x)) AS "
      "?t) }";
  const HttpReply reply = Get(construct, "application/n-triples");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.headers.at("transfer-encoding"), "chunked");
  EXPECT_EQ(reply.headers.at("content-type"), "application/n-triples");
  EXPECT_TRUE(reply.whole);
  EXPECT_GT(reply.body.size(), 1u << 20);
  EXPECT_EQ(std::count(reply.body.begin(), reply.body.end(), '\n'), 300 * 300);
  EXPECT_TRUE(reply.body.ends_with(" .\n"));
}

TEST_F(HttpSparqlTest, ThreeWaysToSendAQuery) {
  const std::string query = "SELECT ?b { <urn:r1> <urn:isAt> ?b }";
  HttpClient client(server_->port());
  const HttpReply plain =
      client.Ask("POST", "/sparql", "Content-Type: application/sparql-query\r\nAccept: text/csv\r\n", query);
  EXPECT_EQ(plain.body, "b\r\nurn:b3\r\n");
  const std::string form =
      "Content-Type: application/x-www-form-urlencoded; charset=UTF-8\r\nAccept: text/csv\r\n";
  EXPECT_EQ(client.Ask("POST", "/sparql", form, "timeout=1000&query=" + Escape(query)).body,
            "b\r\nurn:b3\r\n");
  EXPECT_EQ(Get(query, "text/csv").body, "b\r\nurn:b3\r\n");
  const HttpReply other = client.Ask("POST", "/sparql", "Content-Type: text/plain\r\n", query);
  EXPECT_EQ(other.status, 415);
  EXPECT_THAT(other.body, HasSubstr("not as text/plain"));
  EXPECT_EQ(client.Ask("POST", "/sparql", "Content-Type: application/sparql-query; charset=UTF-16\r\n", query)
                .status,
            415);
  EXPECT_EQ(client.Ask("POST", "/sparql", "", query).status, 415);
  EXPECT_EQ(client.Ask("PUT", "/sparql", "", query).status, 405);
}

TEST_F(HttpSparqlTest, MalformedQueryNamesLineAndColumn) {
  const HttpReply reply = Get("SELECT ?b\nWHERE { <urn:r1> <urn:isAt> }");
  EXPECT_EQ(reply.status, 400);
  EXPECT_EQ(reply.headers.at("content-type"), "text/plain; charset=utf-8");
  EXPECT_THAT(reply.body, StartsWith("2:"));
  EXPECT_THAT(reply.body, HasSubstr("error: "));
  EXPECT_THAT(reply.body, HasSubstr("WHERE { <urn:r1> <urn:isAt> }"));
  EXPECT_THAT(reply.body, HasSubstr("^"));
}

TEST_F(HttpSparqlTest, BadParameters) {
  const std::string ask = "ASK {}";
  HttpClient client(server_->port());
  EXPECT_EQ(client.Ask("GET", "/sparql?timeout=5").status, 400);
  EXPECT_EQ(
      client.Ask("POST", "/sparql", "Content-Type: application/x-www-form-urlencoded\r\n", "x=1").status,
      400);
  EXPECT_EQ(client.Ask("GET", "/sparql?query=ASK%7B%7D&query=ASK%7B%7D").status, 400);
  EXPECT_EQ(client.Ask("GET", "/sparql?update=CLEAR%20ALL").status, 405);
  EXPECT_EQ(Get(ask, "", "&using-graph-uri=urn:g").status, 400);
  EXPECT_EQ(Get(ask, "", "&timeout=0").status, 400);
  EXPECT_EQ(Get(ask, "", "&timeout=soon").status, 400);
  EXPECT_EQ(Get(ask, "", "&min-revision=x").status, 400);
  EXPECT_EQ(Get(ask, "", "&default-graph-uri=g").status, 400);
  EXPECT_EQ(Get(ask, "", "&default-graph-uri=urn:g%201").status, 400);
  EXPECT_EQ(Get(ask, "", "&as-of=3").status, 501);
  EXPECT_EQ(Get(ask, "", "&asof=3").status, 400);
  EXPECT_EQ(Get(ask, "", "&unknown=1").status, 200);
  // counted when it is sent to its end, which its client can see first
  const char* counted = "docent_sparql_requests_total{outcome=\"answered\"} 1\n";
  for (int i = 0; i < 1000 && !absl::StrContains(metrics_.Render(), counted); ++i)
    absl::SleepFor(absl::Milliseconds(10));
  EXPECT_THAT(metrics_.Render(), HasSubstr(counted));
}

TEST_F(HttpSparqlTest, WithoutAQueryTheServiceDescribesItself) {
  HttpClient client(server_->port());
  const HttpReply reply = client.Ask("GET", "/sparql", "Accept: application/n-triples\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_THAT(reply.body, HasSubstr("sparql-service-description#endpoint> <http://localhost:" +
                                    std::to_string(server_->port()) + "/sparql>"));
  EXPECT_THAT(reply.body, HasSubstr("#name> <urn:g>"));
  EXPECT_EQ(client.Ask("GET", "/sparql", "Accept: image/png\r\n").status, 406);
}

TEST_F(HttpSparqlTest, GraphsOfTheProtocolReplaceFrom) {
  const std::string query = "SELECT ?r { ?r <urn:isAt> ?b }";
  EXPECT_EQ(Get(query, "text/csv", "&default-graph-uri=urn:g").body, "r\r\nurn:r2\r\n");
  EXPECT_EQ(Get("SELECT ?r FROM <urn:g> { ?r <urn:isAt> ?b }", "text/csv",
                "&default-graph-uri=" + Escape(std::string(kDefaultGraph)))
                .body,
            "r\r\nurn:r1\r\n");
  EXPECT_EQ(Get("SELECT ?g { GRAPH ?g { ?r <urn:isAt> ?b } }", "text/csv", "&named-graph-uri=urn:g").body,
            "g\r\nurn:g\r\n");
}

TEST_F(HttpSparqlTest, MinRevisionWaits) {
  EXPECT_EQ(Get("ASK {}", "", "&min-revision=7").status, 200);
  const HttpReply late = Get("ASK {}", "", "&min-revision=8&timeout=20");
  EXPECT_EQ(late.status, 504);
  EXPECT_THAT(late.body, HasSubstr("revision 8 is not here yet; the newest is 7"));
}

TEST_F(HttpSparqlTest, LargeAnswerIsStreamed) {
  // 300 × 300 rows.
  const HttpReply reply = Get("SELECT ?a ?b { ?a <urn:many> ?o . ?b <urn:many> ?o }", "text/csv");
  EXPECT_EQ(reply.status, 200);
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.headers.at("transfer-encoding"), "chunked");
  EXPECT_EQ(reply.headers.at("docent-revision"), "7");
  EXPECT_EQ(std::count(reply.body.begin(), reply.body.end(), '\n'), 90001);
}

TEST_F(HttpSparqlTest, TimeoutEndsAQuery) {
  const std::string endless =
      "SELECT (COUNT(*) AS ?n) { ?a <urn:many> ?x . ?b <urn:many> ?x . ?c <urn:many> ?x . ?d <urn:many> ?x . "
      "?e <urn:many> ?x }";
  const HttpReply reply = Get(endless, "", "&timeout=50");
  EXPECT_EQ(reply.status, 504) << reply.body;
  EXPECT_THAT(reply.body, HasSubstr("query_timeout_ms = 50"));
}

TEST_F(HttpSparqlTest, QueryOfAClientThatWentIsCancelled) {
  Start({}, /*workers=*/1);
  {
    HttpClient client(server_->port());
    client.Send(absl::StrCat(
        "GET /sparql?query=",
        Escape("SELECT (COUNT(*) AS ?n) { ?a <urn:many> ?x . ?b <urn:many> ?x . ?c <urn:many> ?x . "
               "?d <urn:many> ?x . ?e <urn:many> ?x . ?f <urn:many> ?x }"),
        " HTTP/1.1\r\nHost: localhost:", server_->port(), "\r\n\r\n"));
    while (server_->counts().requests == 0) std::this_thread::yield();
  }
  // The only worker is free again long before that query would have ended.
  EXPECT_EQ(Get("ASK {}").status, 200);
}

TEST_F(HttpSparqlTest, FullQueueIsRefused) {
  Start({}, /*workers=*/1, /*queue=*/0);
  const HttpReply reply = Get("ASK {}");
  EXPECT_EQ(reply.status, 503);
  EXPECT_EQ(reply.headers.at("retry-after"), "1");
}

TEST_F(HttpSparqlTest, QueryTextLimit) {
  Limits limits;
  limits.query_text_bytes = 20;
  Start(limits);
  EXPECT_EQ(Get("ASK {              }").status, 200);  // 20 bytes
  const HttpReply reply = Get("ASK {               }");
  EXPECT_EQ(reply.status, 413);
  EXPECT_THAT(reply.body, HasSubstr("the query has 21 bytes; the limit query_text_bytes is 20"));
}

}  // namespace
}  // namespace docent::server
