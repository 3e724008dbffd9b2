// Subscribe over gRPC: the answer, its changes, resuming, throttling, many clients.
#include <cstdlib>
#include <map>
#include <set>

#include "gmock/gmock.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ServerSubscribeTest : public ServerTest {
 protected:
  // One subscription that is read by the test.
  struct Client {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::SubscribeReply>> reader;
    v1::SubscribeReply reply;
    std::map<std::string, uint64_t> rows;

    ~Client() {
      if (reader == nullptr) return;
      context.TryCancel();
      v1::SubscribeReply rest;
      while (reader->Read(&rest)) {
      }
      reader->Finish();
    }
    // The next whole change.
    bool Next() {
      do {
        if (!reader->Read(&reply)) return false;
        if (reply.reset()) rows.clear();
        for (const v1::CountedRow& row : reply.appeared()) rows[Show(row.row())] += row.count();
        for (const v1::CountedRow& row : reply.disappeared()) {
          if ((rows[Show(row.row())] -= row.count()) == 0) rows.erase(Show(row.row()));
        }
      } while (reply.more());
      return true;
    }
  };

  std::unique_ptr<Client> Follow(const std::string& query, const std::string& resume = "",
                                 uint32_t interval_ms = 0) {
    auto client = std::make_unique<Client>();
    Limit(&client->context);
    v1::SubscribeRequest request;
    request.set_query("PREFIX : <urn:w:> " + query);
    request.set_resume(resume);
    request.set_min_interval_ms(interval_ms);
    client->reader = context_->Subscribe(&client->context, request);
    return client;
  }
};

TEST_F(ServerSubscribeTest, FirstTheAnswerThenEachChangeInOrder) {
  StartServer();
  MustTell(":a :p 1 . :a :p 2 .");
  auto client = Follow("SELECT ?v { :a :p ?v }");
  ASSERT_TRUE(client->Next());
  EXPECT_TRUE(client->reply.reset());
  EXPECT_THAT(client->reply.variables(), ElementsAre("v"));
  EXPECT_EQ(client->rows.size(), 2u);
  for (int i = 3; i < 30; ++i) MustTell(absl::StrCat(":a :p ", i, " ."));
  for (int i = 3; i < 30; ++i) {
    ASSERT_TRUE(client->Next());
    EXPECT_EQ(client->reply.sequence(), static_cast<uint64_t>(i - 1));
    EXPECT_FALSE(client->reply.reset());
    EXPECT_EQ(client->rows.size(), static_cast<size_t>(i));
    EXPECT_EQ(client->rows.count(absl::StrCat("\"", i, "\"")), 1u);
  }
}

TEST_F(ServerSubscribeTest, AnAskFlipsBothWays) {
  StartServer();
  auto client = Follow("ASK { ?x :ready true }");
  ASSERT_TRUE(client->Next());
  EXPECT_TRUE(client->reply.is_boolean());
  EXPECT_FALSE(client->reply.boolean());
  MustTell(":r :ready true .");
  ASSERT_TRUE(client->Next());
  EXPECT_TRUE(client->reply.boolean());
  v1::AssertRequest gone;
  v1::Quad* quad = gone.add_remove();
  quad->mutable_subject()->set_iri("urn:w:r");
  quad->mutable_predicate()->set_iri("urn:w:ready");
  quad->mutable_object()->mutable_literal()->set_lexical("true");
  quad->mutable_object()->mutable_literal()->set_datatype("http://www.w3.org/2001/XMLSchema#boolean");
  ASSERT_TRUE(Assert(gone).ok());
  ASSERT_TRUE(client->Next());
  EXPECT_FALSE(client->reply.boolean());
}

TEST_F(ServerSubscribeTest, WhoComesBackHearsWhatWasMissedAndNothingTwice) {
  StartServer();
  auto client = Follow("SELECT ?v { :a :p ?v }");
  ASSERT_TRUE(client->Next());
  MustTell(":a :p 1 .");
  ASSERT_TRUE(client->Next());
  const std::string resume = client->reply.resume();
  auto rows = client->rows;
  client.reset();
  MustTell(":a :p 2 .");
  MustTell(":a :p 3 .");
  client = Follow("SELECT ?v { :a :p ?v }", resume);
  client->rows = rows;
  std::set<std::string> ids;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(client->Next());
    EXPECT_FALSE(client->reply.reset());
    EXPECT_TRUE(ids.insert(client->reply.id()).second);
  }
  EXPECT_EQ(client->rows.size(), 3u);

  // after a restart of the server, or with a token of another query: the whole answer, marked as such
  auto other = Follow("SELECT ?v { :b :p ?v }", resume);
  ASSERT_TRUE(other->Next());
  EXPECT_TRUE(other->reply.reset());
  const std::string late = client->reply.resume();
  client.reset();
  other.reset();
  StopServer();
  StartServer();
  client = Follow("SELECT ?v { :a :p ?v }", late);
  ASSERT_TRUE(client->Next());
  EXPECT_TRUE(client->reply.reset());
  EXPECT_EQ(client->rows.size(), 3u);
}

TEST_F(ServerSubscribeTest, ThrottledChangesAreAddedUp) {
  StartServer();
  auto client = Follow("SELECT ?v { :a :p ?v }", "", 300);
  ASSERT_TRUE(client->Next());
  for (int i = 0; i < 20; ++i) MustTell(absl::StrCat(":a :p ", i, " ."));
  int replies = 0;
  while (client->rows.size() < 20 && client->Next()) ++replies;
  EXPECT_EQ(client->rows.size(), 20u);
  EXPECT_LT(replies, 20);
}

TEST_F(ServerSubscribeTest, ALargeAnswerComesInParts) {
  StartServer();
  std::string facts;
  for (int i = 0; i < 1200; ++i) absl::StrAppend(&facts, ":a :p ", i, " . ");
  MustTell(facts);
  auto client = Follow("SELECT ?v { :a :p ?v }");
  ASSERT_TRUE(client->Next());
  EXPECT_EQ(client->reply.sequence(), 3u);
  EXPECT_EQ(client->rows.size(), 1200u);
}

TEST_F(ServerSubscribeTest, BadQueriesAreRefusedWithTheirPlace) {
  StartServer();
  auto client = Follow("SELECT ?v { :a :p ?v ");
  EXPECT_FALSE(client->Next());
  const grpc::Status status = client->reader->Finish();
  client->reader = nullptr;
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("1:"));
}

TEST_F(ServerSubscribeTest, ManyFollowAndEachHearsItsOwn) {
  StartServer();
  const char* given = std::getenv("DOCENT_SUBSCRIBERS");  // to try more than a test should
  const int clients_wanted = given != nullptr ? std::atoi(given) : 500;
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < clients_wanted; ++i)
    clients.push_back(Follow(absl::StrCat("ASK { :x", i, " :on true }")));
  for (auto& client : clients) {
    ASSERT_TRUE(client->Next());
    EXPECT_FALSE(client->reply.boolean());
  }
  const absl::Time begin = absl::Now();
  std::string facts;
  for (int i = 0; i < clients_wanted; i += 2) absl::StrAppend(&facts, ":x", i, " :on true . ");
  MustTell(facts);
  for (int i = 0; i < clients_wanted; i += 2) {
    ASSERT_TRUE(clients[static_cast<size_t>(i)]->Next());
    EXPECT_TRUE(clients[static_cast<size_t>(i)]->reply.boolean());
  }
  RecordProperty("told_to_heard_by_all_ms", static_cast<int>(absl::ToInt64Milliseconds(absl::Now() - begin)));
  // one fact, one client
  const absl::Time one = absl::Now();
  MustTell(":x1 :on true .");
  ASSERT_TRUE(clients[1]->Next());
  RecordProperty("told_to_heard_us", static_cast<int>(absl::ToInt64Microseconds(absl::Now() - one)));
}

}  // namespace
}  // namespace docent::server::test
