#include "kb_server/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "kb_server/door/port_in_use.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

HttpRoutes EchoRoutes() {
  HttpRoutes routes;
  routes.Add("GET", "/hello",
             [](std::shared_ptr<HttpExchange> e) { e->Respond(TextResponse(200, "hello")); });
  routes.Add("GET", "/a b", [](std::shared_ptr<HttpExchange> e) {
    std::string text;
    for (const auto& [name, value] : e->request().parameters) absl::StrAppend(&text, name, "=", value, ";");
    e->Respond(TextResponse(200, text));
  });
  routes.Add("POST", "/length", [](std::shared_ptr<HttpExchange> e) {
    e->Respond(TextResponse(200, absl::StrCat(e->request().body.size())));
  });
  return routes;
}

std::unique_ptr<HttpServer> StartServer(HttpRoutes routes, HttpServerOptions options = {}) {
  options.listen = "127.0.0.1:0";
  auto server = HttpServer::Start(options, std::move(routes));
  EXPECT_TRUE(server.ok()) << server.status();
  return server.ok() ? *std::move(server) : nullptr;
}

TEST(HttpServerTest, AnswersAndKeepsTheConnection) {
  auto server = StartServer(EchoRoutes());
  EXPECT_EQ(server->address(), absl::StrCat("127.0.0.1:", server->port()));
  HttpClient client(server->port());
  for (int i = 0; i < 3; ++i) {
    const HttpReply reply = client.Ask("GET", "/hello");
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.body, "hello\n");
    EXPECT_EQ(reply.headers.at("content-type"), "text/plain; charset=utf-8");
    EXPECT_EQ(reply.headers.at("x-content-type-options"), "nosniff");
  }
  EXPECT_EQ(client.Ask("POST", "/length", "", std::string(1000000, 'x')).body, "1000000\n");
  EXPECT_EQ(server->counts().connections, 1u);
  EXPECT_EQ(server->counts().requests, 4u);
}

// RFC 9110 section 6.6.1: a server with a clock sends Date with every 2xx, 3xx and 4xx answer.
TEST(HttpServerTest, AnswersAreDated) {
  ManualClock clock(784111777000000);
  HttpServerOptions options;
  options.clock = &clock;
  auto server = StartServer(EchoRoutes(), options);
  HttpClient client(server->port());
  EXPECT_EQ(client.Ask("GET", "/hello").headers.at("date"), "Sun, 06 Nov 1994 08:49:37 GMT");
  clock.Advance(std::chrono::hours(72));
  EXPECT_EQ(client.Ask("GET", "/nothing").headers.at("date"), "Wed, 09 Nov 1994 08:49:37 GMT");
  auto without = StartServer(EchoRoutes());
  EXPECT_EQ(HttpClient(without->port()).Ask("GET", "/hello").headers.count("date"), 0u);
}

TEST(HttpServerTest, DecodesPathAndParameters) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  EXPECT_EQ(client.Ask("GET", "/a%20b?x=1&y=%C3%BC+z&x=2&flag").body, "x=1;y=ü z;x=2;flag=;\n");
  EXPECT_EQ(client.Ask("GET", "/a%2").status, 400);
  EXPECT_EQ(client.Ask("GET", "/hello?x=%zz").status, 400);
  EXPECT_EQ(client.Ask("GET", "/hello?x=%00").status, 400);
}

TEST(HttpServerTest, APathBelowSeveralRoutesGoesToTheLongest) {
  HttpRoutes routes;
  for (const char* path : {"/a/*", "/a/b/*", "/a/b/c", "/z"})
    routes.Add("GET", path, [path](std::shared_ptr<HttpExchange> e) { e->Respond(TextResponse(200, path)); });
  auto server = StartServer(std::move(routes));
  HttpClient client(server->port());
  for (const auto& [path, route] :
       {std::pair("/a/x", "/a/*"), std::pair("/a/", "/a/*"), std::pair("/a/b/x/y", "/a/b/*"),
        std::pair("/a/b/", "/a/b/*"), std::pair("/a/b", "/a/*"), std::pair("/a/b/c", "/a/b/c"),
        std::pair("/a//", "/a/*")})
    EXPECT_EQ(client.Ask("GET", path).body, absl::StrCat(route, "\n")) << path;
  for (const char* nothing : {"/a", "/ab/x", "/z/x", "/", "//a/x"})
    EXPECT_EQ(client.Ask("GET", nothing).status, 404);
  const std::string slashes(60000, '/');
  EXPECT_EQ(client.Ask("GET", slashes).status, 404);
  EXPECT_EQ(client.Ask("GET", "/a" + slashes).status, 200);
}

TEST(HttpServerTest, HeadHasNoBody) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  const HttpReply reply = client.Ask("HEAD", "/hello");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.headers.at("content-length"), "6");
  EXPECT_EQ(client.Ask("GET", "/hello").body, "hello\n");
}

TEST(HttpServerTest, PipelinedRequestsAreAnsweredInOrder) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  std::string requests;
  for (int i = 0; i < 20; ++i) {
    absl::StrAppend(&requests, "POST /length HTTP/1.1\r\nHost: 127.0.0.1:", server->port(),
                    "\r\nContent-Length: ", i, "\r\n\r\n", std::string(i, 'x'));
  }
  ASSERT_TRUE(client.Send(requests));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(client.Receive().body, absl::StrCat(i, "\n"));
}

TEST(HttpServerTest, UnknownPathAndMethod) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  const HttpReply unknown = client.Ask("GET", "/nothing");
  EXPECT_EQ(unknown.status, 404);
  EXPECT_EQ(unknown.body, "there is nothing at /nothing; there are /a b, /hello, /length\n");
  const HttpReply method = client.Ask("DELETE", "/hello");
  EXPECT_EQ(method.status, 405);
  EXPECT_EQ(method.headers.at("allow"), "GET, HEAD");
  const HttpReply options = client.Ask("OPTIONS", "/hello");
  EXPECT_EQ(options.status, 200);
  EXPECT_EQ(options.headers.at("allow"), "GET, HEAD, OPTIONS");
  EXPECT_EQ(client.Ask("OPTIONS", "/nothing").status, 404);
  EXPECT_EQ(client.Ask("GET", "/hello").status, 200);  // the connection lives on
  EXPECT_GE(server->counts().refused, 2u);
}

TEST(HttpServerTest, OnlyItsOwnHostNamesAreServed) {
  HttpServerOptions options;
  options.allowed_hosts = {"Docent.example.org", "robot.example.org:8080"};
  auto server = StartServer(EchoRoutes(), options);
  const std::string port = absl::StrCat(":", server->port());
  HttpClient client(server->port());
  for (const std::string& host :
       {"localhost" + port, "LOCALHOST" + port, "127.0.0.1" + port, "127.1.2.3" + port, "[::1]" + port,
        "1.2.3.4" + port, "[2001:db8::1]" + port,  // no name that could be made to point here
        std::string("localhost"), std::string("127.0.0.1"), std::string("[::1]"), std::string("192.0.2.1"),
        std::string("docent.example.org"), std::string("docent.example.org:99"),
        std::string("robot.example.org:8080")}) {
    EXPECT_EQ(client.Ask("GET", "/hello", "Host: " + host + "\r\n").status, 200) << host;
  }
  for (const std::string& host :
       {std::string("localhost:1"), std::string("evil.example.org"), "evil.example.org" + port,
        "localhost.evil.example" + port, std::string("robot.example.org"), "127.0.0.1.evil.example" + port,
        std::string("1.2.3.4:1"), "user@localhost" + port, "localhost" + port + port, std::string("[::1"),
        std::string("localhost:99999999999")}) {
    const HttpReply reply = client.Ask("GET", "/hello", "Host: " + host + "\r\n");
    EXPECT_EQ(reply.status, 403) << host;
    EXPECT_THAT(reply.body, HasSubstr("does not answer to the host name"));
  }
  EXPECT_EQ(
      client.Ask("GET", "/hello", absl::StrCat("Host: localhost", port, "\r\nHost: evil.example.org\r\n"))
          .status,
      400);
  HttpClient nameless(server->port());
  nameless.Send("GET /hello HTTP/1.1\r\n\r\n");
  EXPECT_EQ(nameless.Receive().status, 400);
}

TEST(HttpServerTest, OtherSitesAreRefused) {
  auto server = StartServer(EchoRoutes());
  const std::string port = absl::StrCat(":", server->port());
  HttpClient client(server->port());
  for (const std::string& origin :
       {"http://localhost" + port, "http://127.0.0.1" + port, "http://[::1]" + port}) {
    EXPECT_EQ(client.Ask("POST", "/length", "Origin: " + origin + "\r\n", "abc").status, 200) << origin;
  }
  for (const std::string& origin :
       {std::string("http://evil.example.org"), std::string("null"), "http://localhost.evil.example" + port,
        std::string("http://localhost:1"), std::string("file://"), std::string("http://localhost")}) {
    const HttpReply get = client.Ask("GET", "/hello", "Origin: " + origin + "\r\n");
    EXPECT_EQ(get.status, 403) << origin;
    EXPECT_THAT(get.body, HasSubstr("requests from web pages of " + origin + " are refused"));
  }
  const std::string address =
      "Host: 192.0.2.1" + port + "\r\n";  // reached from elsewhere: its own pages, and no others
  EXPECT_EQ(client.Ask("GET", "/hello", address + "Origin: http://192.0.2.1" + port + "\r\n").status, 200);
  EXPECT_EQ(client.Ask("GET", "/hello", address + "Origin: http://192.0.2.2" + port + "\r\n").status, 403);
  EXPECT_EQ(client.Ask("GET", "/hello", address + "Origin: https://192.0.2.1" + port + "\r\n").status, 403);
  // Refused before the body is read: the connection ends.
  EXPECT_EQ(client.Ask("POST", "/length", "Origin: http://evil.example.org\r\n", "abc").status, 403);
  EXPECT_TRUE(client.Ended());
}

TEST(HttpServerTest, BodiesInEncodingsThatAreNotReadAreRefused) {
  auto server = StartServer(EchoRoutes());
  for (const std::string coding : {"deflate", "br", "gzip, gzip", "identity, gzip", "zstd"}) {
    const HttpReply reply =
        HttpClient(server->port()).Ask("POST", "/length", "Content-Encoding: " + coding + "\r\n", "abc");
    EXPECT_EQ(reply.status, 415) << coding;
    EXPECT_THAT(reply.body, HasSubstr("a Content-Encoding of " + coding + " is not read"));
    EXPECT_EQ(reply.headers.at("accept-encoding"), "gzip, identity");
  }
  EXPECT_EQ(HttpClient(server->port()).Ask("POST", "/length", "Content-Encoding: Identity\r\n", "abc").status,
            200);
}

TEST(HttpServerTest, BadRequestsAreAnsweredAndOthersNoticeNothing) {
  auto server = StartServer(EchoRoutes());
  HttpClient good(server->port());
  for (const std::string& bytes :
       {std::string("nonsense\r\n\r\n"), std::string("GET /hello HTTP/1.x\r\n\r\n"),
        std::string("\x16\x03\x01\x02", 4) + "\r\n\r\n",
        std::string("GET /hello HTTP/1.1\r\nHost localhost\r\n\r\n"),
        std::string("POST /length HTTP/1.1\r\nContent-Length: x\r\n\r\n"),
        std::string("POST /length HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n")}) {
    HttpClient client(server->port());
    client.Send(bytes);
    const HttpReply reply = client.Receive();
    EXPECT_EQ(reply.status, 400) << bytes;
    EXPECT_EQ(reply.headers.at("connection"), "close");
    EXPECT_TRUE(client.Ended());
    EXPECT_EQ(good.Ask("GET", "/hello").status, 200);
  }
  EXPECT_EQ(good.Ask("GET", "hello").status, 400);
}

// RFC 9112 section 6.3: if the end of a request is not known, the following bytes are not a request.
TEST(HttpServerTest, BytesAfterARefusedRequestAreNotReadAsARequest) {
  std::atomic<int> asked = 0;
  HttpRoutes routes = EchoRoutes();
  routes.Add("GET", "/smuggled", [&asked](std::shared_ptr<HttpExchange> e) {
    ++asked;
    e->Respond(TextResponse(200, "smuggled"));
  });
  auto server = StartServer(std::move(routes));
  const std::string host = absl::StrCat("Host: localhost:", server->port(), "\r\n");
  const std::string smuggled = "GET /smuggled HTTP/1.1\r\n" + host + "\r\n";
  for (const std::string& framing :
       {std::string("Transfer-Encoding: xchunked\r\n\r\n"),
        std::string("Transfer-Encoding: identity\r\n\r\n"),
        std::string("Transfer-Encoding: chunked, identity\r\n\r\n"),
        std::string("Transfer-Encoding: gzip, chunked\r\n\r\n"),
        std::string("Transfer-Encoding: chunked\r\nContent-Length: 0\r\n\r\n"),
        std::string("Content-Length: 0\r\nContent-Length: 10\r\n\r\n"),
        std::string("Content-Length: +0\r\n\r\n"),
        std::string("Transfer-Encoding: chunked\r\n\r\n0;\r\n\r\n"),
        std::string("Transfer-Encoding: chunked\r\n\r\n0\r\nX : y\r\n\r\n"),
        std::string("Host: localhost\r\n\r\n"), std::string("X : y\r\n\r\n"), std::string("X: y\n\r\n")}) {
    for (const std::string method : {"POST /length", "GET /hello"}) {
      HttpClient client(server->port());
      client.Send(method + " HTTP/1.1\r\n" + host + framing + smuggled);
      const HttpReply reply = client.Receive();
      EXPECT_TRUE(reply.status == 400 || reply.status == 501) << framing << reply.status;
      EXPECT_EQ(reply.headers.at("connection"), "close");
      EXPECT_TRUE(client.Ended()) << framing;
    }
  }
  EXPECT_EQ(asked, 0);
}

// A client may send any amount between the chunks of a body: it is limited and not stored.
TEST(HttpServerTest, EndlessChunkExtensionsAndTrailerFieldsAreRefused) {
  auto server = StartServer(EchoRoutes());
  const std::string head = absl::StrCat("POST /length HTTP/1.1\r\nHost: localhost:", server->port(),
                                        "\r\nTransfer-Encoding: chunked\r\n\r\n");
  for (const std::string& begin :
       {std::string("f;a="), std::string("0\r\nX: "), std::string("1\r\nx\r\n1;")}) {
    HttpClient client(server->port());
    client.Send(head + begin);
    for (int i = 0; i < 100 && client.Send(std::string(65536, 'x')); ++i) {
    }
    const HttpReply reply = client.Receive();
    EXPECT_TRUE(reply.status == 400 || reply.status == 431) << begin << reply.status;
    EXPECT_TRUE(client.Ended());
  }
}

// As the health checks of load balancers do.
TEST(HttpServerTest, OldClientsNeedNotNameTheHost) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  client.Send("GET /hello HTTP/1.0\r\n\r\n");
  EXPECT_EQ(client.Receive().body, "hello\n");
  EXPECT_TRUE(client.Ended());
  HttpClient other(server->port());
  other.Send("GET /hello HTTP/1.0\r\nHost: evil.example.org\r\n\r\n");
  EXPECT_EQ(other.Receive().status, 403);
}

// RFC 9112 section 3.2.2: the form that a client uses towards a proxy.
TEST(HttpServerTest, TargetsWithAHostAreServed) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  const std::string own = absl::StrCat("localhost:", server->port());
  EXPECT_EQ(client.Ask("GET", "http://" + own + "/hello").status, 200);
  EXPECT_EQ(client.Ask("GET", "HTTP://" + own + "/a%20b?x=http://y/").body, "x=http://y/;\n");
  EXPECT_EQ(client.Ask("GET", "http://" + own + "/hello", "Host: evil.example.org\r\n").status, 200);
  EXPECT_EQ(client.Ask("GET", "http://evil.example.org/hello").status, 403)
      << "its host counts, not the header's";
  EXPECT_EQ(client.Ask("GET", "http:///hello").status, 400);
  EXPECT_EQ(client.Ask("GET", "http://" + own).status, 404) << "without a path, that is /";
  EXPECT_EQ(client.Ask("GET", "http://" + own + "?x=1").status, 404);
  EXPECT_EQ(client.Ask("GET", "https://" + own + "/hello").status, 400);
  client.Send("GET http://" + own + "/hello HTTP/1.1\r\n\r\n");
  EXPECT_EQ(client.Receive().status, 400) << "HTTP/1.1 wants Host all the same";
}

TEST(HttpServerTest, BodyLimitHoldsAtTheLimitAndBeyond) {
  HttpServerOptions options;
  options.body_bytes = 100000;
  auto server = StartServer(EchoRoutes(), options);
  HttpClient at_limit(server->port());
  EXPECT_EQ(at_limit.Ask("POST", "/length", "", std::string(100000, 'x')).body, "100000\n");
  HttpClient beyond(server->port());
  const HttpReply refused = beyond.Ask("POST", "/length", "", std::string(100001, 'x'));
  EXPECT_EQ(refused.status, 413);
  EXPECT_EQ(refused.body, "the request body is larger than the limit http_body_bytes = 100000\n");
  EXPECT_TRUE(beyond.Ended());
  // A body without a declared length.
  HttpClient chunked(server->port());
  chunked.Send(absl::StrCat("POST /length HTTP/1.1\r\nHost: localhost:", server->port(),
                            "\r\nTransfer-Encoding: chunked\r\n\r\n20000\r\n", std::string(0x20000, 'x'),
                            "\r\n0\r\n\r\n"));
  EXPECT_EQ(chunked.Receive().status, 413);
}

TEST(HttpServerTest, AllBodiesTogetherEndAtTheirLimit) {
  HttpServerOptions options;
  options.bodies_bytes = 4u << 20;
  auto server = StartServer(EchoRoutes(), options);
  const std::string head = absl::StrCat("POST /length HTTP/1.1\r\nHost: localhost:", server->port(),
                                        "\r\nContent-Length: 3000000\r\n\r\n");
  HttpClient first(server->port()), third(server->port());
  ASSERT_TRUE(first.Send(head + std::string(2999999, 'x')));  // all but one
  for (int i = 0; i < 1000 && server->counts().body_bytes < 2500000; ++i)
    absl::SleepFor(absl::Milliseconds(10));
  HttpClient second(server->port());
  const HttpReply refused = second.Ask("POST", "/length", "", std::string(3000000, 'x'));
  ASSERT_EQ(refused.status, 503);
  EXPECT_EQ(refused.headers.at("retry-after"), "1");
  EXPECT_NE(refused.body.find("http_bodies_bytes = 4194304"), std::string::npos) << refused.body;
  EXPECT_EQ(third.Ask("POST", "/length", "", "abc").body, "3\n") << "small ones are served all the same";
  ASSERT_TRUE(first.Send("x"));
  EXPECT_EQ(first.Receive().body, "3000000\n");
  for (int i = 0; i < 1000 && server->counts().body_bytes > 0; ++i) absl::SleepFor(absl::Milliseconds(10));
  EXPECT_EQ(third.Ask("POST", "/length", "", std::string(3000000, 'x')).body, "3000000\n");
}

TEST(HttpServerTest, HeaderLimit) {
  HttpServerOptions options;
  options.header_bytes = 2000;
  auto server = StartServer(EchoRoutes(), options);
  HttpClient client(server->port());
  EXPECT_EQ(client.Ask("GET", "/hello", "X-Long: " + std::string(1500, 'x') + "\r\n").status, 200);
  EXPECT_EQ(client.Ask("GET", "/hello", "X-Long: " + std::string(2000, 'x') + "\r\n").status, 431);
  EXPECT_TRUE(client.Ended());
  HttpClient asks_much(server->port());
  EXPECT_EQ(asks_much.Ask("GET", "/hello?x=" + std::string(1500, 'x')).status, 200);
  const HttpReply refused = asks_much.Ask("GET", "/hello?x=" + std::string(2000, 'x'));
  EXPECT_EQ(refused.status, 414);
  EXPECT_EQ(refused.body, "the request line is longer than 2000 bytes; POST a long query instead\n");
  EXPECT_TRUE(asks_much.Ended());
}

TEST(HttpServerTest, SlowClientsAreClosed) {
  HttpServerOptions options;
  options.idle_timeout = std::chrono::milliseconds(50);
  options.header_timeout = std::chrono::milliseconds(50);
  options.body_timeout = std::chrono::milliseconds(50);
  auto server = StartServer(EchoRoutes(), options);
  HttpClient silent(server->port());
  EXPECT_TRUE(silent.Ended());
  HttpClient half_a_header(server->port());
  half_a_header.Send("GET /hello HT");
  EXPECT_TRUE(half_a_header.Ended());
  HttpClient half_a_body(server->port());
  half_a_body.Send(absl::StrCat("POST /length HTTP/1.1\r\nHost: localhost:", server->port(),
                                "\r\nContent-Length: 10\r\n\r\nabc"));
  EXPECT_TRUE(half_a_body.Ended());
}

TEST(HttpServerTest, ConnectionLimitTurnsAwayWhereAllWork) {
  HttpServerOptions options;
  options.connections = 2;
  HttpRoutes routes = EchoRoutes();
  absl::Mutex mutex;
  std::vector<std::shared_ptr<HttpExchange>> kept;
  routes.Add("GET", "/wait", [&](std::shared_ptr<HttpExchange> e) {
    absl::MutexLock lock(&mutex);
    kept.push_back(std::move(e));
  });
  auto server = StartServer(std::move(routes), options);
  HttpClient first(server->port()), second(server->port());
  const std::string wait = absl::StrCat("GET /wait HTTP/1.1\r\nHost: localhost:", server->port(), "\r\n\r\n");
  size_t asked = 0;
  for (HttpClient* client : {&first, &second}) {  // in this order also in `kept`
    client->Send(wait);
    ++asked;
    const auto is_there = [&] { return kept.size() == asked; };
    absl::MutexLock lock(&mutex);
    mutex.Await(absl::Condition(&is_there));
  }
  HttpClient third(server->port());
  const HttpReply reply = third.Receive();
  EXPECT_EQ(reply.status, 503);
  EXPECT_THAT(reply.body, HasSubstr("the limit http_connections is 2"));
  third.Close();
  kept.front()->Respond(TextResponse(200, "done"));
  EXPECT_EQ(first.Receive().body, "done\n");
  int status = 503;  // the answer may be here before the server has seen that it is through
  for (int i = 0; i < 6000 && status == 503; ++i) {
    status = HttpClient(server->port()).Ask("GET", "/hello").status;
    if (status == 503) absl::SleepFor(absl::Milliseconds(10));
  }
  EXPECT_EQ(status, 200) << "in the place of the first, which is idle now";
  EXPECT_TRUE(first.Ended());
  kept.back()->Respond(TextResponse(200, "done"));
  EXPECT_EQ(second.Receive().body, "done\n");
}

// As many slow clients as there are connections; they send next to nothing.
TEST(HttpServerTest, SlowClientsMakeRoomForOthers) {
  HttpServerOptions options;
  options.connections = 8;
  auto server = StartServer(EchoRoutes(), options);
  std::vector<std::unique_ptr<HttpClient>> slow;
  for (int i = 0; i < 20; ++i) {
    slow.push_back(std::make_unique<HttpClient>(server->port()));
    if (i % 2 == 0) slow.back()->Send("GET /hello HTTP/1.1\r\nX-Slow:");
  }
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(HttpClient(server->port()).Ask("GET", "/hello").body, "hello\n");
  }
  EXPECT_GT(server->counts().slow_closed, 0u);
  EXPECT_TRUE(slow.front()->Ended()) << "the one that has waited the longest";
}

TEST(HttpServerTest, ContinueIsSentToThoseWhoWait) {
  auto server = StartServer(EchoRoutes());
  HttpClient client(server->port());
  client.Send(absl::StrCat("POST /length HTTP/1.1\r\nHost: localhost:", server->port(),
                           "\r\nExpect: 100-continue\r\nContent-Length: 3\r\n\r\n"));
  EXPECT_EQ(client.Receive().status, 100);
  client.Send("abc");
  EXPECT_EQ(client.Receive().body, "3\n");
}

TEST(HttpServerTest, StreamedAnswersComeChunked) {
  HttpRoutes routes;
  std::thread writer;
  routes.Add("GET", "/stream", [&](std::shared_ptr<HttpExchange> e) {
    if (writer.joinable()) writer.join();
    writer = std::thread([e] {
      HttpResponse head = TextResponse(200, "first");
      head.headers.emplace_back("Docent-Revision", "5");
      e->Begin(std::move(head));
      for (int i = 0; i < 100; ++i)
        EXPECT_TRUE(e->Write(std::string(50000, static_cast<char>('a' + i % 26))));
      e->End();
    });
  });
  auto server = StartServer(std::move(routes));
  HttpClient client(server->port());
  for (int i = 0; i < 2; ++i) {
    const HttpReply reply = client.Ask("GET", "/stream");
    EXPECT_EQ(reply.status, 200);
    EXPECT_TRUE(reply.whole);
    EXPECT_EQ(reply.headers.at("transfer-encoding"), "chunked");
    EXPECT_EQ(reply.headers.at("docent-revision"), "5");
    EXPECT_EQ(reply.body.size(), 6u + 5000000u);
  }
  // HTTP/1.0 has no chunks: the end of the connection ends the answer.
  HttpClient old(server->port());
  old.Send(absl::StrCat("GET /stream HTTP/1.0\r\nHost: localhost:", server->port(), "\r\n\r\n"));
  const HttpReply reply = old.Receive();
  EXPECT_EQ(reply.headers.count("transfer-encoding"), 0u);
  EXPECT_EQ(reply.body.size(), 6u + 5000000u);
  writer.join();
}

TEST(HttpServerTest, AbortedAnswerIsSeenAsIncomplete) {
  HttpRoutes routes;
  routes.Add("GET", "/abort", [](std::shared_ptr<HttpExchange> e) {
    e->Begin(TextResponse(200, "begun"));
    e->Abort();
  });
  routes.Add("GET", "/forgotten", [](std::shared_ptr<HttpExchange>) {});
  auto server = StartServer(std::move(routes));
  HttpClient client(server->port());
  EXPECT_FALSE(client.Ask("GET", "/abort").whole);
  HttpClient other(server->port());
  EXPECT_EQ(other.Ask("GET", "/forgotten").status, 500);
}

TEST(HttpServerTest, HandlerLearnsThatTheClientIsGone) {
  HttpRoutes routes;
  std::shared_ptr<HttpExchange> kept;
  absl::Notification asked;
  absl::Notification gone;
  routes.Add("GET", "/wait", [&](std::shared_ptr<HttpExchange> e) {
    kept = e;
    e->OnGone([&] { gone.Notify(); });
    asked.Notify();
  });
  auto server = StartServer(std::move(routes));
  HttpClient client(server->port());
  client.Send(absl::StrCat("GET /wait HTTP/1.1\r\nHost: localhost:", server->port(), "\r\n\r\n"));
  asked.WaitForNotification();
  client.Close();
  EXPECT_TRUE(gone.WaitForNotificationWithTimeout(absl::Minutes(1)));
  kept->Respond(TextResponse(200, "too late"));
  EXPECT_FALSE(kept->Write("x"));
}

TEST(HttpServerTest, WriterOfASlowClientIsReleased) {
  HttpServerOptions options;
  options.write_timeout = std::chrono::milliseconds(100);
  HttpRoutes routes;
  std::thread writer;
  absl::Notification released;
  routes.Add("GET", "/endless", [&](std::shared_ptr<HttpExchange> e) {
    writer = std::thread([e, &released] {
      e->Begin(TextResponse(200, ""));
      while (e->Write(std::string(100000, 'x'))) {
      }
      released.Notify();
    });
  });
  auto server = StartServer(std::move(routes), options);
  HttpClient client(server->port());
  client.Send(absl::StrCat("GET /endless HTTP/1.1\r\nHost: localhost:", server->port(), "\r\n\r\n"));
  EXPECT_TRUE(released.WaitForNotificationWithTimeout(absl::Minutes(1)));
  writer.join();
}

TEST(HttpServerTest, StoppingEndsWhatIsInWork) {
  HttpRoutes routes = EchoRoutes();
  std::shared_ptr<HttpExchange> kept;
  absl::Notification asked;
  absl::Notification gone;
  routes.Add("GET", "/wait", [&](std::shared_ptr<HttpExchange> e) {
    kept = e;
    e->OnGone([&] { gone.Notify(); });
    asked.Notify();
  });
  auto server = StartServer(std::move(routes));
  const uint16_t port = server->port();
  HttpClient idle(port);
  HttpClient waiting(port);
  waiting.Send(absl::StrCat("GET /wait HTTP/1.1\r\nHost: localhost:", port, "\r\n\r\n"));
  asked.WaitForNotification();
  server.reset();
  EXPECT_TRUE(gone.HasBeenNotified());
  EXPECT_TRUE(idle.Ended());
  kept->Respond(TextResponse(200, "nobody is there"));  // harmless
}

TEST(HttpServerTest, PortInUseAndBadAddressesAreOneLine) {
  auto server = StartServer(EchoRoutes());
  HttpServerOptions options;
  options.listen = server->address();
  const auto second = HttpServer::Start(options, {});
  EXPECT_EQ(second.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(
      std::string(second.status().message()),
      absl::StrCat("cannot listen for HTTP on ", server->address(), ": Address already in use", kPortInUse));
  for (const char* listen : {"", "127.0.0.1", "127.0.0.1:70000", "127.0.0.1:x", ":80"}) {
    options.listen = listen;
    EXPECT_EQ(HttpServer::Start(options, {}).status().code(), absl::StatusCode::kInvalidArgument) << listen;
  }
}

TEST(HttpServerTest, ManyClientsAtOnce) {
  auto server = StartServer(EchoRoutes());
  std::vector<std::thread> clients;
  for (int c = 0; c < 8; ++c) {
    clients.emplace_back([&server, c] {
      HttpClient client(server->port());
      for (int i = 0; i < 100; ++i) {
        const size_t size = static_cast<size_t>(c * 100 + i + 1);
        EXPECT_EQ(client.Ask("POST", "/length", "", std::string(size, 'x')).body, absl::StrCat(size, "\n"));
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(server->counts().requests, 800u);
}

}  // namespace
}  // namespace docent::server
