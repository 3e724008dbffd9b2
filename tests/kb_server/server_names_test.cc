// Names with blanks, slashes and other characters work from the document to the robot; names that cannot work
// are refused at their place, or left out with a warning.
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string Escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"&", "&amp;"}, {"<", "&lt;"}, {"\"", "&quot;"}});
}

class ServerNamesTest : public ServerWorkflowTest {
 protected:
  // A workflow that invokes an operation of this name; all its parts have the name, too.
  static std::string Workflow(const std::string& name) {
    const std::string n = Escaped(name);
    return absl::StrCat("<CAWL name=\"", n, "\"><flow name=\"", n, "\"><source name=\"s ", n,
                        "\"/><node name=\"", n, "\"><invoke operation=\"", n, "\"/></node><node name=\"", n,
                        " 2\"><wait joinCondition=\"'",
                        absl::StrReplaceAll(n, {{"'", "\\'"}, {"\\", "\\\\"}}), "'\"/></node><sink name=\"e ",
                        n, "\"/><link from=\"s ", n, "\" to=\"", n, "\"/><link from=\"", n, "\" to=\"", n,
                        " 2\"/><link from=\"", n, " 2\" to=\"e ", n, "\"/></flow></CAWL>");
  }
  static std::string Service(const std::string& name) {
    const std::string n = Escaped(name);
    return absl::StrCat("<rsel name=\"S\"><process name=\"service ", n, "\"><invoke operation=\"", n,
                        "\"/></process><process name=\"sink\"><invoke operation=\"", n,
                        "\"/></process></rsel>");
  }
  grpc::Status JoinWith(const std::vector<std::string>& operations, const std::string& address,
                        v1::JoinReply* reply) {
    v1::JoinRequest request;
    request.set_address(address);
    request.mutable_description()->set_robot("urn:w:R1");
    request.mutable_description()->set_incarnation("i1");
    for (const std::string& name : operations)
      request.mutable_description()->add_operations()->set_name(name);
    return Call(fleet_, &v1::Fleet::Stub::Join, request, reply);
  }
};

TEST_F(ServerNamesTest, OddNamesWorkFromTheDocumentToTheRobot) {
  StartServer();
  ScriptedAdapter adapter;
  for (const std::string& name :
       {std::string("Tour A"), std::string("Tour/A"), std::string("100% #1?"), std::string("it's \"me\" <&>"),
        std::string("Führung"), std::string("안내"), std::string("%20"), std::string("$x@y"),
        std::string("and"), std::string("{}|\\^`"), std::string(256 - 8, 'n')}) {
    v1::JoinReply joined;
    ASSERT_TRUE(JoinWith({name}, adapter.address(), &joined).ok()) << name;
    EXPECT_THAT(joined.warnings(), IsEmpty()) << name;
    ASSERT_THAT(Robots(), SizeIs(1));
    EXPECT_THAT(Robots()[0].operations(), ElementsAre(name));
    v1::DeployReply deployed;
    const grpc::Status status = Deploy("w.xml", Workflow(name), &deployed);
    ASSERT_TRUE(status.ok()) << name << ": " << status.error_message();
    EXPECT_THAT(deployed.diagnostics(), IsEmpty()) << deployed.DebugString();
    v1::StartReply start;
    ASSERT_TRUE(StartRun(name, &start).ok()) << name;
    const v1::Run run = WaitForRun(start.run(), "done");
    EXPECT_EQ(run.workflow(), name);
    EXPECT_EQ(run.flow(), name);
    ASSERT_THAT(run.nodes(), SizeIs(2));
    EXPECT_EQ(run.nodes(0).name(), name);
    EXPECT_EQ(run.nodes(0).invocations(0).operation(), name);
    EXPECT_EQ(start.run().find_first_of("/ #?\"<>"), std::string::npos) << start.run();
    EXPECT_TRUE(
        Ask(absl::StrCat("GRAPH ?g { <urn:docent:run:", start.run(), "> a <https://w3id.org/docent#Run> }")));
    ASSERT_TRUE(Register(Service(name)).ok()) << name;
    for (const std::string& process : {"service " + name, std::string("sink")}) {
      grpc::Status invoked;
      const std::vector<v1::InvokeServiceReply> replies = Invoke(process, &invoked);
      ASSERT_TRUE(invoked.ok()) << process << ": " << invoked.error_message();
      EXPECT_EQ(replies.back().state(), "done") << process;
      EXPECT_THAT(replies, Contains(testing::Property(&v1::InvokeServiceReply::step, process)));
    }
  }
}

TEST_F(ServerNamesTest, ASlashIsTriedAsPartOfTheWorkflowsNameFirst) {
  StartServer();
  ASSERT_TRUE(Deploy("a.xml", Workflow("A/B")).ok());
  ASSERT_TRUE(
      Deploy("b.xml", absl::StrReplaceAll(Workflow("B"), {{"CAWL name=\"B\"", "CAWL name=\"A\""}})).ok());
  const auto workflow_of = [&](const std::string& target) {
    v1::StartReply start;
    EXPECT_TRUE(StartRun(target, &start).ok()) << target;
    return GetRun(start.run()).workflow();
  };
  EXPECT_EQ(workflow_of("A/B"), "A/B");
  EXPECT_EQ(workflow_of("A"), "A");
  EXPECT_EQ(workflow_of("A/B/A/B"), "A/B");
}

TEST_F(ServerNamesTest, AVariableIsGivenOneValue) {
  StartServer();
  ASSERT_TRUE(Deploy("a.xml", Workflow("A")).ok());
  v1::StartRequest request;
  request.set_workflow("A");
  for (const char* value : {"1", "2"}) {
    v1::NamedTerm* variable = request.add_variables();
    variable->set_name("user");
    variable->mutable_value()->mutable_literal()->set_lexical(value);
  }
  v1::StartReply reply;
  const grpc::Status status = Call(workflows_, &v1::Workflows::Stub::Start, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("variables.user is given twice"));
}

TEST_F(ServerNamesTest, WhatCannotBeANameIsRefusedAtItsLine) {
  StartServer();
  const std::string text =
      "<CAWL name=\"W\">\n<flow name=\"F\">\n<source name=\"s\"/><node name=\"NODE\"/><sink name=\"e\"/>\n"
      "<link from=\"s\" to=\"NODE\"/><link from=\"NODE\" to=\"e\"/></flow></CAWL>";
  for (const auto& [name, fault] : std::vector<std::pair<std::string, std::string>>{
           {"a&#10;b", "the name holds the control character U+000A"},
           {"a\u202Eb", "the name holds the control character U+202E"},
           {std::string(257, 'x'), "the name has 257 bytes; the limit name_bytes is 256"},
           {"  ", "attribute name of <node> is empty"}}) {
    const grpc::Status status = Deploy("w.xml", absl::StrReplaceAll(text, {{"NODE", name}}));
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), HasSubstr("w.xml:3:31: error: " + fault));
  }
  const grpc::Status status =
      Register("<rsel name=\"S\">\n<process name=\"a&#9;b\"><invoke operation=\"x\"/></process></rsel>");
  EXPECT_THAT(status.error_message(),
              HasSubstr("services.xml:2:16: error: the name holds the control character U+0009"));
}

TEST_F(ServerNamesTest, AModuleIsNotNamedByControlCharactersOrOtherFolders) {
  StartServer();
  for (const std::string& name :
       {std::string("a\nb.ttl"), std::string("a\0b", 3), std::string("a\x7f"), std::string(300, 'x'),
        std::string(".."), std::string("a/../b"), std::string()}) {
    for (const auto kind : {v1::LoadRequest::ONTOLOGY, v1::LoadRequest::RULES}) {
      v1::LoadRequest request;
      request.set_kind(kind);
      request.set_name(name);
      v1::LoadReply reply;
      const grpc::Status status = Call(ontologies_, &v1::Ontologies::Stub::Load, request, &reply);
      EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << name;
      EXPECT_THAT(status.error_message(), HasSubstr("the name "));
    }
    v1::PreviewRulesRequest preview;
    preview.set_name(name);
    v1::PreviewRulesReply of_preview;
    EXPECT_EQ(Call(ontologies_, &v1::Ontologies::Stub::PreviewRules, preview, &of_preview).error_code(),
              grpc::StatusCode::INVALID_ARGUMENT);
  }
  EXPECT_THAT(Register("<rsel name=\"..\"><process name=\"p\"><invoke operation=\"x\"/></process></rsel>")
                  .error_message(),
              HasSubstr("the name of the RSEL document has the part .."));
  EXPECT_THAT(
      Deploy("w.xml",
             "<CAWL name=\"..\"><flow name=\"F\"><source name=\"s\"/><node name=\"N\"/><sink name=\"e\"/>"
             "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/></flow></CAWL>")
          .error_message(),
      HasSubstr("the name of the workflow has the part .."));
}

// It was UNIMPLEMENTED, without a text.
TEST_F(ServerNamesTest, ARequestThatIsNoMessageIsInvalidAndSaysWhy) {
  StartServer();
  const auto raw = [&](const std::string& method, const std::string& bytes, bool packed = false) {
    grpc::GenericStub stub(channel_);
    grpc::ClientContext context;
    Limit(&context);
    if (packed) context.set_compression_algorithm(GRPC_COMPRESS_GZIP);
    const grpc::Slice slice(bytes);
    const grpc::ByteBuffer request(&slice, 1);
    grpc::ByteBuffer reply;
    std::promise<grpc::Status> answer;
    stub.UnaryCall(&context, method, grpc::StubOptions(), &request, &reply,
                   [&answer](grpc::Status status) { answer.set_value(std::move(status)); });
    return answer.get_future().get();
  };
  const std::string not_utf8("\x0A\x02\xFF\xFE", 4);  // field 1, a text of two bytes
  ::testing::internal::CaptureStderr();
  for (const char* method :
       {"/docent.v1.Ontologies/Load", "/docent.v1.Workflows/Deploy", "/docent.v1.Context/Query"}) {
    const grpc::Status text = raw(method, not_utf8);
    EXPECT_EQ(text.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << method;
    EXPECT_THAT(text.error_message(), HasSubstr("a text in it is not UTF-8"));
    const grpc::Status damaged = raw(method, "\xFF\xFF\xFF\xFF");
    EXPECT_EQ(damaged.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << method;
    EXPECT_THAT(damaged.error_message(), HasSubstr("Request: its bytes are damaged or of another type"));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "clients fill no log";
  EXPECT_EQ(raw("/docent.v1.Context/Nothing", "").error_code(), grpc::StatusCode::UNIMPLEMENTED);
  const grpc::Status packed = raw("/docent.v1.Context/Assert", std::string(100000, '\n'), true);
  EXPECT_EQ(packed.error_code(), grpc::StatusCode::UNIMPLEMENTED);
  EXPECT_THAT(packed.error_message(), HasSubstr("gzip"));
}

TEST_F(ServerNamesTest, ARobotJoinsWithAnAddressThatCanBeReached) {
  StartServer();
  for (const char* address :
       {"nope", "127.0.0.1:99999", "127.0.0.1:0", "http://127.0.0.1:1", "127.0.0.1:1/x"}) {
    v1::JoinReply reply;
    const grpc::Status status = JoinWith({"go"}, address, &reply);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << address;
    EXPECT_THAT(status.error_message(), HasSubstr("is not HOST:PORT"));
  }
}

TEST_F(ServerNamesTest, ARobotIsNotNamedAsSomethingOfTheServersOwn) {
  StartServer();
  for (const char* robot :
       {"https://w3id.org/docent#clock", "https://w3id.org/docent#documents", "https://w3id.org/docent#runs",
        "https://w3id.org/docent#inferred", "https://w3id.org/docent#default",
        "https://w3id.org/docent#Robot", "https://w3id.org/docent/ontology/core", "urn:docent:shapes",
        "urn:docent:operator", "urn:docent:run:F-1"}) {
    v1::JoinRequest request;
    request.set_address("127.0.0.1:1");
    request.mutable_description()->set_robot(robot);
    request.mutable_description()->set_incarnation("1");
    v1::JoinReply reply;
    const grpc::Status status = Call(fleet_, &v1::Fleet::Stub::Join, request, &reply);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << robot;
    EXPECT_THAT(status.error_message(), HasSubstr("is a name of the server's own")) << robot;
  }
}

TEST_F(ServerNamesTest, ARobotJoinsWithoutTheOperationsThatCannotBeNamed) {
  StartServer();
  v1::JoinReply reply;
  const std::vector<std::string> names = {"go", "", "a\nb", std::string(300, 'x'), "go", " go", "see/it"};
  ASSERT_TRUE(JoinWith(names, "127.0.0.1:1", &reply).ok());
  EXPECT_THAT(Robots()[0].operations(), ElementsAre("go", "see/it"));
  EXPECT_THAT(reply.warnings(),
              ElementsAre("the name of operation \"\" is empty; the operation is left out",
                          HasSubstr("holds the control character U+000A; the operation is left out"),
                          HasSubstr("has 300 bytes; the limit name_bytes is 256"),
                          "the name of operation \"go\" stands twice; the operation is left out",
                          HasSubstr("\" go\" begins or ends with a blank")));
  v1::JoinReply again;
  ASSERT_TRUE(JoinWith(names, "127.0.0.1:1", &again).ok());
  EXPECT_THAT(again.warnings(), SizeIs(5));
}

}  // namespace
}  // namespace docent::server::test
