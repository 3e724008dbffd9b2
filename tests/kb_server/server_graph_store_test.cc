// Updates, the graph store and other servers over HTTP, through a whole server. The parts that W3C suites of
// these protocols cover are in tests/conformance/http.
#include <gmock/gmock.h>

#include <fstream>

#include "graph/base/gzip.h"
#include "tests/kb_server/http/http_client.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kTurtle[] = "Content-Type: text/turtle\r\n";
constexpr char kUpdate[] = "Content-Type: application/sparql-update\r\n";
constexpr char kForm[] = "Content-Type: application/x-www-form-urlencoded\r\n";

class GraphStoreTest : public ServerTest {
 protected:
  HttpReply Ask(const std::string& method, const std::string& target, const std::string& headers = "",
                const std::string& body = "") {
    return HttpClient(http_port()).Ask(method, target, headers, body);
  }
  bool Holds(const std::string& pattern) { return ServerTest::Ask(pattern); }
  HttpReply Update(const std::string& text, const std::string& parameters = "") {
    return Ask("POST", "/sparql" + parameters, kUpdate, "PREFIX : <urn:w:> " + text);
  }
};

TEST_F(GraphStoreTest, AnUpdateOverHttpSaysWhatItDid) {
  StartServer();
  HttpReply reply = Update("INSERT DATA { :a :p 1, 2 }");
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_THAT(reply.body, HasSubstr("\"added\":2"));
  EXPECT_EQ(reply.headers.at("docent-revision"), absl::StrCat(Revision()));
  reply = Ask("POST", "/sparql", kForm, "update=DELETE+WHERE+%7B+%3Furn+%3Fp+1+%7D");
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_TRUE(Holds(":a :p 2") && !Holds(":a :p 1"));
  reply = Update("INSERT DATA { ?x :p 1 }");
  EXPECT_EQ(reply.status, 400);
  EXPECT_THAT(reply.body, HasSubstr("^"));
  EXPECT_EQ(Update("INSERT DATA { :b :p [] }", "?request-id=r1").status, 200);
  EXPECT_THAT(Update("INSERT DATA { :b :p [] }", "?request-id=r1").body, HasSubstr("\"repeated\":true"));
  EXPECT_EQ(Update("CREATE GRAPH :g ; INSERT DATA { GRAPH :g { :a :b :c } } ; CREATE GRAPH :g").status, 400);
  EXPECT_EQ(Update("CLEAR ALL", "?default-graph-uri=urn:x").status, 400);
}

// As Java and Python clients ask, which prefer RDF/XML and accept other formats.
TEST_F(GraphStoreTest, WhatRdfXmlCannotSayIsSaidOtherwise) {
  StartServer();
  const std::string graph = "/rdf-graphs?graph=urn:w:g";
  const std::string construct = "/sparql?query=CONSTRUCT%20WHERE%20%7B%20%3Curn:w:a%3E%20?p%20?o%20%7D";
  const std::string both = "Accept: application/rdf+xml, text/html;q=0.9, */*;q=0.1\r\n",
                    xml = "Accept: application/rdf+xml\r\n";
  for (const char* triple : {"<urn:w:a> <http://e/1> 2 .", "<urn:w:a> <urn:w:p> \"\\u0001\" ."}) {
    ASSERT_LT(Ask("PUT", graph, kTurtle, triple).status, 300);
    const HttpReply other = Ask("GET", graph, both);
    EXPECT_EQ(other.status, 200) << other.body;
    EXPECT_EQ(other.headers.at("content-type"), "text/turtle; charset=utf-8");
    EXPECT_THAT(other.body, HasSubstr("<urn:w:a> "));
    const HttpReply none = Ask("GET", graph, xml);
    EXPECT_EQ(none.status, 406);
    EXPECT_THAT(none.body, HasSubstr("use Turtle"));
    EXPECT_EQ(Ask("GET", graph, xml + "Accept: application/n-triples;q=0.2\r\n").headers.at("content-type"),
              "application/n-triples");
  }
  ASSERT_EQ(Ask("PUT", graph, kTurtle, "<urn:w:a> <urn:w:p> 2 .").status, 200);
  EXPECT_EQ(Ask("GET", graph, both).headers.at("content-type"), "application/rdf+xml");
  EXPECT_EQ(Ask("GET", construct, both).status, 200);
  ASSERT_EQ(Ask("PUT", graph, kTurtle, "<urn:w:a> <http://e/1> 2 .").status, 200);
  EXPECT_EQ(Ask("GET", construct, both).headers.at("content-type"), "text/turtle; charset=utf-8");
  EXPECT_EQ(Ask("GET", construct, xml).status, 406);
}

TEST_F(GraphStoreTest, AGraphsLife) {
  StartServer();
  const std::string graph = "/rdf-graphs?graph=urn:w:g";
  EXPECT_EQ(Ask("GET", graph).status, 404);
  EXPECT_EQ(Ask("GET", graph).headers.at("accept-patch"), "application/sparql-update") << "which makes it";
  EXPECT_EQ(Ask("DELETE", graph).status, 404);
  EXPECT_EQ(Ask("PUT", graph, kTurtle, "<urn:w:a> <urn:w:p> 1 , 2 .").status, 201);
  EXPECT_EQ(Ask("PUT", graph, kTurtle, "<urn:w:a> <urn:w:p> 2 , 3 .").status, 200);
  EXPECT_EQ(Ask("POST", graph, kTurtle, "<urn:w:a> <urn:w:p> 4 .").status, 200);
  EXPECT_EQ(Ask("PATCH", graph, kUpdate, "DELETE { ?s ?p 2 } INSERT { ?s ?p 5 } WHERE { ?s ?p 2 }").status,
            200);
  HttpReply reply = Ask("GET", graph, "Accept: application/n-triples\r\n");
  EXPECT_EQ(reply.status, 200);
  EXPECT_THAT(reply.body, HasSubstr("\"5\""));
  EXPECT_EQ(std::count(reply.body.begin(), reply.body.end(), '\n'), 3);
  EXPECT_EQ(Ask("HEAD", graph).headers.at("content-type"), "text/turtle; charset=utf-8");
  EXPECT_EQ(Ask("HEAD", graph).headers.at("accept-patch"), "application/sparql-update");
  EXPECT_EQ(Ask("PATCH", graph, kTurtle, "").headers.at("accept-patch"), "application/sparql-update");
  EXPECT_EQ(Ask("DELETE", graph).status, 200);
  EXPECT_EQ(Ask("GET", graph).status, 404);
  EXPECT_EQ(Ask("GET", "/rdf-graphs?default").status, 200) << "the default graph is always there";
}

// Both were one graph, and the second PUT took the first one's triples.
TEST_F(GraphStoreTest, AnAddressBelowTheStoreHasNoParametersOfItsOwn) {
  StartServer();
  const HttpReply refused = Ask("PUT", "/rdf-graphs/doc?v=1", kTurtle, "<urn:w:a> <urn:w:p> 1 .");
  EXPECT_EQ(refused.status, 400);
  EXPECT_THAT(refused.body, HasSubstr("no parameter \"v\""));
  EXPECT_THAT(refused.body, HasSubstr("?graph=IRI"));
  for (const char* method : {"GET", "HEAD", "DELETE", "POST", "PATCH"})
    EXPECT_EQ(Ask(method, "/rdf-graphs/doc?v", kTurtle, "").status, 400) << method;
  EXPECT_EQ(Ask("PUT", "/rdf-graphs/doc", kTurtle, "<urn:w:a> <urn:w:p> 1 .").status, 201);
  EXPECT_EQ(Ask("GET", "/rdf-graphs/doc?min-revision=1").status, 200);
  EXPECT_EQ(Ask("GET", "/rdf-graphs/doc?").status, 200);
}

TEST_F(GraphStoreTest, TheGraphIsTheBaseAndTheDefaultGraphHasNone) {
  StartServer();
  EXPECT_EQ(Ask("PUT", "/rdf-graphs?graph=http://e/d/g%23frag", kTurtle, "<#a> <p> <> .").status, 201);
  EXPECT_TRUE(Holds("GRAPH <http://e/d/g#frag> { <http://e/d/g#a> <http://e/d/p> <http://e/d/g> }"));
  const std::string xml =
      "<r:RDF xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><r:Bag r:about=''><r:li "
      "r:resource='#x'/></r:Bag></r:RDF>";
  EXPECT_EQ(Ask("PUT", "/rdf-graphs?graph=http://e/d/h%23frag", "Content-Type: application/rdf+xml\r\n", xml)
                .status,
            201);
  EXPECT_TRUE(Holds("GRAPH <http://e/d/h#frag> { <http://e/d/h> rdf:_1 <http://e/d/h#x> }"));
  for (const char* target : {"/rdf-graphs?default", "/rdf-graphs?graph=https://w3id.org/docent%23default"}) {
    for (const auto& [type, body] : {std::pair<std::string, std::string>(kTurtle, "<#isAt> <#p> <Robot> ."),
                                     {"Content-Type: application/rdf+xml\r\n", xml}}) {
      const HttpReply reply = Ask("POST", target, type, body);
      EXPECT_EQ(reply.status, 400) << target;
      EXPECT_THAT(reply.body, HasSubstr("is relative and the document has no base IRI"));
    }
    EXPECT_EQ(Ask("PATCH", target, kUpdate, "INSERT DATA { <#a> <#b> 1 }").status, 400);
    EXPECT_EQ(Ask("POST", target, kTurtle, "@base <http://e/> . <#a> <p> 1 .").status, 200) << "its own base";
  }
  EXPECT_TRUE(Holds("<http://e/#a> <http://e/p> 1"));
}

TEST_F(GraphStoreTest, PackedBodiesAreRead) {
  StartServer();
  const std::string graph = "/rdf-graphs?graph=urn:w:z", packed = "Content-Encoding: gzip\r\n";
  EXPECT_EQ(Ask("PUT", graph, kTurtle + packed, Gzip("<urn:w:a> <urn:w:p> 1 .")).status, 201);
  EXPECT_TRUE(Holds("GRAPH :z { :a :p 1 }"));
  EXPECT_EQ(Ask("POST", graph, std::string(kTurtle) + "Content-Encoding: X-GZIP\r\n",
                Gzip("<urn:w:a> <urn:w:p> 2 ."))
                .status,
            200);
  EXPECT_EQ(Ask("POST", graph, kTurtle, Gzip("<urn:w:a> <urn:w:p> 3 .")).status, 200)
      << "a .gz file as it is";
  EXPECT_TRUE(Holds("GRAPH :z { :a :p 1, 2, 3 }"));
  EXPECT_EQ(Ask("POST", "/sparql", kUpdate + packed, Gzip("INSERT DATA { <urn:w:b> <urn:w:p> 1 }")).status,
            200);
  EXPECT_EQ(
      Ask("POST", "/sparql", kForm + packed, Gzip("update=INSERT+DATA+%7B+%3Curn:w:b%3E+%3Curn:w:p%3E+2+%7D"))
          .status,
      200);
  EXPECT_EQ(Ask("PATCH", graph, kUpdate + packed, Gzip("INSERT DATA { <urn:w:b> <urn:w:p> 3 }")).status, 200);
  EXPECT_TRUE(Holds(":b :p 1, 2") && Holds("GRAPH :z { :b :p 3 }"));
  const std::string bomb = Gzip(std::string(65u << 20, ' '));
  const HttpReply large = Ask("PUT", graph, kTurtle + packed, bomb);
  EXPECT_EQ(large.status, 413);
  EXPECT_THAT(large.body, HasSubstr("http_body_bytes = 67108864"));
  EXPECT_EQ(Ask("POST", "/sparql", kUpdate + packed, bomb).status, 413);
  EXPECT_EQ(Ask("PUT", graph, kTurtle + packed, "no gzip").status, 400);
  EXPECT_EQ(Ask("PUT", graph, std::string(kTurtle) + "Content-Encoding: br\r\n", "x").status, 415);
  const HttpReply json = Ask("PUT", graph, "Content-Type: application/ld+json\r\n", "{}");
  EXPECT_EQ(json.status, 415);
  EXPECT_THAT(json.body, HasSubstr("is JSON-LD, which is not read; text/turtle"));
  const HttpReply latin = Ask("PUT", graph, "Content-Type: application/rdf+xml; charset=ISO-8859-1\r\n",
                              "<r:RDF xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><r:Bag "
                              "r:about='urn:w:l'><r:li>\xE9</r:li></r:Bag></r:RDF>");
  EXPECT_EQ(latin.status, 200) << latin.body;
  EXPECT_TRUE(Holds("GRAPH :z { :l rdf:_1 'é' }"));
}

// A read that exceeds the time limit of a query ends with the limit's name, and when the client leaves.
TEST_F(GraphStoreTest, ReadingABodyEndsAtTheTimeLimit) {
  settings_.limits.query_timeout_ms = 50;
  StartServer();
  std::string turtle;
  while (turtle.size() < (20u << 20))
    absl::StrAppend(&turtle, "@prefix p", turtle.size(), ": <urn:", turtle.size(), ":> .\n");
  const HttpReply reply = Ask("PUT", "/rdf-graphs?graph=urn:w:g", kTurtle, turtle);
  EXPECT_EQ(reply.status, 504) << reply.body;
  EXPECT_THAT(reply.body, HasSubstr("query_timeout_ms = 50"));
}

// RFC 9110 section 13.1
TEST_F(GraphStoreTest, ConditionalChanges) {
  StartServer();
  const std::string graph = "/rdf-graphs?graph=urn:w:g", is_there = "If-Match: *\r\n",
                    is_not = "If-None-Match: *\r\n";
  const auto put = [&](const std::string& condition) {
    return Ask("PUT", graph, kTurtle + condition, "<urn:w:a> <urn:w:p> \"" + condition.substr(0, 7) + "\" .")
        .status;
  };
  EXPECT_EQ(put(is_there), 412);
  EXPECT_EQ(Ask("GET", graph).status, 404);
  EXPECT_EQ(put(is_not), 201);
  EXPECT_EQ(put(is_not), 412);
  EXPECT_EQ(put("If-Match: \"v1\"\r\n"), 412);
  EXPECT_THAT(Ask("GET", graph).body, HasSubstr("If-None"));
  EXPECT_EQ(put(is_there), 200);
  EXPECT_EQ(put("If-None-Match: \"v1\"\r\n"), 200);
  EXPECT_EQ(Ask("DELETE", graph, is_not).status, 412);
  EXPECT_EQ(Ask("DELETE", graph, is_there).status, 200);
  EXPECT_EQ(Ask("DELETE", graph, is_there).status, 412);
}

TEST_F(GraphStoreTest, EveryFormatInAndOut) {
  StartServer();
  const std::string graph = "/rdf-graphs/people/1";
  for (const char* type : {"text/turtle", "application/n-triples", "application/rdf+xml", "application/trig",
                           "application/n-quads"}) {
    const std::string first =
        Ask("PUT", "/rdf-graphs?graph=urn:w:one", kTurtle,
            "<urn:w:a> <urn:w:name> \"A \\\"b\\\"\"@en , 1.50 ; <urn:w:of> [ <urn:w:p> <urn:w:a> ] .")
            .body;
    const HttpReply text = Ask("GET", "/rdf-graphs?graph=urn:w:one", absl::StrCat("Accept: ", type, "\r\n"));
    ASSERT_EQ(text.status, 200) << type;
    EXPECT_THAT(text.headers.at("content-type"), HasSubstr(type));
    const HttpReply put = Ask("PUT", graph, absl::StrCat("Content-Type: ", type, "\r\n"), text.body);
    EXPECT_LT(put.status, 300) << type << put.body;
    EXPECT_THAT(Query("SELECT * { GRAPH ?g { ?s <urn:w:of> ?b . ?b <urn:w:p> ?s . ?s <urn:w:name> 1.50, 'A "
                      "\"b\"'@en } }")
                    .rows,
                SizeIs(2))
        << type;
  }
}

TEST_F(GraphStoreTest, ALargeGraphIsSentInPiecesAndCountsUntilItIsTaken) {
  settings_.limits.queries_memory_bytes = 40u << 20;
  StartServer();
  std::string turtle;
  for (int i = 0; i < 7000; ++i)
    absl::StrAppend(&turtle, "<urn:w:a> <urn:w:p> \"", i, std::string(2000, 'x'), "\" .\n");
  ASSERT_EQ(Ask("PUT", "/rdf-graphs?graph=urn:w:g", kTurtle, turtle).status, 201);
  const auto await_free = [&] {
    bool free = false;
    for (int i = 0; i < 1000 && !free; ++i) {
      free = Ask("GET", "/metrics").body.find("\ndocent_query_memory_bytes 0\n") != std::string::npos;
      if (!free) absl::SleepFor(absl::Milliseconds(10));
    }
    return free;
  };
  ASSERT_TRUE(await_free());
  const auto get = [&] {
    return Ask("GET", "/rdf-graphs?graph=urn:w:g", "Accept: application/n-triples\r\n");
  };
  HttpClient slow(http_port());
  ASSERT_TRUE(slow.Send(absl::StrCat("GET /rdf-graphs?graph=urn:w:g HTTP/1.1\r\nHost: localhost:",
                                     http_port(), "\r\nAccept: application/n-triples\r\n\r\n")));
  ASSERT_TRUE(slow.AwaitAnswer());
  HttpReply other = get();
  ASSERT_EQ(other.status, 503);
  EXPECT_THAT(other.body, HasSubstr("queries_memory_bytes = 41943040"));
  EXPECT_TRUE(Holds(":a :p ?o")) << "small queries go on";
  const HttpReply taken = slow.Receive();
  ASSERT_EQ(taken.status, 200);
  EXPECT_EQ(taken.headers.at("transfer-encoding"), "chunked");
  EXPECT_TRUE(taken.whole);
  EXPECT_EQ(std::count(taken.body.begin(), taken.body.end(), '\n'), 7000);
  ASSERT_TRUE(await_free());
  other = get();
  EXPECT_EQ(other.status, 200);
  EXPECT_TRUE(other.body == taken.body);
}

TEST_F(GraphStoreTest, AGraphWithoutTriplesIsNotMade) {
  StartServer();
  const std::string graph = "/rdf-graphs?graph=urn:w:g";
  for (const char* method : {"PUT", "POST"})
    EXPECT_EQ(Ask(method, graph, kTurtle, "# nothing").status, 200) << method;
  EXPECT_EQ(Ask("PATCH", graph, kUpdate, "DELETE DATA { <urn:w:a> <urn:w:p> 1 }").status, 200);
  EXPECT_EQ(Ask("GET", graph).status, 404);
  const HttpReply nowhere = Ask("POST", "/rdf-graphs", kTurtle, "# nothing");
  EXPECT_EQ(nowhere.status, 200);
  EXPECT_EQ(nowhere.headers.count("location"), 0u);
  EXPECT_EQ(Ask("PATCH", graph, kUpdate, "INSERT DATA { <urn:w:a> <urn:w:p> 1 }").status, 201);
}

TEST_F(GraphStoreTest, WhatCannotBeIsRefusedWithItsStatus) {
  StartServer();
  const auto status = [this](const std::string& method, const std::string& target,
                             const std::string& headers = "", const std::string& body = "") {
    return Ask(method, target, headers, body).status;
  };
  EXPECT_EQ(status("GET", "/rdf-graphs"), 400);
  EXPECT_EQ(status("GET", "/rdf-graphs?default&graph=urn:x"), 400);
  EXPECT_EQ(status("GET", "/rdf-graphs?graph=relative"), 400);
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=urn:x", kTurtle, "<a:a> <a:b"), 400);
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=urn:x", "Content-Type: image/png\r\n", "x"), 415);
  const std::string latin = "; charset=ISO-8859-1\r\n";
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=urn:x", "Content-Type: text/turtle" + latin,
                   "<a:a> <a:b> '\xC3\xA9' ."),
            415);
  EXPECT_EQ(status("PATCH", "/rdf-graphs?graph=urn:x", "Content-Type: application/sparql-update" + latin,
                   "CLEAR ALL"),
            415);
  EXPECT_EQ(status("POST", "/rdf-graphs?graph=urn:x", "Content-Type: text/turtle; charset=\"UTF-8\"\r\n",
                   "# nothing"),
            200);
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=urn:x", "Content-Type: application/trig\r\n",
                   "<g:g> { <a:a> <a:b> <a:c> }"),
            400);
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=urn:named", "Content-Type: application/trig\r\n",
                   "<urn:named> { <a:a> <a:b> <a:c> }"),
            201)
      << "it names the graph that it is sent to";
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=urn:named",
                   kTurtle + std::string("Content-Range: bytes 0-1/9\r\n"), "# part"),
            400);
  EXPECT_TRUE(Holds("GRAPH <urn:named> { <a:a> <a:b> <a:c> }"));
  EXPECT_EQ(status("PUT", "/rdf-graphs?graph=https://w3id.org/docent%23inferred", kTurtle, ""), 403);
  EXPECT_EQ(status("PATCH", "/rdf-graphs?graph=urn:x", kTurtle, ""), 415);
  EXPECT_EQ(status("PATCH", "/rdf-graphs?graph=urn:x", kUpdate, "CLEAR ALL"), 422);
  EXPECT_EQ(
      status("PATCH", "/rdf-graphs?graph=urn:x", kUpdate, "INSERT DATA { GRAPH <urn:y> { <a:a> <a:b> 1 } }"),
      422);
  EXPECT_EQ(status("GET", "/rdf-graphs?default", "Accept: image/png\r\n"), 406);
  EXPECT_EQ(status("OPTIONS", "/rdf-graphs"), 200);
}

TEST_F(GraphStoreTest, DescribeIsAnsweredOverHttpAndGrpc) {
  StartServer();
  MustTell(":a :p :b ; :card [ :name 'A' ] . :b :p :c .");
  const HttpReply reply =
      Ask("GET", "/sparql?query=DESCRIBE%20%3Curn:w:a%3E", "Accept: application/n-triples\r\n");
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(std::count(reply.body.begin(), reply.body.end(), '\n'), 3) << reply.body;
  EXPECT_THAT(Query("DESCRIBE <urn:w:a>").rows, SizeIs(3));
}

TEST_F(GraphStoreTest, AGraphAsItWas) {
  StartServer();
  const std::string graph = "/rdf-graphs?graph=urn:w:g";
  EXPECT_EQ(Ask("PUT", graph, kTurtle, "<urn:w:a> <urn:w:p> 1 .").status, 201);
  const std::string then = absl::StrCat(Revision());
  EXPECT_EQ(Ask("PUT", graph, kTurtle, "<urn:w:a> <urn:w:p> 2 .").status, 200);
  const HttpReply past = Ask("GET", graph + "&as-of=" + then, "Accept: application/n-triples\r\n");
  EXPECT_THAT(past.body, HasSubstr("\"1\""));
  EXPECT_EQ(past.headers.at("docent-revision"), then);
  EXPECT_THAT(Ask("GET", graph, "Accept: application/n-triples\r\n").body, HasSubstr("\"2\""));
  EXPECT_EQ(Ask("GET", graph + "&as-of=0").status, 404);
  EXPECT_EQ(Ask("GET", graph + "&as-of=yesterday").status, 400);
  const HttpReply misspelt = Ask("GET", graph + "&asof=1");
  EXPECT_EQ(misspelt.status, 400);
  EXPECT_THAT(misspelt.body, HasSubstr("there is no parameter asof; did you mean as-of?"));
  EXPECT_EQ(Ask("GET", graph + "&cache-buster=17").status, 200) << "meant for others";
  EXPECT_EQ(Ask("GET", graph + absl::StrCat("&min-revision=", Revision())).status, 200);
  EXPECT_EQ(Ask("DELETE", graph + "&as-of=" + then).status, 400);
}

TEST_F(GraphStoreTest, OtherServersAreAskedWhereThatIsAllowed) {
  ServerSettings other = settings_;
  other.data_folder = folder_ / "other";
  auto second = Server::Start(other, nullptr);
  ASSERT_TRUE(second.ok()) << second.status();
  const std::string base = absl::StrCat("http://localhost:", PortOf(**second));
  EXPECT_EQ(HttpClient(PortOf(**second))
                .Ask("PUT", "/rdf-graphs?graph=urn:w:g", kTurtle, "<urn:w:a> <urn:w:far> 7 .")
                .status,
            201);
  settings_.allow = {base + "/sparql", base + "/rdf-graphs"};
  StartServer();
  MustTell(":a :near 1 .");
  const std::string query =
      "SELECT ?n ?f { ?x <urn:w:near> ?n SERVICE <" + base + "/sparql> { ?x <urn:w:far> ?f } }";
  EXPECT_THAT(Query(query).rows, ElementsAre("\"1\" \"7\""));
  EXPECT_EQ(Update("INSERT { :a :sum ?f } WHERE { ?x :near ?n SERVICE <" + base + "/sparql> { ?x :far ?f } }")
                .status,
            200);
  EXPECT_TRUE(Holds(":a :sum 7"));
  HttpReply reply = Update("LOAD <" + base + "/rdf-graphs?graph=urn:w:g> INTO GRAPH :copy");
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_TRUE(Holds("GRAPH :copy { :a :far 7 }"));
  reply = Update("LOAD <" + base + "/healthz>");
  EXPECT_EQ(reply.status, 403);
  EXPECT_THAT(reply.body, HasSubstr("--allow"));
  EXPECT_EQ(Update("LOAD SILENT <" + base + "/healthz>").status, 200);
}

// It names a part of the document, which is read whole.
TEST_F(GraphStoreTest, AFragmentIsNoPartOfWhatIsLoaded) {
  const std::string file = folder_ / "p.ttl";
  std::ofstream(file) << "<urn:w:a> <urn:w:p> <> .";
  settings_.allow = {"file://" + (folder_ / "")};
  StartServer();
  const HttpReply reply = Update("LOAD <file://" + file + "#x> INTO GRAPH :g");
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_TRUE(Holds("GRAPH :g { :a :p <file://" + file + "> }"));
}

TEST_F(GraphStoreTest, FilesOfUnknownTypeAreReadByTheirNames) {
  StartServer();
  const auto body = [](const std::string& file) {
    return "--x\r\nContent-Disposition: form-data; name=\"f\"; filename=\"" + file +
           "\"\r\nContent-Type: application/octet-stream\r\n\r\n<urn:w:a> <urn:w:b> 1 .\r\n--x--\r\n";
  };
  const std::string type = "Content-Type: multipart/form-data; boundary=x\r\n";
  EXPECT_EQ(Ask("POST", "/rdf-graphs?graph=urn:w:f", type, body("facts.ttl")).status, 201);
  EXPECT_TRUE(Holds("GRAPH :f { :a :b 1 }"));
  EXPECT_EQ(Ask("POST", "/rdf-graphs?graph=urn:w:f", type, body("facts")).status, 415);
  const HttpReply read = Ask("GET", "/rdf-graphs?graph=urn:w:f", "Accept: application/xml\r\n");
  EXPECT_EQ(read.headers.at("content-type"), "application/xml");
  EXPECT_EQ(read.headers.at("vary"), "Accept");
  EXPECT_THAT(read.body, HasSubstr("<rdf:RDF"));
  EXPECT_EQ(Ask("GET", "/rdf-graphs?graph=urn:w:f&as-of=").status, 400);
}

// RFC 7578 section 4.4: a part without a type says by its name what it is.
TEST_F(GraphStoreTest, PartsWithoutATypeAreReadByTheirNames) {
  StartServer();
  const auto put = [this](const std::string& graph, const std::string& file, const std::string& text) {
    const std::string name = file.empty() ? "" : "; filename=\"" + file + "\"";
    return Ask("PUT", "/rdf-graphs?graph=" + graph, "Content-Type: multipart/form-data; boundary=x\r\n",
               "--x\r\nContent-Disposition: form-data; name=\"f\"" + name + "\r\n\r\n" + text +
                   "\r\n--x--\r\n")
        .status;
  };
  const std::string xml =
      "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:w=\"urn:w:\">"
      "<rdf:Description rdf:about=\"urn:w:a\"><w:p>1</w:p></rdf:Description></rdf:RDF>";
  EXPECT_EQ(put("urn:w:1", "a.rdf", xml), 201);
  EXPECT_EQ(put("urn:w:2", "A.NT", "<urn:w:a> <urn:w:p> \"1\" ."), 201);
  EXPECT_EQ(put("urn:w:3", "a.nt", "@prefix w: <urn:w:> . w:a w:p 1 ."), 400) << "that is Turtle";
  EXPECT_EQ(put("urn:w:4", "a.ttl.gz", Gzip("<urn:w:a> <urn:w:p> 1 .")), 201);
  for (const char* unnamed : {"", "data", "data.csv"})
    EXPECT_NE(put("urn:w:5", unnamed, "@prefix w: <urn:w:> . w:a w:p 1 ."), 400) << "Turtle: " << unnamed;
  EXPECT_TRUE(Holds("GRAPH :1 { :a :p \"1\" } GRAPH :2 { :a :p \"1\" } GRAPH :4 { :a :p 1 }"));
}

// Which graphs are named, and where, makes no difference.
TEST_F(GraphStoreTest, APatchNamesNoGraph) {
  StartServer();
  ASSERT_EQ(Update("INSERT DATA { GRAPH :g { :a :p 1 } GRAPH :h { :a :p 2 } }").status, 200);
  const auto patch = [this](const std::string& text) {
    return Ask("PATCH", "/rdf-graphs?graph=urn:w:g", kUpdate, "PREFIX : <urn:w:> " + text).status;
  };
  for (const char* text :
       {"INSERT { :b :q ?o } USING :h WHERE { :a :p ?o }",
        "INSERT { :b :q ?o } WHERE { GRAPH :h { :a :p ?o } }",
        "INSERT { :b :q ?o } WHERE { GRAPH ?g { :a :p ?o } }",
        "WITH :h INSERT { :b :q ?o } WHERE { :a :p ?o }",
        "INSERT { :b :q ?o } USING NAMED :h WHERE { :a :p ?o }", "DELETE WHERE { GRAPH :h { :a :p ?o } }",
        "INSERT { :b :q 1 } WHERE { :a :p ?o FILTER NOT EXISTS { GRAPH :h { ?o :p 9 } } }",
        "INSERT { :b :q 1 } WHERE { { SELECT ?o { OPTIONAL { GRAPH :h { :a :p ?o } } } } }",
        "INSERT { :b :q 1 } WHERE { :a :p ?o BIND(EXISTS { GRAPH :h { :a :p 2 } } AS ?x) }"})
    EXPECT_EQ(patch(text), 422) << text;
  EXPECT_FALSE(Holds("GRAPH ?g { :b :q ?o }"));
  EXPECT_EQ(patch("INSERT { :b :q ?o } WHERE { :a :p ?o FILTER EXISTS { :a :p 1 } }"), 200);
  EXPECT_TRUE(Holds("GRAPH :g { :b :q 1 }"));
}

TEST_F(GraphStoreTest, APageOfAnotherSiteReadsNothingAndStartsNothing) {
  StartServer();
  for (const char* target : {"/sparql?query=ASK%7B%7D", "/sparql", "/rdf-graphs?default"}) {
    EXPECT_EQ(Ask("GET", target, "Sec-Fetch-Site: cross-site\r\n").status, 403) << target;
    EXPECT_EQ(Ask("HEAD", target, "Sec-Fetch-Site: same-site\r\n").status, 403) << target;
    EXPECT_EQ(Ask("GET", target, "Sec-Fetch-Site: none\r\n").status, 200) << target;
    EXPECT_EQ(Ask("GET", target, "Sec-Fetch-Site: same-origin\r\n").status, 200) << target;
  }
  EXPECT_NE(Ask("GET", "/healthz", "Sec-Fetch-Site: cross-site\r\n").status, 403);
}

TEST_F(GraphStoreTest, AnAddressThatIsNoneIsRefusedAtTheStart) {
  settings_.allow = {"everything"};
  EXPECT_EQ(Server::Start(settings_, nullptr).status().code(), absl::StatusCode::kInvalidArgument);
  settings_.allow.clear();
  settings_.http_names = {"http://x/"};
  EXPECT_EQ(Server::Start(settings_, nullptr).status().code(), absl::StatusCode::kInvalidArgument);
  settings_.http_names.clear();
  settings_.grpc_address = ":0";
  EXPECT_THAT(std::string(Server::Start(settings_, nullptr).status().message()),
              HasSubstr("\":0\" is not HOST:PORT"));
}

}  // namespace
}  // namespace docent::server::test
