// Live connections over HTTP to services of the test.
#include "kb_server/live/live.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "graph/store/graph_writer.h"
#include "tests/kb_server/connect/test_services.h"
#include "tests/kb_server/http/http_client.h"
#include "tests/kb_server/live/websocket_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr size_t kBodiesBytes = 4u << 20;  // beside the first 256 KiB of each

class LiveTest : public ::testing::Test {
 protected:
  void SetUp() override { Start({}); }
  void TearDown() override { Stop(); }
  void Start(WebLimits limits) {
    Stop();
    grpc::ServerBuilder builder;
    builder.RegisterService(&fleet_);
    builder.RegisterService(&workflows_);
    grpc_ = builder.BuildAndStart();
    calls_ = std::make_unique<RpcChannel>(grpc_->InProcessChannel({}));
    workers_ = std::make_unique<WorkerPool>(WorkerPoolLimits{2, /*open=*/8, 100});
    Publish(41);
    live_ = std::make_unique<Live>(LivePorts{calls_.get(),
                                             workers_.get(),
                                             &queries_,
                                             &followed_,
                                             {"docent.v1.Fleet", "docent.v1.Workflows"},
                                             limits});
    HttpRoutes routes;
    live_->AddRoute(&routes);
    HttpServerOptions options;
    options.listen = "127.0.0.1:0";
    options.bodies_bytes = kBodiesBytes;
    http_ = *HttpServer::Start(options, std::move(routes));
  }
  void Stop() {
    if (live_) live_->Stop();
    http_.reset();
    workers_.reset();
    calls_.reset();
    live_.reset();
    if (grpc_) grpc_->Shutdown(std::chrono::system_clock::now());
  }
  void Publish(uint64_t revision) {
    GraphWriter writer(std::make_shared<const GraphVersion>());
    queries_.Publish(writer.Freeze(Revision(revision)));
  }
  // A turn that tells, or withdraws, a fact of a predicate.
  void Turn(uint64_t revision, const std::string& predicate, bool add = true) {
    const Quad fact{dictionary_.InternIri("s"), dictionary_.InternIri(predicate), dictionary_.InternIri("o"),
                    dictionary_.InternIri("g")};
    GraphWriter writer(queries_.Newest());
    const Delta delta = add ? writer.Apply({fact}, {}) : writer.Apply({}, {fact});
    const GraphVersionPtr version = writer.Freeze(Revision(revision));
    followed_.Add(*version, {&delta}, /*others=*/false);
    queries_.Publish(version);
  }
  static bool Soon(const std::function<bool()>& what) {
    for (int i = 0; i < 3000 && !what(); ++i) absl::SleepFor(absl::Milliseconds(10));
    return what();
  }

  TestFleet fleet_;
  TestWorkflows workflows_;
  Dictionary dictionary_;
  QueryPort queries_;
  FollowedReads followed_{&dictionary_};
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<RpcChannel> calls_;
  std::unique_ptr<WorkerPool> workers_;
  std::unique_ptr<Live> live_;
  std::unique_ptr<HttpServer> http_;
};

TEST_F(LiveTest, StreamsAndReadsShareAConnection) {
  WebSocketClient tab(http_->port());
  EXPECT_THAT(tab.head(), StartsWith("HTTP/1.1 101 "));
  EXPECT_THAT(tab.head(), HasSubstr("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
  EXPECT_EQ(tab.Receive(), R"({"hello":{"revision":"41"}})");
  tab.Send(R"({"id":1,"call":"docent.v1.Workflows/Watch"})");
  EXPECT_EQ(tab.Receive(), R"({"id":1,"begun":true,"resume":"41:0"})");
  EXPECT_EQ(tab.Receive(), R"({"id":1,"message":{"revision":"1"},"resume":"0:1"})");
  EXPECT_EQ(tab.Receive(), R"({"id":1,"message":{"revision":"2"},"resume":"1:1"})");
  EXPECT_EQ(tab.Receive(), R"({"id":1,"message":{"revision":"3"},"resume":"2:1"})");
  EXPECT_EQ(tab.Receive(), R"({"id":1,"end":{}})");
  tab.Send(
      R"({"id":1,"call":"docent.v1.Workflows/Watch","request":{"run":"fail"}})");  // the id is free again
  EXPECT_EQ(tab.Receive(), R"({"id":1,"begun":true,"resume":"41:0"})");
  EXPECT_THAT(tab.Receive(), HasSubstr("\"message\""));
  EXPECT_EQ(tab.Receive(), R"({"id":1,"end":{"error":{"code":"out_of_range","message":"too old"}}})");
  tab.Send(R"({"id":"r","call":"docent.v1.Fleet/List"})");
  EXPECT_EQ(tab.Receive(), R"({"id":"r","begun":true})");
  EXPECT_THAT(tab.Receive(), StartsWith(R"({"id":"r","message":{"robots":[{"label":"R01"}]},"resume":")"));
}

// A message that is begun counts as a body of HTTP does; the first 256 KiB of a connection are free.
TEST_F(LiveTest, BegunMessagesCountInTheServersBudget) {
  std::vector<std::unique_ptr<WebSocketClient>> tabs;
  const auto begin = [&] {
    tabs.push_back(std::make_unique<WebSocketClient>(http_->port()));
    tabs.back()->Receive();
    tabs.back()->SendBytes(ClientFrame(0x01, std::string(900000, ' ')));  // a text frame, not the last one
  };
  begin();
  EXPECT_TRUE(Soon([&] { return http_->counts().body_bytes >= 600000; }));
  tabs.front()->SendBytes(ClientFrame(0x80, "{}"));  // its end
  EXPECT_THAT(tabs.front()->Receive(), HasSubstr("\"refused\""));
  EXPECT_TRUE(Soon([&] { return http_->counts().body_bytes == 0; }));
  for (int i = 0; i < 8; ++i) begin();  // of which four fit
  EXPECT_TRUE(Soon([&] { return live_->open() <= 5; })) << "the others are told to try again";
  EXPECT_LE(http_->counts().body_bytes, kBodiesBytes);
}

// 256 of a MiB each would be a quarter of a GiB for each connection.
TEST_F(LiveTest, RequestsThatAreFollowedCountInTheServersBudget) {
  WebSocketClient tab(http_->port());
  tab.Receive();
  const auto follow = [&](int id, size_t bytes) {
    tab.Send(absl::StrCat(R"({"id":)", id, R"(,"call":"docent.v1.Fleet/List","request":{"pageToken":")",
                          std::string(bytes, 'x'), "\"}}"));
    EXPECT_THAT(tab.Receive(), StartsWith(absl::StrCat("{\"id\":", id, ",\"begun\":true")));
    EXPECT_THAT(tab.Receive(), HasSubstr("\"message\""));
  };
  const auto held_about = [&](size_t bytes) {
    return Soon([&] {
      const size_t held =
          http_->counts().body_bytes + (256u << 10);  // of each connection, on top of the budget
      return held >= bytes && held < bytes + 1000;
    });
  };
  follow(1, 800000);
  EXPECT_TRUE(held_about(800000)) << http_->counts().body_bytes;
  follow(2, 400000);
  EXPECT_TRUE(held_about(1200000)) << http_->counts().body_bytes;
  tab.Send(R"({"id":1,"end":true})");
  EXPECT_TRUE(held_about(400000)) << http_->counts().body_bytes;
  tab.Send(R"({"id":2,"end":true})");
  EXPECT_TRUE(Soon([&] { return http_->counts().body_bytes == 0; }));
}

// They would hold up the others on the network thread. What comes behind them on the same connection waits.
TEST_F(LiveTest, LargeMessagesAreReadByWorkersInOrder) {
  absl::Notification go_on;
  for (int i = 0; i < 2; ++i) {  // all workers
    workers_->Submit({.run = [&] { go_on.WaitForNotification(); }, .refuse = [](const absl::Status&) {}});
  }
  WebSocketClient tab(http_->port()), other(http_->port());
  tab.Receive();
  other.Receive();
  const std::string blanks(100000, ' ');
  tab.Send(R"({"id":1,)" + blanks + R"("call":"docent.v1.Workflows/Watch","request":{"run":"hang"}})");
  tab.Send(R"({"id":1,"end":true})");
  tab.Send(R"({"id":1,"call":"nothing"})");
  tab.Send("[" + blanks + "]");
  other.Send(R"({"id":1,"call":"docent.v1.Fleet/List"})");
  EXPECT_EQ(other.Receive(), R"({"id":1,"begun":true})");
  EXPECT_TRUE(Soon([this] { return http_->counts().body_bytes > 0; }));
  EXPECT_EQ(workflows_.ended, false);
  go_on.Notify();
  EXPECT_THAT(tab.Receive(), StartsWith(R"({"id":1,"begun":true)"));
  EXPECT_EQ(tab.Receive(), R"({"id":1,"end":{}})");
  EXPECT_THAT(tab.Receive(), StartsWith(R"({"id":1,"refused":{"code":"not_found")"));
  EXPECT_THAT(tab.Receive(), HasSubstr("no JSON object"));
  EXPECT_TRUE(Soon([this] { return calls_->open() == 0 && http_->counts().body_bytes == 0; }));
}

TEST_F(LiveTest, ATabThatLeavesTakesItsLargeMessagesAlong) {
  absl::Notification go_on;
  for (int i = 0; i < 2; ++i) {
    workers_->Submit({.run = [&] { go_on.WaitForNotification(); }, .refuse = [](const absl::Status&) {}});
  }
  {
    WebSocketClient tab(http_->port());
    tab.Receive();
    for (int i = 0; i < 5; ++i) tab.Send("[" + std::string(100000, ' ') + "]");
    EXPECT_TRUE(Soon([this] { return http_->counts().body_bytes > 0; }));
  }
  go_on.Notify();
  EXPECT_TRUE(Soon([this] { return live_->open() == 0 && http_->counts().body_bytes == 0; }));
}

// Pings come meanwhile: the connection is not silent.
TEST_F(LiveTest, AMessageThatDoesNotArriveEndsTheConnection) {
  WebLimits limits;
  limits.live_silence_ms = 300;
  Start(limits);
  WebSocketClient tab(http_->port());
  tab.Receive();
  tab.SendBytes(ClientFrame(0x01, "{"));
  uint8_t first = 0x8a;
  std::string payload;
  while (first == 0x8a) {
    tab.SendBytes(ClientFrame(0x89, "p"));
    payload = tab.Receive(&first);
  }
  EXPECT_EQ(first, 0x88);
  EXPECT_THAT(payload, HasSubstr("did not arrive"));
}

TEST_F(LiveTest, AReadIsToldWhenItsAnswerChanges) {
  WebSocketClient tab(http_->port());
  tab.Receive();
  tab.Send(R"({"id":1,"call":"docent.v1.Fleet/List","everyMs":1})");
  tab.Receive();
  const std::string first = tab.Receive();
  Publish(42);  // the answer is the same
  absl::SleepFor(absl::Milliseconds(200));
  fleet_.SetLabel("R02");
  Publish(43);
  EXPECT_THAT(tab.Receive(), StartsWith(R"({"id":1,"message":{"robots":[{"label":"R02"}]})"));
  // A tab that comes back with what it has gets nothing until something changes.
  WebSocketClient again(http_->port());
  again.Receive();
  fleet_.SetLabel("R01");
  const std::string mark =
      first.substr(first.find("\"resume\""), first.size() - first.find("\"resume\"") - 1);
  again.Send(R"({"id":1,"call":"docent.v1.Fleet/List",)" + mark + "}");
  EXPECT_EQ(again.Receive(), R"({"id":1,"begun":true})");
  absl::SleepFor(absl::Milliseconds(200));
  fleet_.SetLabel("R03");
  Publish(44);
  EXPECT_THAT(again.Receive(), HasSubstr("R03"));
}

// Lists what is read of facts "p".
TEST_F(LiveTest, AReadIsAskedAgainWhereItsAnswerMayHaveChanged) {
  fleet_.OnList([this](const grpc::CallbackServerContext& context) {
    const auto named = context.client_metadata().find(kTraceKey);
    ASSERT_NE(named, context.client_metadata().end());
    const auto trace = followed_.Find(std::string_view(named->second.data(), named->second.size()));
    ASSERT_NE(trace, nullptr);
    const ReadTrace::Scope scope(trace.get());
    queries_.Newest()->Scan({{}, *dictionary_.FindIri("p"), {}, {}});
    trace->SetWhole();
  });
  WebSocketClient tab(http_->port());
  tab.Receive();  // turns are kept soon
  Turn(42, "p");
  Turn(43, "q");
  tab.Send(R"({"id":1,"call":"docent.v1.Fleet/List","everyMs":1})");
  tab.Receive();
  EXPECT_THAT(tab.Receive(), HasSubstr("R01"));
  uint64_t revision = 43;
  std::map<std::string, bool> there = {{"p", true}, {"q", true}};
  const auto asked_again = [&](const std::string& predicate) {
    const size_t before = fleet_.listed();
    there[predicate] = !there[predicate];
    Turn(++revision, predicate, there[predicate]);
    for (int i = 0; i < 15 && fleet_.listed() == before; ++i) absl::SleepFor(absl::Milliseconds(20));
    return fleet_.listed() > before;
  };
  EXPECT_TRUE(Soon([&] { return asked_again("p") && !asked_again("q"); }));
  fleet_.SetLabel("R02");
  EXPECT_TRUE(Soon([&] { return asked_again("p"); }));
  EXPECT_THAT(tab.Receive(), HasSubstr("R02"));
}

TEST_F(LiveTest, ATabEndsItsStreams) {
  WebSocketClient tab(http_->port());
  tab.Receive();
  tab.Send(R"({"id":1,"call":"docent.v1.Workflows/Watch","request":{"run":"hang"}})");
  tab.Receive();
  EXPECT_TRUE(Soon([this] { return calls_->open() == 1; }));
  tab.Send(R"({"id":1,"call":"docent.v1.Workflows/Watch"})");
  EXPECT_THAT(tab.Receive(), HasSubstr(R"({"id":1,"refused":{"code":"already_exists")"));
  tab.Send(R"({"id":1,"end":true})");
  EXPECT_EQ(tab.Receive(), R"({"id":1,"end":{}})");
  EXPECT_TRUE(Soon([this] { return calls_->open() == 0 && workflows_.ended; }));
  tab.Send(R"({"id":1,"end":true})");  // it has ended
  tab.Send(R"({"id":2,"call":"docent.v1.Fleet/Join"})");
  EXPECT_THAT(tab.Receive(), HasSubstr(R"({"id":2,"refused":{"code":"failed_precondition")"));
  tab.Send("nonsense");
  EXPECT_THAT(tab.Receive(), HasSubstr(R"({"id":null,"refused":{"code":"invalid_argument")"));
  tab.Send(R"({"id":3,"call":"docent.v1.Fleet/List","request":{"no":1}})");
  EXPECT_THAT(tab.Receive(), HasSubstr(R"({"id":3,"end":{"error":{"code":"invalid_argument")"));
}

TEST_F(LiveTest, ATabThatLeavesLeavesNothing) {
  for (int i = 0; i < 20; ++i) {
    WebSocketClient tab(http_->port());
    tab.Send(R"({"id":1,"call":"docent.v1.Workflows/Watch","request":{"run":"hang"}})");
    tab.Send(R"({"id":2,"call":"docent.v1.Fleet/List"})");
    if (i % 2 == 0) tab.Receive();
    if (i % 3 == 0) tab.SendBytes(ClientFrame(0x88, std::string("\x03\xe8", 2)));
  }
  EXPECT_TRUE(
      Soon([this] { return calls_->open() == 0 && live_->open() == 0 && http_->counts().open == 0; }));
}

// Else a stop would wait behind what tabs have sent: each message begins a call.
TEST_F(LiveTest, AStopDropsWhatTabsSend) {
  fleet_.Hold();
  WebSocketClient tab(http_->port());
  tab.Receive();
  tab.Send(R"({"id":1,"call":"docent.v1.Fleet/List"})");
  EXPECT_THAT(tab.Receive(), HasSubstr("begun"));
  EXPECT_TRUE(Soon([this] { return fleet_.listed() == 1; }));
  live_->Stop();
  EXPECT_TRUE(Soon([this] { return fleet_.held() == 1; }));
  fleet_.LetGo();
  for (int i = 2; i < 100; ++i) tab.Send(absl::StrCat("{\"id\":", i, ",\"call\":\"docent.v1.Fleet/List\"}"));
  EXPECT_THAT(tab.Receive(), HasSubstr("the server stops"));
  EXPECT_TRUE(tab.Ended());
  tab.Close();
  EXPECT_TRUE(Soon([this] { return http_->counts().open == 0 && calls_->open() == 0; }));
  EXPECT_EQ(fleet_.listed(), 1u);
}

TEST_F(LiveTest, ClosesAsItIsAsked) {
  WebSocketClient tab(http_->port());
  tab.Receive();
  tab.SendBytes(ClientFrame(0x89, "are you there"));
  uint8_t first = 0;
  EXPECT_EQ(tab.Receive(&first), "are you there");
  EXPECT_EQ(first, 0x8a);
  tab.SendBytes(ClientFrame(0x88, std::string("\x03\xe8", 2)));
  EXPECT_EQ(tab.Receive(&first), std::string("\x03\xe8", 2));
  EXPECT_EQ(first, 0x88);
  EXPECT_TRUE(tab.Ended());
}

TEST_F(LiveTest, OtherRequestsAndOtherPagesAreRefused) {
  HttpClient client(http_->port());
  const HttpReply plain = client.Ask("GET", "/live");
  EXPECT_EQ(plain.status, 426);
  EXPECT_EQ(plain.headers.at("upgrade"), "websocket");
  EXPECT_EQ(client.Ask("POST", "/live").status, 405);
  EXPECT_THAT(WebSocketClient(http_->port(), "Origin: http://evil.example\r\n").head(),
              StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(
      WebSocketClient(http_->port(), absl::StrCat("Origin: http://localhost:", http_->port(), "\r\n")).head(),
      StartsWith("HTTP/1.1 101 "));
}

TEST_F(LiveTest, SoManyReadsOfATabAreAskedAtATime) {
  Start({.live_reads_asked = 2});
  fleet_.Hold();
  WebSocketClient tab(http_->port());
  tab.Receive();
  for (int id = 1; id <= 5; ++id) {
    tab.Send(absl::StrCat(R"({"id":)", id, R"(,"call":"docent.v1.Fleet/List"})"));
    EXPECT_EQ(tab.Receive(), absl::StrCat(R"({"id":)", id, R"(,"begun":true})"));
  }
  EXPECT_TRUE(Soon([this] { return fleet_.held() == 2; })) << "at the limit";
  absl::SleepFor(absl::Milliseconds(100));
  EXPECT_EQ(fleet_.held(), 2u) << "one past it waits";
  WebSocketClient other(http_->port());
  other.Receive();
  other.Send(R"({"id":1,"call":"docent.v1.Fleet/List"})");
  EXPECT_TRUE(Soon([this] { return fleet_.held() == 3; })) << "another tab has its own";
  fleet_.LetGo();
  for (int i = 0; i < 5; ++i) EXPECT_THAT(tab.Receive(), HasSubstr(R"("label":"R01")"));
}

TEST_F(LiveTest, ATabFollowsSoMuchAndNoMore) {
  WebLimits limits;
  limits.live_streams = 2;
  limits.live_message_bytes = 100;
  Start(limits);
  WebSocketClient tab(http_->port());
  tab.Receive();
  for (int i = 1; i <= 2; ++i) {
    tab.Send(
        absl::StrCat(R"({"id":)", i, R"(,"call":"docent.v1.Workflows/Watch","request":{"run":"hang"}})"));
    EXPECT_THAT(tab.Receive(), HasSubstr("begun"));
  }
  tab.Send(R"({"id":3,"call":"docent.v1.Workflows/Watch"})");
  EXPECT_THAT(tab.Receive(), HasSubstr("the limit live_streams is 2"));
  tab.Send(std::string(101, ' '));
  EXPECT_THAT(tab.Receive(), HasSubstr("live_message_bytes = 100"));
  EXPECT_TRUE(tab.Ended());
}

TEST_F(LiveTest, SilentConnectionsAreProbedAndThenClosed) {
  WebLimits limits;
  limits.live_ping_ms = 50;
  limits.live_silence_ms = 400;
  Start(limits);
  WebSocketClient tab(http_->port());
  tab.Receive();
  uint8_t first = 0;
  tab.Receive(&first);
  EXPECT_EQ(first, 0x89);
  std::string frame;
  while (first == 0x89) frame = tab.Receive(&first);
  EXPECT_EQ(first, 0x88);
  EXPECT_THAT(frame, HasSubstr("live_silence_ms"));
  EXPECT_TRUE(tab.Ended());
  EXPECT_TRUE(Soon([this] { return live_->open() == 0; }));
}

TEST_F(LiveTest, TheStreamsOfATabThatAsksAndDoesNotReadEnd) {
  workflows_.count = UINT64_MAX;
  workflows_.detail = std::string(10000, 'x');
  WebSocketClient tab(http_->port());
  tab.Send(R"({"id":1,"call":"docent.v1.Workflows/Watch"})");
  uint64_t before = 0;
  EXPECT_TRUE(Soon([&] {  // nothing more fits
    before = workflows_.written;
    absl::SleepFor(absl::Milliseconds(100));
    return before > 0 && before == workflows_.written;
  }));
  for (int i = 0; i < 2000; ++i) tab.SendBytes(ClientFrame(0x89, "p"));
  EXPECT_TRUE(Soon([this] { return calls_->open() == 0 && workflows_.ended; }));
  EXPECT_EQ(http_->counts().open, 1u) << "by the limit, not because the connection ended";
}

TEST_F(LiveTest, ATabThatDoesNotReadHoldsUpItsStreamAndNoMore) {
  workflows_.count = UINT64_MAX;
  workflows_.detail = std::string(10000, 'x');
  WebSocketClient tab(http_->port());
  tab.Send(R"({"id":1,"call":"docent.v1.Workflows/Watch"})");
  uint64_t before = 0;
  EXPECT_TRUE(Soon([&] {  // it stands still
    before = workflows_.written;
    absl::SleepFor(absl::Milliseconds(100));
    return before > 0 && before == workflows_.written;
  }));
  EXPECT_LT(before, 3000u);
  WebSocketClient other(http_->port());
  EXPECT_THAT(other.Receive(), HasSubstr("hello"));
  tab.Close();
  EXPECT_TRUE(Soon([this] { return calls_->open() == 0 && workflows_.ended; }));
}

}  // namespace
}  // namespace docent::server
