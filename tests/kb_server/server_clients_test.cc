// Clients that read slowly or not at all, wait for future revisions, or reconnect: their results, and that
// other clients do not notice.
#include <atomic>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "tests/kb_server/http/http_client.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ServerClientsTest : public ServerWorkflowTest {
 protected:
  // A query whose client reads only when the test says so.
  struct Slow {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::QueryReply>> reader;
    v1::QueryReply reply;

    // The status after all rows.
    grpc::Status Finish() {
      while (reader->Read(&reply)) continue;
      return reader->Finish();
    }
  };
  std::unique_ptr<Slow> Begin(const std::string& query, uint64_t min_revision = 0, uint32_t timeout_ms = 0) {
    auto slow = std::make_unique<Slow>();
    Limit(&slow->context);
    v1::QueryRequest request;
    request.set_query(query);
    request.set_min_revision(min_revision);
    request.set_timeout_ms(timeout_ms);
    slow->reader = context_->Query(&slow->context, request);
    return slow;
  }
  // `count` facts with a text of 1 kB each.
  void TellWords(int count) {
    v1::AssertRequest request;
    for (int i = 0; i < count; ++i) {
      v1::Quad* quad = request.add_add();
      quad->mutable_subject()->set_iri("urn:w:s");
      quad->mutable_predicate()->set_iri("urn:w:p");
      quad->mutable_object()->mutable_literal()->set_lexical(absl::StrCat(i, std::string(1000, 'x')));
    }
    ASSERT_TRUE(Assert(request).ok());
  }
};

constexpr char kAll[] = "SELECT * { ?s ?p ?o }";
constexpr char kPairs[] = "SELECT * { ?a ?b ?c . ?d ?e ?f }";

TEST_F(ServerClientsTest, ClientsThatDoNotReadHarmNobody) {
  settings_.limits.stream_messages = 10;
  settings_.limits.queries_running = 2;
  StartServer();
  TellWords(2000);
  std::vector<std::unique_ptr<Slow>> slow;
  for (int i = 0; i < 5; ++i) {
    slow.push_back(Begin(kAll));
    ASSERT_TRUE(slow.back()->reader->Read(&slow.back()->reply)) << "the header: it is at work";
  }
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(Ask(":s :p ?o"));
  for (auto& one : slow) {
    int rows = 0;
    while (one->reader->Read(&one->reply)) rows += one->reply.has_row();
    EXPECT_TRUE(one->reader->Finish().ok()) << "slow, but within the limit";
    EXPECT_EQ(rows, 2000);
  }
}

TEST_F(ServerClientsTest, AClientThatTakesNothingForTooLongLosesItsStream) {
  settings_.limits.stream_messages = 10;
  settings_.limits.slow_client_ms = 100;
  settings_.limits.crowded_client_ms = 600000;  // or it goes for the sake of the others
  settings_.limits.queries_open = 1;
  StartServer();
  TellWords(2000);
  auto slow = Begin(kPairs);
  ASSERT_TRUE(slow->reader->Read(&slow->reply));
  EXPECT_TRUE(Ask(":s :p ?o")) << "begins when the slow one has been given up";
  grpc::Status status = slow->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("slow_client_ms = 100"));
}

TEST_F(ServerClientsTest, WhereOthersWaitAClientThatDoesNotReadLosesItsPlaceSoon) {
  settings_.limits.stream_messages = 10;
  settings_.limits.queries_open = 2;
  settings_.limits.crowded_client_ms = 50;
  StartServer();
  TellWords(2000);
  std::vector<std::unique_ptr<Slow>> slow;
  for (int i = 0; i < 6; ++i) slow.push_back(Begin(kPairs));
  ASSERT_TRUE(slow[0]->reader->Read(&slow[0]->reply));
  const absl::Time start = absl::Now();
  EXPECT_TRUE(Ask(":s :p ?o"));
  EXPECT_LT(absl::Now() - start, absl::Milliseconds(settings_.limits.slow_client_ms));
  grpc::Status status = slow[0]->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("crowded_client_ms = 50"));
}

TEST_F(ServerClientsTest, WhereOthersWaitAnHttpClientThatDoesNotReadLosesItsPlaceSoon) {
  settings_.limits.queries_open = 2;
  settings_.limits.crowded_client_ms = 50;
  StartServer();
  TellWords(2000);
  std::vector<std::unique_ptr<HttpClient>> slow;
  for (int i = 0; i < 4; ++i) {
    slow.push_back(std::make_unique<HttpClient>(http_port()));
    slow.back()->Send(
        "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
        "application/sparql-query\r\nContent-Length: " +
        absl::StrCat(std::string(kPairs).size()) + "\r\n\r\n" + kPairs);
  }
  ASSERT_TRUE(slow[0]->AwaitAnswer());
  EXPECT_TRUE(Ask(":s :p ?o"));
  EXPECT_FALSE(slow[0]->Receive().whole) << "cut, and the client sees it";
}

// Many clients that request a little and read nothing, each within its own limits.
TEST_F(ServerClientsTest, AllThatIsMadeForClientsTogetherHasALimit) {
  settings_.limits.streams_bytes = 1 << 20;
  StartServer();
  TellWords(2000);
  std::vector<std::unique_ptr<Slow>> slow;
  for (int i = 0; i < 20; ++i) slow.push_back(Begin(absl::StrCat(kPairs, " LIMIT 4000")));
  int cut = 0;
  for (auto& one : slow) {
    absl::SleepFor(absl::Milliseconds(100));
    const grpc::Status status = one->Finish();
    if (status.ok()) continue;
    ++cut;
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("streams_bytes = 1048576"));
  }
  EXPECT_GT(cut, 0);
  EXPECT_TRUE(Ask(":s :p ?o"));
}

TEST_F(ServerClientsTest, ASlowClientIsGivenUpAtTheTimeLimitOfItsQuery) {
  settings_.limits.stream_messages = 10;
  settings_.limits.queries_open = 1;
  StartServer();
  TellWords(2000);
  auto slow = Begin(kPairs, 0, 300);
  ASSERT_TRUE(slow->reader->Read(&slow->reply));
  EXPECT_TRUE(Ask(":s :p ?o")) << "begins when the slow one has been given up";
  grpc::Status status = slow->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << status.error_message();
}

TEST_F(ServerClientsTest, TheStreamIsBoundedInBytesToo) {
  settings_.limits.stream_bytes = 10000;
  settings_.limits.stream_messages = 1000000;
  settings_.limits.slow_client_ms = 100;
  settings_.limits.queries_open = 1;
  StartServer();
  TellWords(900);
  auto slow = Begin(kPairs);
  ASSERT_TRUE(slow->reader->Read(&slow->reply));
  EXPECT_TRUE(Ask(":s :p ?o"));
  EXPECT_EQ(slow->Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

TEST_F(ServerClientsTest, AnAnswerThatIsMadeButNotTakenIsDroppedToo) {
  settings_.limits.slow_client_ms = 50;
  settings_.limits.stream_messages = 1000000;  // all of it fits into the queue
  settings_.limits.stream_bytes = 1 << 30;
  StartServer();
  TellWords(200);
  grpc::StatusCode code = grpc::StatusCode::OK;
  for (int i = 1; i <= 50 && code == grpc::StatusCode::OK; ++i) {
    auto slow = Begin(absl::StrCat(kPairs, " LIMIT 10000"));
    ASSERT_TRUE(slow->reader->Read(&slow->reply));
    std::this_thread::sleep_for(std::chrono::milliseconds(100 * i));
    code = slow->Finish().error_code();
  }
  EXPECT_EQ(code, grpc::StatusCode::RESOURCE_EXHAUSTED);
}

// They hold no thread either, of which there is one.
TEST_F(ServerClientsTest, ThoseWhoWaitForARevisionHarmNobody) {
  settings_.limits.queries_running = 1;
  settings_.limits.queries_open = 1;
  StartServer();
  std::vector<std::unique_ptr<Slow>> waiting;
  for (int i = 0; i < 5; ++i) waiting.push_back(Begin("ASK {}", 1));
  v1::QueryRequest request;
  request.set_query("ASK {}");
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));  // less than theirs
  auto reader = context_->Query(&context, request);
  v1::QueryReply reply;
  EXPECT_TRUE(reader->Read(&reply));
  EXPECT_TRUE(reader->Finish().ok());
  MustTell(":a :b :c .");
  for (auto& one : waiting) {
    EXPECT_TRUE(one->Finish().ok());
    EXPECT_EQ(one->reply.header().revision(), 1u);
  }
}

TEST_F(ServerClientsTest, ARevisionFarAheadIsRefusedAtOnce) {
  StartServer();
  const grpc::Status status = Begin("ASK {}", 999999999)->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::OUT_OF_RANGE) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("revisions_ahead"));
  for (const char* path :
       {"/sparql?query=ASK%7B%7D&min-revision=999999999", "/rdf-graphs?default&min-revision=999999999"})
    EXPECT_EQ(HttpClient(http_port()).Ask("GET", path).status, 400) << path;
}

TEST_F(ServerClientsTest, UpdatesThatWaitForARevisionHarmNobody) {
  settings_.limits.queries_running = 1;
  settings_.limits.queries_open = 1;
  StartServer();
  std::vector<std::thread> waiting;
  std::atomic<int> done = 0;
  for (int i = 0; i < 5; ++i) {
    waiting.emplace_back([this, &done] {
      v1::UpdateRequest request;
      request.set_update("INSERT DATA { <urn:w:s> <urn:w:p> 1 }");
      request.set_min_revision(1);
      v1::AssertReply reply;
      if (Call(context_, &v1::Context::Stub::Update, request, &reply).ok()) ++done;
    });
  }
  // while all of them wait, other clients get answers
  absl::SleepFor(absl::Milliseconds(300));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));  // less than theirs
  v1::QueryRequest query;
  query.set_query("ASK {}");
  auto reader = context_->Query(&context, query);
  v1::QueryReply reply;
  EXPECT_TRUE(reader->Read(&reply));
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_EQ(done, 0);
  MustTell(":a :b :c .");
  for (std::thread& one : waiting) one.join();
  EXPECT_EQ(done, 5);
}

class ServerWatchTest : public ServerWorkflowTest {
 protected:
  // "revision kind node to" of the events after `after`, until a run is done or the stream ends.
  std::vector<std::string> Watch(uint64_t after, const std::string& run, grpc::Status* status) {
    grpc::ClientContext context;
    Limit(&context);
    v1::WatchRequest request;
    request.set_after(after);
    request.set_run(run);
    auto reader = workflows_->Watch(&context, request);
    std::vector<std::string> events;
    v1::RunEvent event;
    while (reader->Read(&event)) {
      events.push_back(absl::StrCat(event.revision(), " ", event.kind(), " ", event.node(), " ", event.to()));
      if (event.kind() == "run" && event.to() == "done") context.TryCancel();
    }
    *status = reader->Finish();
    return events;
  }
  // A run from its start to its end; the revision before it.
  uint64_t RunOnce(const std::string& id) {
    uint64_t before = Revision();
    v1::StartReply start;
    EXPECT_TRUE(StartRun("Greeting", &start).ok());
    EXPECT_EQ(start.run(), id);
    WaitForRun(id, "done");
    return before;
  }
};

TEST_F(ServerWatchTest, WhoComesBackHearsWhatWasMissed) {
  StartServer();
  ScriptedAdapter adapter;
  SetUpGreeting(adapter.address());
  MustTell(":John docent:isAt :Hall ; docent:feels docent:Glad . :R1 docent:isAt :Hall .");
  uint64_t before = RunOnce("Greet-1");
  RunOnce("Greet-2");
  grpc::Status status;
  std::vector<std::string> events = Watch(before, "", &status);
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.front(), absl::StrCat(before + 1, " run  running"));
  EXPECT_THAT(events.back(), HasSubstr(" run  done"));
  std::vector<std::string> second = Watch(before, "Greet-2", &status);
  ASSERT_FALSE(second.empty());
  EXPECT_THAT(second.front(), HasSubstr(" run  running"));
  EXPECT_NE(second.front(), events.front());

  StopServer();
  StartServer();
  EXPECT_EQ(Watch(before, "", &status), events) << "after a restart, too";
}

TEST_F(ServerWatchTest, WhoComesBackTooLateIsToldSo) {
  settings_.limits.run_events_kept = 3;
  StartServer();
  ScriptedAdapter adapter;
  SetUpGreeting(adapter.address());
  MustTell(":John docent:isAt :Hall ; docent:feels docent:Glad . :R1 docent:isAt :Hall .");
  uint64_t before = RunOnce("Greet-1");
  grpc::Status status;
  EXPECT_THAT(Watch(before, "", &status), IsEmpty());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::OUT_OF_RANGE);
  EXPECT_THAT(status.error_message(), HasSubstr(absl::StrCat("after revision ", before)));
}

}  // namespace
}  // namespace docent::server::test
