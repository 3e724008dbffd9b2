#include "kb_server/live/live_request.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include "docent/v1/fleet.pb.h"
#include "docent/v1/robot_services.pb.h"
#include "docent/v1/workflows.pb.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<LiveRequest> Read(const std::string& text, std::string* id = nullptr) {
  (void)v1::ListRobotsRequest::descriptor();
  (void)v1::WatchRequest::descriptor();
  (void)v1::RobotService::descriptor();
  std::string unused;
  return ReadLiveRequest(text, {"docent.v1.Fleet", "docent.v1.Workflows"}, id != nullptr ? id : &unused);
}

TEST(LiveRequestTest, ReadsWhatIsFollowed) {
  const auto watch =
      Read(R"({"id":7,"call":"docent.v1.Workflows/Watch","request":{"run":"r"},"resume":"3:1"})");
  ASSERT_TRUE(watch.ok()) << watch.status();
  EXPECT_EQ(watch->id, "7");
  EXPECT_EQ(watch->method->full_name(), "docent.v1.Workflows.Watch");
  EXPECT_EQ(watch->request, R"({"run":"r"})");
  EXPECT_EQ(watch->resume, "3:1");
  const auto list = Read(R"({"id":"rob\"ots","call":"docent.v1.Fleet/List","everyMs":200})");
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_EQ(list->id, R"("rob\"ots")");
  EXPECT_EQ(list->request, "{}");
  EXPECT_EQ(list->every, absl::Milliseconds(200));
  EXPECT_TRUE(Read(R"({"id":7,"end":true})")->end);
}

TEST(LiveRequestTest, TheRequestIsTheTextOfItsObject) {
  for (const std::string request :
       {R"({"run":"}{"})", "{ \n}", R"({"a":{"request":{}},"b":[{}, {"c":"ü€\\\""}],"d":1})"}) {
    for (const std::string& text :
         {R"({"request":)" + request + R"(,"id":1,"resume":"r","call":"docent.v1.Fleet/List"})",
          R"( {"everyMs":5, "call":"docent.v1.Fleet/List","id":1,"request" : )" + request + " } "}) {
      const auto read = Read(text);
      ASSERT_TRUE(read.ok()) << text << read.status();
      EXPECT_EQ(read->request, request) << text;
    }
  }
}

TEST(LiveRequestTest, EndsWithItsCancellation) {
  Cancellation cancellation;
  cancellation.Cancel();
  std::string id;
  const auto read =
      ReadLiveRequest(R"({"id":1,"call":"docent.v1.Fleet/List"})", {"docent.v1.Fleet"}, &id, &cancellation);
  EXPECT_TRUE(absl::IsCancelled(read.status())) << read.status();
}

TEST(LiveRequestTest, SaysWhatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "no JSON object"},
      {"[1]", "no JSON object"},
      {"{\"id\":1", "no JSON object"},
      {R"({"call":"docent.v1.Fleet/List"})", "\"id\" is missing"},
      {R"({"id":1.5,"call":"docent.v1.Fleet/List"})", "\"id\""},
      {R"({"id":{},"call":"docent.v1.Fleet/List"})", "\"id\""},
      {R"({"id":1})", "\"call\" is missing"},
      {R"({"id":1,"call":7})", "\"call\" is missing"},
      {R"({"id":1,"end":false})", "\"end\":true"},
      {R"({"id":1,"end":true,"call":"docent.v1.Fleet/List"})", "\"end\":true"},
      {R"({"id":1,"call":"docent.v1.Fleet"})", "no method"},
      {R"({"id":1,"call":"docent.v1.Fleet/Nothing"})", "no method"},
      {R"({"id":1,"call":"docent.v1.RobotServices/List"})", "no method"},  // it is not served
      {R"({"id":1,"call":"docent.v1.Fleet/Join"})", "change nothing"},
      {R"({"id":1,"call":"docent.v1.Fleet/List","request":[]})", "\"request\""},
      {R"({"id":1,"call":"docent.v1.Fleet/List","resume":1})", "\"resume\""},
      {R"({"id":1,"call":"docent.v1.Fleet/List","everyMs":-1})", "\"everyMs\""},
      {R"({"id":1,"call":"docent.v1.Fleet/List","everyMs":"1"})", "\"everyMs\""},
      {R"({"id":1,"call":"docent.v1.Fleet/List","everyMs":18446744073709551615})", "\"everyMs\""},
      {R"({"id":1,"call":"docent.v1.Fleet/List","every":1})", "no \"every\""},
      {R"({"id":1,"call":"docent.v1.Fleet/List","call":"docent.v1.Fleet/List"})", "twice"},
      {R"({"id":1,"call":"docent.v1.Fleet/List","request":{"a":{"b":1,"b":2}}})", "twice"},
  };
  for (const auto& [text, message] : cases) {
    const auto request = Read(text);
    ASSERT_FALSE(request.ok()) << text;
    EXPECT_THAT(request.status().message(), HasSubstr(message)) << text;
  }
  std::string id;
  EXPECT_FALSE(Read(R"({"id":7,"call":1})", &id).ok());
  EXPECT_EQ(id, "7");
  EXPECT_FALSE(Read(R"({"id":7,"call":1,"call":1})", &id).ok());
  EXPECT_EQ(id, "7");
  EXPECT_FALSE(Read(R"({"id":")" + std::string(100, 'x') + "\"}", &id).ok());
  EXPECT_EQ(id, "null");
}

// A list of so many objects, or so many names, would take minutes if each were compared with all before it.
TEST(LiveRequestTest, ManyPartsAreReadInLinearTime) {
  std::string objects, names;
  for (int i = 0; i < 300000; ++i) objects += "{},";
  for (int i = 0; i < 100000; ++i) names += "\"" + std::to_string(i) + "\":{},";
  const auto with = [](const std::string& request) {
    return Read(R"({"id":1,"call":"docent.v1.Fleet/List","request":{)" + request + "}}");
  };
  EXPECT_TRUE(with("\"a\":[" + objects + "1]").ok());
  EXPECT_TRUE(with(names + "\"a\":1").ok());
  EXPECT_THAT(with(names + "\"7\":1").status().message(), HasSubstr("twice"));
}

TEST(LiveRequestTest, NestingIsBounded) {
  const auto nested = [](int depth) {
    return R"({"id":1,"call":"docent.v1.Fleet/List","request":{"a":)" + std::string(depth, '[') +
           std::string(depth, ']') + "}}";
  };
  EXPECT_TRUE(Read(nested(60)).ok());
  EXPECT_THAT(Read(nested(70)).status().message(), HasSubstr("inside each other"));
  EXPECT_FALSE(Read(nested(400000)).ok());
}

}  // namespace
}  // namespace docent::server
