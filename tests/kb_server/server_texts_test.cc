// Long texts of users and robots: no list and no message grows with them.
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/network_limits.h"
#include "graph/base/text_limits.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr char kHolding[] = R"(
<CAWL name="W" version="1" xmlns:w="urn:w:"><flow name="W"><variable name="text"/><source name="b"/>
<node name="N"><condition><context><rule><constraint><subject>w:never</subject><verb>w:is</verb><object>true</object>
</constraint></rule></context></condition></node><sink name="e"/>
<link from="b" to="N"/><link from="N" to="e"/></flow></CAWL>)";

class ServerTextsTest : public ServerWorkflowTest {
 protected:
  std::string StartWith(size_t bytes) {
    v1::StartRequest request;
    request.set_workflow("W");
    v1::NamedTerm* variable = request.add_variables();
    variable->set_name("text");
    variable->mutable_value()->mutable_literal()->set_lexical(std::string(bytes, 'x'));
    v1::StartReply reply;
    const grpc::Status status = Call(workflows_, &v1::Workflows::Stub::Start, request, &reply);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return reply.run();
  }
  v1::ListRunsReply List(uint32_t page_size, const std::string& token) {
    v1::ListRunsRequest request;
    request.set_page_size(page_size);
    request.set_page_token(token);
    v1::ListRunsReply reply;
    const grpc::Status status = Call(workflows_, &v1::Workflows::Stub::ListRuns, request, &reply);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return reply;
  }
};

TEST_F(ServerTextsTest, ListsCutLongValuesAndGetHasThem) {
  StartServer();
  ASSERT_TRUE(Deploy("w.xml", kHolding).ok());
  const std::string large = StartWith(1000000);
  StartWith(10);
  const v1::ListRunsReply runs = List(0, "");
  ASSERT_THAT(runs.runs(), SizeIs(2));
  EXPECT_FALSE(runs.runs(0).texts_cut());
  EXPECT_TRUE(runs.runs(1).texts_cut());
  EXPECT_THAT(runs.runs(1).variables(0).value().literal().lexical(),
              HasSubstr("xxx… (cut, of 1000000 bytes)"));
  EXPECT_LT(runs.ByteSizeLong(), 10000u);
  const v1::Run whole = GetRun(large);
  EXPECT_FALSE(whole.texts_cut());
  EXPECT_EQ(whole.variables(0).value().literal().lexical().size(), 1000000u);
}

TEST_F(ServerTextsTest, AReasonIsCutAtTheDoor) {
  StartServer();
  ASSERT_TRUE(Deploy("w.xml", kHolding).ok());
  v1::CancelRunRequest cancel;
  cancel.set_run(StartWith(1));
  cancel.set_reason(std::string(kNetworkLimits.request_bytes, 'r'));
  v1::Run run;
  const grpc::Status refused = Call(workflows_, &v1::Workflows::Stub::Cancel, cancel, &run);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED)
      << "the message is larger than the reason";
  EXPECT_THAT(refused.error_message(), HasSubstr("(request_bytes)"));
  cancel.set_reason(std::string(4000000, 'r'));
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::Cancel, cancel, &run).ok());
  EXPECT_THAT(run.reason(), HasSubstr("rrr… (cut, of 4000000 bytes)"));
  EXPECT_LT(run.reason().size(), kTextLimits.message_bytes + 100);
}

TEST_F(ServerTextsTest, ARobotWithALongLabelOrNameDoesNotJoin) {
  StartServer();
  v1::JoinRequest request;
  request.set_address("127.0.0.1:1");
  request.mutable_description()->set_robot("urn:w:R1");
  request.mutable_description()->set_incarnation("i1");
  request.mutable_description()->set_label(std::string(kTextLimits.label_bytes + 1, 'x'));
  v1::JoinReply reply;
  grpc::Status status = Call(fleet_, &v1::Fleet::Stub::Join, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(),
              HasSubstr("description.label has 1025 bytes; the limit label_bytes is 1024"));
  request.mutable_description()->set_label(std::string(kTextLimits.label_bytes, 'x'));
  EXPECT_TRUE(Call(fleet_, &v1::Fleet::Stub::Join, request, &reply).ok());
  request.mutable_description()->add_operations()->set_name(std::string(2000000, 'x'));
  status = Call(fleet_, &v1::Fleet::Stub::Join, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_LT(status.error_message().size(), 200u) << "what is refused is not repeated whole";
}

TEST_F(ServerTextsTest, RobotsComeInPages) {
  StartServer();
  for (int i = 0; i < 5; ++i)
    ASSERT_TRUE(Join(absl::StrCat("urn:w:R", i), absl::StrCat("127.0.0.1:", i + 1)).ok());
  v1::ListRobotsRequest request;
  request.set_page_size(2);
  std::vector<std::string> seen;
  int pages = 0;
  do {
    v1::ListRobotsReply reply;
    ASSERT_TRUE(Call(fleet_, &v1::Fleet::Stub::List, request, &reply).ok());
    for (const v1::RobotStatus& robot : reply.robots()) seen.push_back(robot.robot());
    request.set_page_token(reply.next_page_token());
    ++pages;
  } while (!request.page_token().empty());
  EXPECT_EQ(pages, 3);
  EXPECT_THAT(seen, ::testing::ElementsAre("urn:w:R0", "urn:w:R1", "urn:w:R2", "urn:w:R3", "urn:w:R4"));
}

// 2,500 runs with a text of 4 KiB each are more than a message holds.
TEST_F(ServerTextsTest, APageEndsWhereAMessageIsFull) {
  StartServer();
  ASSERT_TRUE(Deploy("w.xml", kHolding).ok());
  constexpr size_t kRuns = 2500;
  for (size_t i = 0; i < kRuns; ++i) StartWith(5000);
  size_t runs = 0;
  int pages = 0;
  std::string token;
  do {
    const v1::ListRunsReply reply = List(0, token);
    EXPECT_LE(reply.ByteSizeLong(), kTextLimits.listed_bytes + (1u << 20))
        << "the runs, and a little around each";
    runs += static_cast<size_t>(reply.runs_size());
    token = reply.next_page_token();
    ++pages;
  } while (!token.empty());
  EXPECT_EQ(runs, kRuns);
  EXPECT_EQ(pages, 2);
}

}  // namespace
}  // namespace docent::server::test
