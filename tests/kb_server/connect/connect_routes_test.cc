// The bridge over HTTP to services of the test, called in process.
#include "kb_server/connect/connect_routes.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "graph/base/gzip.h"
#include "kb_server/connect/connect_envelope.h"
#include "tests/kb_server/connect/test_services.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

class ConnectRoutesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::ServerBuilder builder;
    builder.RegisterService(&fleet_);
    builder.RegisterService(&workflows_);
    grpc_ = builder.BuildAndStart();
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(-1);
    calls_ = std::make_unique<RpcChannel>(grpc_->InProcessChannel(arguments));
    workers_ = std::make_unique<WorkerPool>(WorkerPoolLimits{2, /*open=*/8, 100});
    ports_ = {calls_.get(), workers_.get(), Limits{}};
    HttpRoutes routes;
    AddConnectRoutes(&routes, {"docent.v1.Fleet", "docent.v1.Workflows"}, &ports_);
    HttpServerOptions options;
    options.listen = "127.0.0.1:0";
    options.allowed_origins = {"http://app.example:5173"};
    auto server = HttpServer::Start(options, std::move(routes));
    ASSERT_TRUE(server.ok()) << server.status();
    http_ = *std::move(server);
  }
  void TearDown() override {
    http_.reset();
    workers_.reset();
    calls_.reset();
    grpc_->Shutdown(std::chrono::system_clock::now());
  }

  HttpReply Post(const std::string& method, const std::string& body, const std::string& headers = "",
                 const std::string& type = "application/json") {
    HttpClient client(http_->port());
    return client.Ask("POST", "/docent.v1." + method, "Content-Type: " + type + "\r\n" + headers, body);
  }
  HttpReply Watch(const std::string& json, const std::string& headers = "") {
    return Post("Workflows/Watch", Enveloped(0, json), headers, "application/connect+json");
  }
  static std::vector<std::pair<int, std::string>> Split(const std::string& body) {
    std::vector<std::pair<int, std::string>> messages;
    for (size_t at = 0; at + 5 <= body.size();) {
      size_t length = 0;
      for (int i = 1; i < 5; ++i) length = length << 8 | static_cast<unsigned char>(body[at + i]);
      messages.emplace_back(body[at], body.substr(at + 5, length));
      at += 5 + length;
    }
    return messages;
  }
  static bool Soon(const std::function<bool()>& what) {
    for (int i = 0; i < 3000 && !what(); ++i) absl::SleepFor(absl::Milliseconds(10));
    return what();
  }

  TestFleet fleet_;
  TestWorkflows workflows_;
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<RpcChannel> calls_;
  std::unique_ptr<WorkerPool> workers_;
  ConnectPorts ports_;
  std::unique_ptr<HttpServer> http_;
};

TEST_F(ConnectRoutesTest, UnaryCalls) {
  const HttpReply json = Post("Fleet/List", "{}");
  EXPECT_EQ(json.status, 200);
  EXPECT_EQ(json.headers.at("content-type"), "application/json");
  EXPECT_EQ(json.body, R"({"robots":[{"label":"R01"}]})");
  EXPECT_GT(fleet_.deadline(), absl::Now() + absl::Hours(24));
  const HttpReply proto = Post("Fleet/List", "", "Connect-Timeout-Ms: 60000\r\n", "application/proto");
  EXPECT_EQ(proto.headers.at("content-type"), "application/proto");
  v1::ListRobotsReply reply;
  ASSERT_TRUE(reply.ParseFromString(proto.body));
  EXPECT_EQ(reply.robots(0).label(), "R01");
  EXPECT_LT(fleet_.deadline(), absl::Now() + absl::Seconds(61));
  HttpClient client(http_->port());
  EXPECT_EQ(client.Ask("GET", "/docent.v1.Fleet/List?encoding=json&message=%7B%7D&connect=v1").body,
            json.body);
  EXPECT_EQ(client.Ask("HEAD", "/docent.v1.Fleet/List?encoding=json&message=%7B%7D").status, 200);
}

TEST_F(ConnectRoutesTest, ErrorsHaveTheirCodeAndStatus) {
  const HttpReply there = Post("Fleet/Join", R"({"address":"a"})");
  EXPECT_EQ(there.status, 409);
  EXPECT_EQ(there.headers.at("content-type"), "application/json");
  EXPECT_EQ(there.body, R"({"code":"already_exists","message":"there is a \"a\""})");
  EXPECT_EQ(Post("Fleet/Join", R"({"adress":"a"})").status, 400);
  EXPECT_EQ(Post("Workflows/Start", "{}").status, 501);  // of the test's service
  const HttpReply unknown = Post("Fleet/Nothing", "{}");
  EXPECT_EQ(unknown.status, 404);
  EXPECT_THAT(unknown.body, HasSubstr("\"code\":\"unimplemented\""));
  EXPECT_THAT(unknown.body, HasSubstr("docent.v1.Fleet has Join, Leave, List"));
  EXPECT_EQ(Post("Fleet/List/x", "{}").status, 404);
  HttpClient client(http_->port());
  EXPECT_EQ(client.Ask("GET", "/docent.v1.Fleet/Join?encoding=json&message=%7B%7D").status, 405);
  EXPECT_EQ(Post("Fleet/List", "{}", "Content-Encoding: br\r\n").status, 501);
}

TEST_F(ConnectRoutesTest, LargeMessagesGoOverTheWorkersAndArePacked) {
  const std::string label(300000, 'x');
  fleet_.SetLabel(label);
  const HttpReply plain = Post("Fleet/List", "{}");
  EXPECT_EQ(plain.body, R"({"robots":[{"label":")" + label + "\"}]}");
  const HttpReply packed = Post("Fleet/List", "{}", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(packed.headers.at("content-encoding"), "gzip");
  EXPECT_LT(packed.body.size(), 10000u);
  EXPECT_EQ(*Gunzip(packed.body, 1u << 20, "x"), plain.body);
  const HttpReply large = Post("Fleet/Join", R"({"address":")" + std::string(200000, 'y') + "\"}");
  EXPECT_EQ(large.status, 409);
}

TEST_F(ConnectRoutesTest, StreamsEndWithAMessageOfTheirEnd) {
  const HttpReply reply = Watch("{}");
  EXPECT_EQ(reply.status, 200);
  EXPECT_TRUE(reply.whole);
  EXPECT_EQ(reply.headers.at("content-type"), "application/connect+json");
  const std::vector<std::pair<int, std::string>> expected = {
      {0, R"({"revision":"1"})"}, {0, R"({"revision":"2"})"}, {0, R"({"revision":"3"})"}, {2, "{}"}};
  EXPECT_EQ(Split(reply.body), expected);
  const auto failed = Split(Watch(R"({"run":"fail"})").body);
  ASSERT_EQ(failed.size(), 2u);
  EXPECT_EQ(failed[1].first, 2);
  EXPECT_EQ(failed[1].second, R"({"error":{"code":"out_of_range","message":"too old"}})");
  const HttpReply bad = Watch(R"({"runs":"x"})");
  EXPECT_EQ(bad.status, 200);
  ASSERT_EQ(Split(bad.body).size(), 1u);
  EXPECT_THAT(Split(bad.body)[0].second, HasSubstr("invalid_argument"));
}

TEST_F(ConnectRoutesTest, MessagesOfStreamsArePacked) {
  workflows_.count = 1;
  workflows_.detail = std::string(5000, 'x');
  const HttpReply reply = Watch("{}", "Connect-Accept-Encoding: gzip\r\n");
  EXPECT_EQ(reply.headers.at("connect-content-encoding"), "gzip");
  const auto messages = Split(reply.body);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].first, 1);
  EXPECT_THAT(*Gunzip(messages[0].second, 1u << 20, "x"), HasSubstr(workflows_.detail));
}

TEST_F(ConnectRoutesTest, ADeadlineEndsAStream) {
  const auto messages = Split(Watch(R"({"run":"hang"})", "Connect-Timeout-Ms: 50\r\n").body);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_THAT(messages[0].second, HasSubstr("deadline_exceeded"));
  EXPECT_TRUE(Soon([this] { return workflows_.ended.load(); }));
}

TEST_F(ConnectRoutesTest, AClientThatLeavesEndsItsCall) {
  HttpClient client(http_->port());
  const std::string body = Enveloped(0, R"({"run":"hang"})");
  client.Send(absl::StrCat("POST /docent.v1.Workflows/Watch HTTP/1.1\r\nHost: localhost:", http_->port(),
                           "\r\nContent-Type: application/connect+json\r\nContent-Length: ", body.size(),
                           "\r\n\r\n") +
              body);
  ASSERT_TRUE(client.AwaitAnswer());  // the head comes at once
  EXPECT_EQ(calls_->open(), 1u);
  client.Close();
  EXPECT_TRUE(Soon([this] { return workflows_.ended && calls_->open() == 0; }));
}

TEST_F(ConnectRoutesTest, AClientThatDoesNotReadHoldsUpItsStreamAndNoMore) {
  workflows_.count = UINT64_MAX;
  workflows_.detail = std::string(10000, 'x');
  HttpClient client(http_->port());
  const std::string body = Enveloped(0, "{}");
  client.Send(absl::StrCat("POST /docent.v1.Workflows/Watch HTTP/1.1\r\nHost: localhost:", http_->port(),
                           "\r\nContent-Type: application/connect+json\r\nContent-Length: ", body.size(),
                           "\r\n\r\n") +
              body);
  ASSERT_TRUE(client.AwaitAnswer());
  uint64_t before = 0;
  EXPECT_TRUE(Soon([&] {  // it stands still
    const uint64_t now = workflows_.written;
    absl::SleepFor(absl::Milliseconds(100));
    return now > 0 && now == workflows_.written && (before = now) > 0;
  }));
  EXPECT_LT(before, 3000u);  // what the system's buffers, and the server's two of a mebibyte, take
  EXPECT_EQ(Post("Fleet/List", "{}").status, 200);
  client.Close();
  EXPECT_TRUE(Soon([this] { return workflows_.ended && calls_->open() == 0; }));
}

TEST_F(ConnectRoutesTest, ManyClientsThatLeaveAtOnceLeaveNothing) {
  workflows_.count = UINT64_MAX;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([this] {
      for (int i = 0; i < 50; ++i) {
        HttpClient client(http_->port());
        const std::string body = Enveloped(0, "{}");
        client.Send(
            absl::StrCat("POST /docent.v1.Workflows/Watch HTTP/1.1\r\nHost: localhost:", http_->port(),
                         "\r\nContent-Type: application/connect+json\r\nContent-Length: ", body.size(),
                         "\r\n\r\n") +
            body);
        if (i % 2 == 0) client.AwaitAnswer();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(Soon([this] { return calls_->open() == 0; })) << calls_->open();
}

TEST_F(ConnectRoutesTest, PagesOfAnotherServerNeedToBeAllowed) {
  HttpClient client(http_->port());
  const std::string ask =
      "Access-Control-Request-Method: POST\r\nAccess-Control-Request-Headers: "
      "content-type,connect-protocol-version\r\n";
  const HttpReply preflight =
      client.Ask("OPTIONS", "/docent.v1.Fleet/List", "Origin: http://app.example:5173\r\n" + ask);
  EXPECT_EQ(preflight.status, 200);
  EXPECT_EQ(preflight.headers.at("access-control-allow-origin"), "http://app.example:5173");
  EXPECT_EQ(preflight.headers.at("access-control-allow-headers"), "content-type,connect-protocol-version");
  EXPECT_THAT(preflight.headers.at("access-control-allow-methods"), HasSubstr("POST"));
  EXPECT_EQ(preflight.headers.at("vary"), "Origin");
  const HttpReply answer = Post("Fleet/List", "{}", "Origin: http://app.example:5173\r\n");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.headers.at("access-control-allow-origin"), "http://app.example:5173");
  const HttpReply other =
      client.Ask("OPTIONS", "/docent.v1.Fleet/List", "Origin: http://evil.example\r\n" + ask);
  EXPECT_EQ(other.status, 403);
  EXPECT_EQ(other.headers.count("access-control-allow-origin"), 0u);
  EXPECT_EQ(Post("Fleet/List", "{}", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(Post("Fleet/List", "{}").headers.count("access-control-allow-origin"), 0u);
}

}  // namespace
}  // namespace docent::server
