// A costly rule has no lasting effect on a server.
#include <gmock/gmock.h>

#include <future>

#include "absl/time/clock.h"

#include "tests/kb_server/server_world.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

// Joins three patterns that share no variable, without a result: hours with 3000 facts.
constexpr char kCross[] =
    "PREFIX : <urn:w:> RULE :cross { ?a :r ?d } WHERE { ?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = "
    "-1) }";

class ServerStepsTest : public test::ServerTest {
 protected:
  void Begin() {
    StartServer();
    std::string facts;
    for (int i = 0; i < 3000; ++i) absl::StrAppend(&facts, ":k", i, " :p ", i, " . ");
    MustTell(facts);
  }
  grpc::Status Preview(v1::PreviewRulesReply* reply) {
    v1::PreviewRulesRequest request;
    request.set_name("cross.rules");
    request.set_text(kCross);
    return Call(ontologies_, &v1::Ontologies::Stub::PreviewRules, request, reply);
  }
};

TEST_F(ServerStepsTest, ARuleWithACostlyJoinIsRefusedAndNamedAndTheServerGoesOn) {
  settings_.limits.steps_per_turn = 1000000;
  Begin();
  const grpc::Status put = Load(v1::LoadRequest::RULES, "cross.rules", kCross);
  EXPECT_EQ(put.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(put.error_message(), HasSubstr("cross.rules cross (line 1)"));
  EXPECT_THAT(put.error_message(), HasSubstr("steps_per_turn"));
  v1::PreviewRulesReply reply;
  EXPECT_THAT(Preview(&reply).error_message(), HasSubstr("steps_per_turn"));
  MustTell(":a :p 1 .");
  StopServer();
  StartServer();
  EXPECT_TRUE(Ask(":a :p 1"));
  MustTell(":b :p 1 .");
}

TEST_F(ServerStepsTest, APreviewEndsAtTheTimeOfQueries) {
  settings_.limits.steps_per_turn = uint64_t{1} << 60;
  settings_.limits.query_timeout_ms = 1000;
  Begin();
  v1::PreviewRulesReply reply;
  const grpc::Status status = Preview(&reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_THAT(status.error_message(), HasSubstr("query_timeout_ms = 1000"));
}

TEST_F(ServerStepsTest, TheEndOfTheServerEndsALongTurnAndAPreview) {
  settings_.limits.steps_per_turn = uint64_t{1} << 60;
  Begin();
  auto put =
      std::async(std::launch::async, [this] { return Load(v1::LoadRequest::RULES, "cross.rules", kCross); });
  auto preview = std::async(std::launch::async, [this] {
    v1::PreviewRulesReply reply;
    return Preview(&reply);
  });
  absl::SleepFor(absl::Milliseconds(300));
  StopServer();
  EXPECT_EQ(put.get().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_FALSE(preview.get().ok());
  StartServer();
  MustTell(":a :p 1 .");
  EXPECT_TRUE(Ask(":k0 :p 0")) << "without the rule, which was not put";
}

}  // namespace
}  // namespace docent::server
