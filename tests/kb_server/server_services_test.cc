// Robot services and the fleet over gRPC with a real adapter.
#include <thread>

#include "absl/strings/str_replace.h"
#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(ServerWorkflowTest, ARobotServiceIsRegisteredDescribedAndInvoked) {
  StartServer();
  ScriptedAdapter adapter;
  MustTell(kStates);
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  v1::RegisterReply reply;
  grpc::Status status = Register(kServices, &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_THAT(reply.processes(), ElementsAre("greetTwice"));
  status = Register("<rsel name=\"x\"><process/></rsel>");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("services.xml:1:"));

  v1::ListServicesReply list;
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::List, v1::ListServicesRequest(), &list).ok());
  ASSERT_EQ(list.services_size(), 1);
  v1::DescribeServiceRequest describe;
  describe.set_name("greetTwice");
  v1::RobotService service;
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::Describe, describe, &service).ok());
  EXPECT_EQ(service.steps_size(), 2);
  EXPECT_THAT(service.robots(), ElementsAre("urn:w:R1"));
  describe.set_name("nothing");
  EXPECT_EQ(Call(services_, &v1::RobotServices::Stub::Describe, describe, &service).error_code(),
            grpc::StatusCode::NOT_FOUND);

  std::vector<v1::InvokeServiceReply> replies = Invoke("greetTwice", &status);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_FALSE(replies.empty());
  for (const auto& r : replies) EXPECT_EQ(r.final(), &r == &replies.back());
  EXPECT_EQ(replies.back().state(), "done");
  EXPECT_EQ(adapter.commands().size(), 2u);
  EXPECT_NE(adapter.commands()[0], adapter.commands()[1]);

  EXPECT_THAT(Invoke("nothing", &status), IsEmpty());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ServerWorkflowTest, AServiceWhoseRobotFailsSaysWhy) {
  StartServer();
  ScriptedAdapter adapter([](const v1::InvokeRequest&) {
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::FAILED);
    feedback.set_message("a wheel is stuck");
    return feedback;
  });
  MustTell(kStates);
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  ASSERT_TRUE(Register(kServices).ok());
  grpc::Status status;
  std::vector<v1::InvokeServiceReply> replies = Invoke("greetTwice", &status);
  ASSERT_TRUE(status.ok());
  ASSERT_FALSE(replies.empty());
  EXPECT_EQ(replies.back().state(), "failed");
  EXPECT_TRUE(replies.back().final());
  EXPECT_THAT(GetRun(replies.back().run()).reason(), HasSubstr("a wheel is stuck"));
}

TEST_F(ServerWorkflowTest, ARobotThatStopsRenewingItsLeaseIsOffline) {
  settings_.clock = &clock_;
  StartServer();
  MustTell(kStates);
  auto state = [this] {
    std::vector<v1::RobotStatus> robots = Robots();
    return robots.size() == 1 ? robots[0].state() : absl::StrCat(robots.size(), " robots");
  };
  ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  ASSERT_EQ(Robots().size(), 1u);
  EXPECT_EQ(Robots()[0].label(), "a robot");
  EXPECT_THAT(Robots()[0].operations(), ElementsAre("greet"));
  EXPECT_EQ(state(), "standby");
  uint64_t revision = Revision();
  clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs - 1));
  EXPECT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  EXPECT_TRUE(server_->Tend());
  EXPECT_EQ(Revision(), revision) << "a renewed lease is no news";

  clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs));
  EXPECT_TRUE(server_->Tend());
  ASSERT_TRUE(Query("ASK {}", revision + 1).status.ok());
  EXPECT_EQ(state(), "offline");
  EXPECT_TRUE(server_->Tend());
  ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  EXPECT_EQ(state(), "standby");
  EXPECT_EQ(Revision(), revision + 2);
}

TEST_F(ServerWorkflowTest, AJoinThatTheGraphRefusesIsRefusedAgain) {
  settings_.limits.term_bytes = 1000;
  StartServer();
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(Join("urn:w:R1", "127.0.0.1:1", "urn:" + std::string(1000, 'x')).error_code(),
              grpc::StatusCode::RESOURCE_EXHAUSTED);
  }
  EXPECT_EQ(Join("R1", "127.0.0.1:1").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Join("urn:w:R1", "").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(Robots(), IsEmpty());
  EXPECT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  EXPECT_EQ(Robots().size(), 1u);
}

TEST_F(ServerWorkflowTest, ATypeThatIsNoIriDoesNotKeepARobotAway) {
  StartServer();
  EXPECT_TRUE(Join("urn:w:R1", "127.0.0.1:1", "not an IRI").ok());
  EXPECT_EQ(Robots().size(), 1u);
}

TEST_F(ServerWorkflowTest, TheStatesOfARobotGoWithItsLease) {
  settings_.clock = &clock_;
  StartServer();
  MustTell(kStates);
  MustTell(
      "docent:x a docent:StateProperty . docent:y a docent:StateProperty . docent:localised a "
      "docent:StateProperty . "
      ":battery a docent:StateProperty .");
  ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  v1::AssertRequest states = Turtle(
      ":R1 docent:isAt :Hall ; docent:x 1.5 ; docent:y 2.0 ; docent:localised true ; :battery 80 ; "
      ":owner :Ann .");
  states.set_source("urn:w:R1");
  ASSERT_TRUE(Assert(states).ok());
  MustTell(":R1 docent:isAt :Hall .");  // somebody else says so, too
  EXPECT_EQ(Robots()[0].last_seen_us(), 0);
  clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs));
  const uint64_t revision = Revision();
  EXPECT_TRUE(server_->Tend());
  EXPECT_FALSE(Ask("GRAPH :R1 { :R1 <https://w3id.org/docent#isAt> ?region }", revision + 1));
  EXPECT_FALSE(Ask(":R1 <https://w3id.org/docent#localised> ?value"));
  EXPECT_FALSE(Ask(":R1 :battery ?value"));
  EXPECT_TRUE(Ask(":R1 <https://w3id.org/docent#isAt> :Hall")) << "of another source";
  EXPECT_TRUE(Ask(":R1 :owner :Ann")) << "no state";
  ASSERT_EQ(Robots().size(), 1u);
  EXPECT_EQ(Robots()[0].state(), "offline");
  EXPECT_TRUE(Robots()[0].has_pose());
  EXPECT_NEAR(static_cast<double>(Robots()[0].last_seen_us()),
              static_cast<double>(clock_.Now() - int64_t{FleetLeases::kLeaseMs} * 1000), 1000);

  v1::JoinRequest request;
  request.set_address("127.0.0.1:1");
  request.mutable_description()->set_robot("urn:w:R1");
  request.mutable_description()->set_incarnation("i1");
  v1::JoinReply reply;
  ASSERT_TRUE(Call(fleet_, &v1::Fleet::Stub::Join, request, &reply).ok());
  EXPECT_TRUE(reply.tell_states());
  EXPECT_EQ(Robots()[0].last_seen_us(), 0);
  ASSERT_TRUE(Call(fleet_, &v1::Fleet::Stub::Join, request, &reply).ok());
  EXPECT_FALSE(reply.tell_states());
}

TEST_F(ServerWorkflowTest, WhatNobodyOffersIsAWarningInServicesAndWorkflows) {
  StartServer();
  v1::RegisterReply registered;
  ASSERT_TRUE(Register(kServices, &registered).ok());
  ASSERT_EQ(registered.diagnostics_size(), 2);
  EXPECT_TRUE(registered.diagnostics(0).warning());
  EXPECT_EQ(registered.diagnostics(0).line(), 4u);
  EXPECT_EQ(registered.diagnostics(0).message(), "no robot offers operation greet now");
  v1::DeployReply deployed;
  const grpc::Status status = Deploy("called.xml", kCalled, &deployed);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(deployed.diagnostics_size(), 1);
  EXPECT_TRUE(deployed.diagnostics(0).warning());
  EXPECT_THAT(deployed.diagnostics(0).message(), HasSubstr("no robot offers operation greet now"));

  v1::StartReply start;
  ASSERT_TRUE(StartRun("Called", &start).ok());
  EXPECT_EQ(GetRun(start.run()).state(), "running");
  ScriptedAdapter adapter;
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  WaitForRun(start.run(), "done");
  ASSERT_TRUE(Register(kServices, &registered).ok());
  EXPECT_EQ(registered.diagnostics_size(), 0);
}

TEST_F(ServerWorkflowTest, AnOperationOfARobotIsSentWhatItsDescriptionNames) {
  StartServer();
  std::vector<std::string> sent;
  absl::Mutex mutex;
  ScriptedAdapter adapter([&](const v1::InvokeRequest& request) {
    absl::MutexLock lock(&mutex);
    for (const v1::NamedTerm& argument : request.arguments()) sent.push_back(argument.name());
    v1::Feedback done;
    done.set_state(v1::Feedback::SUCCEEDED);
    return done;
  });
  v1::JoinRequest join;
  join.set_address(adapter.address());
  join.mutable_description()->set_robot("urn:w:R1");
  join.mutable_description()->set_incarnation("i1");
  v1::OperationDescription* greet = join.mutable_description()->add_operations();
  greet->set_name("greet");
  greet->add_inputs("person");
  v1::JoinReply joined;
  ASSERT_TRUE(Call(fleet_, &v1::Fleet::Stub::Join, join, &joined).ok());
  ASSERT_TRUE(Deploy("called.xml", kCalled).ok());
  MustTell(":John docent:calls :R1 .");
  WaitForRun("Come-1", "done");
  EXPECT_THAT(sent, ElementsAre("person")) << "robot is a variable of the run, too";
  greet->set_inputs(0, "somebody");
  ASSERT_TRUE(Call(fleet_, &v1::Fleet::Stub::Join, join, &joined).ok());
  v1::DeployReply deployed;
  ASSERT_TRUE(Deploy("called.xml", kCalled, &deployed).ok());
  ASSERT_EQ(deployed.diagnostics_size(), 1);
  EXPECT_THAT(deployed.diagnostics(0).message(), HasSubstr("operation greet needs somebody"));
}

TEST_F(ServerWorkflowTest, ARobotThatJoinsWhileItIsGivenUpIsThereAgain) {
  settings_.clock = &clock_;
  StartServer();
  MustTell(kStates);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
    clock_.Advance(std::chrono::milliseconds(FleetLeases::kLeaseMs));
    EXPECT_TRUE(server_->Tend());  // Offline is on its way
    ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
    ASSERT_EQ(Robots().size(), 1u);
    EXPECT_EQ(Robots()[0].state(), "standby");
  }
}

TEST_F(ServerWorkflowTest, AJoinReplacesWhatTheOneBeforeSaid) {
  StartServer();
  ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:2").ok());
  EXPECT_THAT(Query("SELECT ?a { <urn:w:R1> <https://w3id.org/docent#adapterAddress> ?a }").rows,
              ElementsAre("\"127.0.0.1:2\""))
      << "also where no ontology says that there is one only";
}

v1::Feedback Failure(const std::string& why) {
  v1::Feedback feedback;
  feedback.set_state(v1::Feedback::FAILED);
  feedback.set_message(why);
  return feedback;
}

TEST_F(ServerWorkflowTest, ARepeatedInvokeIsAnsweredWithTheRecordedEnd) {
  StartServer();
  bool fails = false;
  ScriptedAdapter adapter([&fails](const v1::InvokeRequest&) {
    if (fails) return Failure("a wheel is stuck");
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::SUCCEEDED);
    return feedback;
  });
  MustTell(kStates);
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  ASSERT_TRUE(Register(kServices).ok());
  grpc::Status status;
  std::string run = Invoke("greetTwice", &status, "good").back().run();
  fails = true;
  EXPECT_EQ(Invoke("greetTwice", &status, "bad").back().state(), "failed");
  size_t commands = adapter.commands().size();

  for (bool restarted : {false, true}) {
    if (restarted) {
      StopServer();
      StartServer();
    }
    std::vector<v1::InvokeServiceReply> replies = Invoke("greetTwice", &status, "good");
    EXPECT_TRUE(status.ok()) << status.error_message();
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_TRUE(replies[0].final());
    EXPECT_EQ(replies[0].state(), "done");
    EXPECT_EQ(replies[0].run(), run);
    replies = Invoke("greetTwice", &status, "bad");
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].state(), "failed");
    EXPECT_THAT(replies[0].message(), HasSubstr("a wheel is stuck"));
  }
  EXPECT_EQ(adapter.commands().size(), commands) << "nothing is done twice";

  ASSERT_TRUE(Assert(Turtle(":a :b :c .", "told")).ok());
  EXPECT_THAT(Invoke("greetTwice", &status, "told"), IsEmpty());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::ALREADY_EXISTS);
}

// A start that is answered with another request's outcome would be lost.
TEST_F(ServerWorkflowTest, ARequestIdOfAnotherRequestIsRefused) {
  StartServer();
  const std::string cawl =
      "<CAWL name='NAME' version='1'><flow name='NAME'><source name='b'/><node name='N'/><sink name='e'/>"
      "<link from='b' to='N'/><link from='N' to='e'/></flow></CAWL>";
  for (const char* name : {"W", "V"})
    ASSERT_TRUE(Deploy(absl::StrCat(name, ".xml"), absl::StrReplaceAll(cawl, {{"NAME", name}})).ok());
  const auto update = [this](const std::string& text, const std::string& id) {
    v1::UpdateRequest request;
    request.set_update(text);
    request.set_request_id(id);
    v1::AssertReply reply;
    return Call(context_, &v1::Context::Stub::Update, request, &reply).error_code();
  };
  const std::string insert = "INSERT DATA { <urn:u> <urn:p> 1 }";
  v1::StartReply first, reply;
  ASSERT_TRUE(Assert(Turtle(":a :b :c .", "A")).ok());
  ASSERT_TRUE(StartRun("W", &first, "S").ok());
  ASSERT_EQ(update(insert, "U"), grpc::StatusCode::OK);
  grpc::Status invoked;
  for (const bool restarted : {false, true}) {
    if (restarted) {
      StopServer();
      StartServer();
    }
    const auto taken = grpc::StatusCode::ALREADY_EXISTS;
    for (const char* id : {"A", "U"}) EXPECT_EQ(StartRun("W", &reply, id).error_code(), taken) << id;
    EXPECT_EQ(StartRun("V", &reply, "S").error_code(), taken) << "another workflow";
    EXPECT_EQ(Assert(Turtle(":a :b :c .", "S")).error_code(), taken);
    EXPECT_EQ(Assert(Turtle(":a :b :d .", "A")).error_code(), taken) << "other facts";
    EXPECT_EQ(update(insert, "A"), taken);
    EXPECT_EQ(update("INSERT DATA { <urn:u> <urn:p> 2 }", "U"), taken);
    for (const char* id : {"A", "U", "S"}) {
      EXPECT_TRUE(Invoke("nothing", &invoked, id).empty());
      EXPECT_EQ(invoked.error_code(), taken) << id;
    }
    EXPECT_TRUE(Assert(Turtle(":a :b :c .", "A")).ok());
    EXPECT_EQ(update(insert, "U"), grpc::StatusCode::OK);
    ASSERT_TRUE(StartRun("W", &reply, "S").ok());
    EXPECT_EQ(reply.run(), first.run());
    EXPECT_EQ(reply.revision(), first.revision());
  }
}

TEST_F(ServerWorkflowTest, ALongRequestIdIsRefusedByEachCallThatTakesOne) {
  StartServer();
  const std::string id(257, 'x');
  v1::StartReply reply;
  grpc::Status status = StartRun("W", &reply, id);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("request_id_bytes is 256"));
  EXPECT_TRUE(Invoke("nothing", &status, id).empty());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerWorkflowTest, ARepeatedInvokeFollowsARunThatIsUnderWay) {
  StartServer();
  absl::Notification go;
  ScriptedAdapter adapter([&go](const v1::InvokeRequest&) {
    go.WaitForNotificationWithTimeout(absl::Seconds(20));
    v1::Feedback feedback;
    feedback.set_state(v1::Feedback::SUCCEEDED);
    return feedback;
  });
  MustTell(kStates);
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  ASSERT_TRUE(Register(kServices).ok());
  auto follow = [this] {
    grpc::Status status;
    std::vector<v1::InvokeServiceReply> replies = Invoke("greetTwice", &status, "one");
    EXPECT_TRUE(status.ok()) << status.error_message();
    ASSERT_FALSE(replies.empty());
    EXPECT_EQ(replies.back().state(), "done");
    EXPECT_TRUE(replies.back().final());
  };
  std::thread first(follow);
  adapter.WaitForCommands(1);
  std::thread second(follow);
  go.Notify();
  first.join();
  second.join();
  EXPECT_EQ(adapter.commands().size(), 2u);
}

TEST_F(ServerWorkflowTest, AClientThatDoesNotReadItsServicesEventsIsToldSoAndTheRunGoesOn) {
  settings_.limits.run_events_kept = 5;
  StartServer();
  ScriptedAdapter adapter;
  MustTell(kStates);
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  // the events of the commands are together larger than what gRPC takes for a client that does not read
  std::string invokes;
  for (int i = 0; i < 100; ++i) {
    absl::StrAppend(&invokes, "<invoke operation=\"greet\"><input part=\"text\" value=\"&quot;",
                    std::string(5000, 'x'), "&quot;\"/></invoke>");
  }
  ASSERT_TRUE(Register("<rsel name=\"Talks\" namespace=\"urn:w:\" version=\"1.0\"><process name=\"talk\">" +
                       invokes + "</process></rsel>")
                  .ok());
  v1::InvokeServiceRequest request;
  request.set_name("talk");
  grpc::ClientContext context;
  Limit(&context);
  grpc::ChannelArguments small_window;
  small_window.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  auto stub = v1::RobotServices::NewStub(
      grpc::CreateCustomChannel(server_->grpc_address(), grpc::InsecureChannelCredentials(), small_window));
  auto reader = stub->Invoke(&context, request);
  v1::InvokeServiceReply reply;
  ASSERT_TRUE(reader->Read(&reply));
  WaitForRun(reply.run(), "done");
  bool saw_final = false;
  while (reader->Read(&reply)) saw_final = saw_final || reply.final();
  grpc::Status status = reader->Finish();
  EXPECT_FALSE(saw_final);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("run_events_kept is 5"));
}

}  // namespace
}  // namespace docent::server::test
