// Typed parts, versions, generator and imports of robot services over gRPC.
#include "gmock/gmock.h"
#include "graph/wire/term_proto.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kTour[] = R"(<rsel name="Tour" version="1.0" xmlns:docent="https://w3id.org/docent#">
  <message name="In"><part name="booth" type="docent:Booth"/><part name="times" type="xsd:integer"/></message>
  <process name="present" input="In">
    <invoke operation="show"><input part="booth" from="booth"/><output part="page" to="page"/></invoke>
    <invoke operation="say"><input part="times" from="times"/></invoke>
  </process>
</rsel>
)";

class ServiceRepositoryTest : public ServerWorkflowTest {
 protected:
  void SetUpRobot() {
    MustTell(kStates);
    MustTell(
        "<urn:b3> a docent:Booth . <urn:v1> a docent:Visitor . docent:Stand "
        "<http://www.w3.org/2000/01/rdf-schema#subClassOf> docent:Booth . "
        "<urn:s1> a docent:Stand .");
    v1::JoinRequest join;
    join.set_address(adapter_.address());
    v1::RobotDescription* robot = join.mutable_description();
    robot->set_robot("urn:w:R1");
    robot->set_incarnation("i1");
    v1::OperationDescription* show = robot->add_operations();
    show->set_name("show");
    show->set_description("Shows a page");
    SetPart(show->add_input_parts(), "booth", "docent:Booth");
    SetPart(show->add_output_parts(), "page", "xsd:anyURI");
    v1::OperationDescription* say = robot->add_operations();
    say->set_name("say");
    SetPart(say->add_input_parts(), "times", "http://www.w3.org/2001/XMLSchema#integer");
    SetPart(say->add_input_parts(), "page", "xsd:anyURI");
    v1::JoinReply reply;
    const grpc::Status status = Call(fleet_, &v1::Fleet::Stub::Join, join, &reply);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  static void SetPart(v1::Part* part, const std::string& name, const std::string& type) {
    part->set_name(name);
    part->set_type(type);
  }
  static void AddArgument(const std::string& name, const Term& value, v1::InvokeServiceRequest* request) {
    v1::NamedTerm* argument = request->add_arguments();
    argument->set_name(name);
    ToProto(value, argument->mutable_value());
  }
  std::string Refused(const v1::InvokeServiceRequest& request) {
    grpc::ClientContext context;
    Limit(&context);
    auto reader = services_->Invoke(&context, request);
    v1::InvokeServiceReply reply;
    EXPECT_FALSE(reader->Read(&reply)) << reply.DebugString();
    return reader->Finish().error_message();
  }
  v1::RobotService Describe(const std::string& name) {
    v1::DescribeServiceRequest request;
    request.set_name(name);
    v1::RobotService service;
    const grpc::Status status = Call(services_, &v1::RobotServices::Stub::Describe, request, &service);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return service;
  }
  v1::ListVersionsReply Versions(const std::string& document) {
    v1::ListServiceVersionsRequest request;
    request.set_document(document);
    request.set_with_texts(true);
    v1::ListVersionsReply reply;
    const grpc::Status status = Call(services_, &v1::RobotServices::Stub::ListVersions, request, &reply);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return reply;
  }
  grpc::Status Remove(const std::string& document, bool force) {
    v1::RemoveServicesRequest request;
    request.set_document(document);
    request.set_force(force);
    v1::RemoveServicesReply reply;
    return Call(services_, &v1::RobotServices::Stub::Remove, request, &reply);
  }

  ScriptedAdapter adapter_{[](const v1::InvokeRequest& request) {
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::SUCCEEDED);
    if (request.operation() != "show") return feedback;
    v1::NamedTerm* page = feedback.add_results();
    page->set_name("page");
    page->mutable_value()->set_iri("urn:page");
    return feedback;
  }};
};

TEST_F(ServiceRepositoryTest, AServiceIsDescribedWithTypes) {
  StartServer();
  SetUpRobot();
  ASSERT_TRUE(Register(kTour).ok());
  const v1::RobotService service = Describe("present");
  ASSERT_EQ(service.input_parts_size(), 2);
  EXPECT_EQ(service.input_parts(0).type(), "https://w3id.org/docent#Booth");
  ASSERT_EQ(service.output_parts_size(), 1);
  EXPECT_EQ(service.output_parts(0).name(), "page");
  EXPECT_EQ(service.output_parts(0).type(), "http://www.w3.org/2001/XMLSchema#anyURI") << "as the robot says";
  EXPECT_EQ(service.registered_version(), 1u);
  EXPECT_GT(service.revision(), 0u);
}

TEST_F(ServiceRepositoryTest, ArgumentsAreCheckedAgainstTheTypes) {
  StartServer();
  SetUpRobot();
  ASSERT_TRUE(Register(kTour).ok());
  v1::InvokeServiceRequest request;
  request.set_name("present");
  const std::string takes = "it takes booth (docent:Booth) and times (xsd:integer)";
  EXPECT_THAT(Refused(request), HasSubstr("needs a value for booth and times; " + takes));
  AddArgument("booth", Term::Literal("B03"), &request);
  AddArgument("times", Term::Integer(2), &request);
  EXPECT_THAT(Refused(request),
              HasSubstr("\"B03\" as booth, which is a literal, and docent:Booth is a class"));
  ToProto(Term::Iri("urn:v1"), request.mutable_arguments(0)->mutable_value());
  EXPECT_THAT(Refused(request), HasSubstr("which is of docent:Visitor, not of docent:Booth; " + takes));
  ToProto(Term::Iri("urn:b3"), request.mutable_arguments(0)->mutable_value());
  ToProto(Term::Literal("two"), request.mutable_arguments(1)->mutable_value());
  EXPECT_THAT(Refused(request), HasSubstr("is of xsd:string, not of xsd:integer"));
  ToProto(Term::Integer(2), request.mutable_arguments(1)->mutable_value());
  AddArgument("colour", Term::Literal("red"), &request);
  EXPECT_THAT(Refused(request), HasSubstr("has no part colour; " + takes));
  request.mutable_arguments()->RemoveLast();
  request.set_robot("urn:w:R9");
  EXPECT_THAT(Refused(request), HasSubstr("there is no robot <urn:w:R9>; there are <urn:w:R1>"));
  request.set_robot("");
  request.set_name("presnet");
  EXPECT_THAT(Refused(request), HasSubstr("did you mean present?"));
}

TEST_F(ServiceRepositoryTest, ProgressAndResultsComeBack) {
  StartServer();
  SetUpRobot();
  ASSERT_TRUE(Register(kTour).ok());
  v1::InvokeServiceRequest request;
  request.set_name("present");
  AddArgument("booth", Term::Iri("urn:s1"), &request);  // of a class below Booth
  AddArgument("times", Term::Integer(2), &request);
  grpc::ClientContext context;
  Limit(&context);
  auto reader = services_->Invoke(&context, request);
  std::vector<v1::InvokeServiceReply> replies;
  for (v1::InvokeServiceReply reply; reader->Read(&reply);) replies.push_back(reply);
  ASSERT_TRUE(reader->Finish().ok());
  ASSERT_FALSE(replies.empty());
  double before = 0;
  for (const v1::InvokeServiceReply& reply : replies) {
    EXPECT_GE(reply.progress(), before) << reply.DebugString();
    before = reply.progress();
  }
  EXPECT_EQ(replies.back().progress(), 1);
  ASSERT_EQ(replies.back().results_size(), 1);
  EXPECT_EQ(replies.back().results(0).value().iri(), "urn:page");
}

TEST_F(ServiceRepositoryTest, EachTextIsAVersionOnce) {
  StartServer();
  SetUpRobot();
  ASSERT_TRUE(Register(kTour).ok());
  ASSERT_TRUE(Register(kTour).ok());
  EXPECT_EQ(Versions("Tour").versions_size(), 1);
  std::string other = kTour;
  other.replace(other.find("1.0"), 3, "1.1");
  ASSERT_TRUE(Register(other).ok());
  const v1::ListVersionsReply versions = Versions("Tour");
  ASSERT_EQ(versions.versions_size(), 2);
  EXPECT_EQ(versions.versions(0).text(), kTour);
  EXPECT_EQ(versions.versions(1).version(), "1.1");
  EXPECT_FALSE(versions.versions(0).live());
  EXPECT_TRUE(versions.versions(1).live());
  EXPECT_GT(versions.versions(1).time_us(), 0);
  EXPECT_TRUE(
      Ask("<urn:docent:service-document:Tour> <https://w3id.org/docent#versionNumber> 2 ; "
          "<https://w3id.org/docent#defines> <urn:docent:service:present>"));
  StopServer();
  StartServer();
  EXPECT_EQ(Versions("Tour").SerializeAsString(), versions.SerializeAsString());
  EXPECT_EQ(Describe("present").registered_version(), 2u);
}

TEST_F(ServiceRepositoryTest, WhatIsUsedIsRemovedByForceOnly) {
  StartServer();
  SetUpRobot();
  ASSERT_TRUE(Register(kTour).ok());
  const grpc::Status deployed =
      Deploy("guide.cawl.xml", R"(<CAWL name="Guide"><flow name="g"><variable name="booth"/>
    <variable name="times"/><source name="a"/><node name="Show"><invoke operation="present"/></node><sink name="z"/>
    <link from="a" to="Show"/><link from="Show" to="z"/></flow></CAWL>)");
  ASSERT_TRUE(deployed.ok()) << deployed.error_message();
  const grpc::Status refused = Remove("Tour", false);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("is used by node Show of workflow Guide (present)"));
  EXPECT_EQ(Describe("present").document(), "Tour");
  EXPECT_THAT(Remove("Tuor", false).error_message(), HasSubstr("did you mean Tour?"));
  ASSERT_TRUE(Remove("Tour", true).ok());
  v1::ListServicesReply list;
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::List, v1::ListServicesRequest(), &list).ok());
  EXPECT_THAT(list.services(), IsEmpty());
  ASSERT_EQ(Versions("Tour").versions_size(), 1) << "its versions stay readable";
  EXPECT_FALSE(Versions("Tour").versions(0).live());
  StopServer();
  StartServer();
  EXPECT_FALSE(Versions("Tour").versions(0).live());
}

TEST_F(ServiceRepositoryTest, ADocumentIsGeneratedAndChecked) {
  StartServer();
  SetUpRobot();
  v1::GenerateRequest request;
  request.set_name("Made");
  for (const char* operation : {"show", "say"}) request.add_operations(operation);
  v1::GenerateReply reply;
  grpc::Status status = Call(services_, &v1::RobotServices::Stub::Generate, request, &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_THAT(reply.diagnostics(), IsEmpty()) << reply.DebugString();
  v1::RegisterRequest check;
  check.set_name("made.rsel.xml");
  check.set_rsel(reply.rsel());
  v1::RegisterReply checked;
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::Check, check, &checked).ok());
  EXPECT_THAT(checked.diagnostics(), IsEmpty());
  EXPECT_THAT(checked.processes(), ElementsAre("Made"));
  v1::ListServicesReply list;
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::List, v1::ListServicesRequest(), &list).ok());
  EXPECT_THAT(list.services(), IsEmpty()) << "nothing is registered";
  check.set_rsel(
      "<rsel name=\"x\"><process name=\"P\"><invoke operation=\"fly\"/><invoke operation=\"show\"><input "
      "part=\"booth\" value=\"7\"/></invoke></process></rsel>");
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::Check, check, &checked).ok());
  ASSERT_EQ(checked.diagnostics_size(), 2) << checked.DebugString();
  EXPECT_EQ(checked.diagnostics(0).message(), "no robot offers operation fly now");
  EXPECT_EQ(checked.diagnostics(1).rule(), "type-clash");
}

TEST_F(ServiceRepositoryTest, TemplatesAreImported) {
  StartServer();
  v1::ImportTemplatesRequest request;
  request.set_adapter("10.1.2.3:80");
  v1::ImportTemplatesReply reply;
  const auto import = [&] {
    return Call(services_, &v1::RobotServices::Stub::ImportTemplates, request, &reply);
  };
  EXPECT_EQ(import().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  request.set_wsdl(
      "<definitions xmlns=\"http://schemas.xmlsoap.org/wsdl/\"><portType name=\"P\"><operation "
      "name=\"o\"/></portType></definitions>");
  ASSERT_TRUE(import().ok());
  ASSERT_EQ(reply.templates_size(), 1);
  EXPECT_THAT(reply.templates(0).cawl(), HasSubstr("<invoke operation=\"o\"/>"));
  request.set_wsdl("<definitions");
  EXPECT_EQ(import().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  request.clear_from();
  EXPECT_EQ(import().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

}  // namespace
}  // namespace docent::server::test
