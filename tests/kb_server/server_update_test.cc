// SPARQL Update through a whole server: gRPC in, the log, readers.
#include <functional>
#include <thread>

#include "gmock/gmock.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAreArray;

class ServerUpdateTest : public ServerTest {
 protected:
  grpc::Status Update(const std::string& text, v1::AssertReply* reply = nullptr, const std::string& id = "") {
    v1::UpdateRequest request;
    request.set_update("PREFIX : <urn:w:> " + text);
    request.set_request_id(id);
    v1::AssertReply unused;
    return Call(context_, &v1::Context::Stub::Update, request, reply == nullptr ? &unused : reply);
  }
  std::vector<std::string> All() {
    return Query("SELECT ?s ?p ?o ?g { GRAPH ?g { ?s ?p ?o } FILTER(STRSTARTS(STR(?p), 'urn:w:')) }").rows;
  }
};

TEST_F(ServerUpdateTest, AnUpdateIsVisibleWhenItIsAnswered) {
  StartServer();
  v1::AssertReply reply;
  grpc::Status status = Update("INSERT DATA { :a :p 1 . GRAPH :g { :a :p 2 } }", &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(reply.added(), 2u);
  EXPECT_GT(reply.offset(), 0u);
  EXPECT_THAT(All(), SizeIs(2));
  ASSERT_TRUE(Update("DELETE { ?s :p ?o } INSERT { ?s :q ?o } WHERE { ?s :p ?o }", &reply).ok());
  EXPECT_EQ(reply.removed(), 1u) << "templates without GRAPH mean docent:default, whatever WHERE sees";
  EXPECT_EQ(reply.added(), 2u);
}

TEST_F(ServerUpdateTest, WhatIsWrongIsSaidAndChangesNothing) {
  StartServer();
  grpc::Status status = Update("INSERT DATA { :a :p 1 } ; DELETE DATA { ?x :p 1 }");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("^"));
  status = Update("INSERT DATA { :a :p 1 } ; INSERT DATA { GRAPH docent:inferred { :a :p 1 } }");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("docent:inferred"));
  status = Update("LOAD <file:///etc/passwd>");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED) << status.error_message();
  EXPECT_EQ(Update("INSERT DATA { :a :p 1 }", nullptr, std::string(257, 'x')).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(All(), IsEmpty());
}

TEST_F(ServerUpdateTest, ARepeatedRequestIsNotAppliedAgain) {
  StartServer();
  v1::AssertReply first, second;
  ASSERT_TRUE(Update("INSERT DATA { :a :p [] }", &first, "id-1").ok());
  ASSERT_TRUE(Update("INSERT DATA { :a :p [] }", &second, "id-1").ok());
  EXPECT_TRUE(second.repeated());
  EXPECT_EQ(first.offset(), second.offset());
  EXPECT_THAT(All(), SizeIs(1));
}

TEST_F(ServerUpdateTest, ReplayGivesTheValuesThatWereMade) {
  StartServer();
  ASSERT_TRUE(Update("INSERT DATA { :a :p 1 . :b :p 2 }").ok());
  ASSERT_TRUE(
      Update("INSERT { ?s :now ?n ; :uuid ?u ; :random ?r ; :blank ?b, [] } "
             "WHERE { ?s :p ?o BIND(NOW() AS ?n) BIND(UUID() AS ?u) BIND(RAND() AS ?r) BIND(BNODE() AS ?b) }")
          .ok());
  const std::vector<std::string> before = All();
  EXPECT_THAT(before, SizeIs(2 + 10));
  StopServer();
  StartServer();
  EXPECT_THAT(All(), UnorderedElementsAreArray(before));
}

// Each increment may read its value before the others are written; none is lost.
void CountTogether(const std::function<grpc::Status()>& increment, int each) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&increment, each] {
      for (int k = 0; k < each; ++k) {
        grpc::Status status = increment();
        EXPECT_TRUE(status.ok()) << status.error_message();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

constexpr char kIncrement[] = "DELETE { :c :n ?o } INSERT { :c :n ?p } WHERE { :c :n ?o BIND(?o + 1 AS ?p) }";

TEST_F(ServerUpdateTest, ConcurrentUpdatesLoseNothing) {
  StartServer();
  ASSERT_TRUE(Update("INSERT DATA { :c :n 0 }").ok());
  CountTogether([this] { return Update(kIncrement); }, 25);
  EXPECT_THAT(Query("SELECT ?n { <urn:w:c> <urn:w:n> ?n }").rows, ElementsAre("\"100\""));
}

TEST_F(ServerUpdateTest, UpdatesOnTheWritersTurnLoseNothing) {
  settings_.limits.update_attempts = 0;
  StartServer();
  ASSERT_TRUE(Update("INSERT DATA { :c :n 0 }").ok());
  CountTogether([this] { return Update(kIncrement); }, 25);
  EXPECT_THAT(Query("SELECT ?n { <urn:w:c> <urn:w:n> ?n }").rows, ElementsAre("\"100\""));
}

TEST_F(ServerUpdateTest, AnEvaluationOnTheWritersTurnEndsAtItsLimit) {
  settings_.limits.update_attempts = 0;
  settings_.limits.update_turn_ms = 1;
  StartServer();
  std::string data;
  for (int i = 0; i < 200; ++i) data += ":s" + std::to_string(i) + " :p " + std::to_string(i) + " . ";
  ASSERT_TRUE(Update("INSERT DATA { " + data + " }").ok());
  grpc::Status status =
      Update("INSERT { :x :y ?n } WHERE { { SELECT (COUNT(*) AS ?n) { ?a :p ?b . ?c :p ?d . ?e :p ?f } } }");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::ABORTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("update_turn_ms = 1"));
  EXPECT_THAT(All(), SizeIs(200));
}

}  // namespace
}  // namespace docent::server::test
