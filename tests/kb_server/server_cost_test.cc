// Expensive conditions are accepted, with a warning that shows their cost.
#include "gmock/gmock.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

std::string Waiting(const std::string& constraint) {
  return R"(<?xml version="1.0"?>
<CAWL name="Waiting" namespace="urn:w:" version="1.0" xmlns:docent="https://w3id.org/docent#">
  <flow name="Wait">
    <source name="start"/>
    <node name="Anything">
      <condition><context name="C"><rule name="r"><constraint name="c">)" +
         constraint + R"(</constraint></rule></context></condition>
    </node>
    <sink name="end"/>
    <link from="start" to="Anything"/>
    <link from="Anything" to="end"/>
  </flow>
</CAWL>
)";
}

TEST_F(ServerWorkflowTest, AConditionThatEveryChangeMatchesIsDeployedWithAWarningThatShowsItsCost) {
  StartServer();
  MustTell(":a :b :c . :d :e :f .");
  v1::DeployReply reply;
  const grpc::Status status =
      Deploy("waiting.xml", Waiting("<subject>?thing</subject><verb>?relation</verb><object>?other</object>"),
             &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(reply.diagnostics_size(), 1) << reply.DebugString();
  const v1::Diagnostic& warning = reply.diagnostics(0);
  EXPECT_TRUE(warning.warning());
  EXPECT_EQ(warning.line(), 6);
  EXPECT_THAT(warning.message(), HasSubstr("node Anything"));
  EXPECT_THAT(warning.message(), HasSubstr("every change"));
  EXPECT_THAT(warning.hint(),
              ::testing::MatchesRegex("one evaluation takes .* ms and 2 solutions on 2 facts; .*"));
}

TEST_F(ServerWorkflowTest, AConditionThatChangesNarrowIsDeployedWithoutOne) {
  StartServer();
  v1::DeployReply reply;
  const grpc::Status status =
      Deploy("waiting.xml",
             Waiting("<subject>?thing</subject><verb>docent:isAt</verb><object>?place</object>"), &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  for (const v1::Diagnostic& diagnostic : reply.diagnostics())
    EXPECT_THAT(diagnostic.message(), ::testing::Not(HasSubstr("expensive")));
}

}  // namespace
}  // namespace docent::server::test
