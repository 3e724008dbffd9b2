// What one client has at work does not keep others waiting: heavy queries, joins that wait for a silent adapter, imports from a
// silent server; and a server that stops ends all of it.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "tests/kb_server/http/http_client.h"
#include "tests/kb_server/http/read_metric.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

// Takes connections, as far as the system does so by itself, and says nothing.
class SilentServer {
 public:
  SilentServer() : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(socket_, generic, size), 0);
    EXPECT_EQ(listen(socket_, 1000), 0);
    EXPECT_EQ(getsockname(socket_, generic, &size), 0);
    address_ = absl::StrCat("127.0.0.1:", ntohs(address.sin_port));
  }
  ~SilentServer() { close(socket_); }
  const std::string& address() const { return address_; }

 private:
  const int socket_;
  std::string address_;
};

class ServerSharesTest : public ServerTest {
 protected:
  double Metric(const std::string& name) { return ReadMetric(http_port(), name); }
  static void AwaitTrue(const std::function<bool()>& what) {
    for (int i = 0; i < 6000 && !what(); ++i) absl::SleepFor(absl::Milliseconds(10));
    EXPECT_TRUE(what());
  }
  void TellMany() {
    v1::AssertRequest request;
    for (int i = 0; i < 5000; ++i) {
      v1::Quad* quad = request.add_add();
      quad->mutable_subject()->set_iri(absl::StrCat("urn:w:s", i));
      quad->mutable_predicate()->set_iri("urn:w:p");
      quad->mutable_object()->mutable_literal()->set_lexical(absl::StrCat(i));
    }
    ASSERT_TRUE(Assert(request).ok());
  }
  // Queries that take far longer than a test, each of a client of its own.
  void BeginHeavy(int count) {
    for (int i = 0; i < count; ++i) {
      heavy_.emplace_back([this] {
        HttpClient client(http_port());
        const HttpReply reply = client.Ask(
            "POST", "/sparql", "Content-Type: application/sparql-query\r\n",
            "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f FILTER(STRLEN(?c) = STRLEN(?f) + 1000) }");
        if (reply.status == 200 || reply.status == 504) ++ended_by_itself_;
      });
    }
    AwaitTrue([&] { return Metric("docent_work_begun") >= count; });
  }
  void JoinHeavy() {
    for (std::thread& one : heavy_) one.join();
    heavy_.clear();
  }

  std::vector<std::thread> heavy_;
  std::atomic<int> ended_by_itself_{0};
};

TEST_F(ServerSharesTest, SmallWorkPassesHeavyWorkAndAStopEndsAll) {
  StartServer();
  TellMany();
  BeginHeavy(30);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(Ask(":s1 :p ?o"));
    MustTell(absl::StrCat(":a :b ", i, " ."));
  }
  EXPECT_EQ(ended_by_itself_, 0) << "they are at work all the time";
  StopServer();
  JoinHeavy();
  EXPECT_EQ(ended_by_itself_, 0) << "they were ended";
}

TEST_F(ServerSharesTest, JoinsThatAskASilentAdapterTakeNoPlace) {
  StartServer();
  const SilentServer adapter;
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  std::atomic<int> refused = 0;
  std::vector<std::thread> rivals;
  for (int i = 0; i < 8; ++i) {
    rivals.emplace_back([this, i, &refused] {
      const grpc::Status status = Join("urn:w:R1", absl::StrCat("127.0.0.1:", 2000 + i));
      EXPECT_EQ(status.error_code(), grpc::StatusCode::ALREADY_EXISTS) << status.error_message();
      ++refused;
    });
  }
  while (refused < 8) {
    EXPECT_EQ(Metric("docent_work_begun"), 0);
    absl::SleepFor(absl::Milliseconds(20));
  }
  for (std::thread& one : rivals) one.join();
}

TEST_F(ServerSharesTest, ImportsFromASilentServerTakeNoPlaceAndEndAtAStop) {
  const SilentServer silent;
  settings_.allow = {"http://" + silent.address()};
  settings_.limits.queries_running = 1;
  settings_.limits.queries_short = 0;
  StartServer();
  std::vector<std::thread> imports;
  for (int i = 0; i < 5; ++i) {
    imports.emplace_back([this, &silent] {
      v1::ImportTemplatesRequest request;
      request.set_grpc_target(silent.address());
      v1::ImportTemplatesReply reply;
      EXPECT_FALSE(Call(services_, &v1::RobotServices::Stub::ImportTemplates, request, &reply).ok());
    });
  }
  AwaitTrue([&] { return Metric("docent_work_begun") == 5; });
  EXPECT_EQ(Metric("docent_work_running"), 0);
  EXPECT_FALSE(Ask(":nothing :is :here"));
  StopServer();
  for (std::thread& one : imports) one.join();
}

}  // namespace
}  // namespace docent::server::test
