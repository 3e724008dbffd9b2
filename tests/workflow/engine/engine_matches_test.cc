// The matches that open a node, and the robots that they name: ext:forEach over robots, and values that are done.
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Kind = RunRequest::Kind;

class EngineMatchesTest : public EngineTest {
 protected:
  EngineMatchesTest() {
    robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i2", false, false}};
    conditions_.Set("urn:all", {Named("robot", "urn:r1"), Named("robot", "urn:r2")});
    conditions_.Set("urn:rooms", {Named("room", "urn:a"), Named("room", "urn:b"), Named("room", "urn:c")});
  }
  static TermBinding Named(const std::string& name, const std::string& value) {
    return {{name, Term::Iri(value)}, {"o", Term::Iri("urn:o")}};
  }
  static std::string All(const std::string& name, const std::string& word, const std::string& attributes) {
    return "<node name=\"A\" ext:forEach=\"?" + name + "\" " + attributes +
           "><condition><context name=\"c\"><rule><constraint><subject>?" + name +
           "</subject><verb>&lt;urn:" + word +
           "&gt;</verb><object>?o</object></constraint></rule></context></condition><invoke "
           "operation=\"go\"/></node>"
           "<sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t");
  }
  // Flow F, of which the node A is for each robot, and Low, which drives twice with r1.
  void DeployFlows(const std::string& of_flow = "", const std::string& of_node = "") {
    Deploy("<flow name=\"F\" " + of_flow + "><source name=\"s\"/>" + All("robot", "all", of_node) +
           "</flow><flow name=\"Low\"><variable name=\"robot\"/><source name=\"s\"/>" +
           Node("A", "", "<invoke operation=\"go\"/>") + Node("B", "", "<invoke operation=\"go\"/>") +
           "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") + Link("B", "t") + "</flow>");
  }
  CommandId Busy() {
    Turn({}, {{Kind::kStart, "W/Low", {{"robot", Term::Iri("urn:r1")}}}});
    return commands_.at(0).id;
  }
  std::vector<std::string> Sent() const {
    std::vector<std::string> sent;
    for (const RobotCommand& command : commands_) {
      const std::string& id = command.id.value();
      sent.push_back(id.substr(0, id.find('/')) + " " + command.robot.value());
    }
    return sent;
  }
  absl::Status Settle(Kind kind, const std::string& robot = "") {
    RunRequest request;
    request.kind = kind;
    request.target = "F-1";
    request.node = "A";
    request.robot = robot;
    const absl::Status status = engine_.CheckRequest(request, &robots_);
    if (status.ok()) Turn({}, {request});
    return status;
  }
  std::string State() const { return Fact("urn:docent:run:F-1/A", "nodeState"); }
  using Strings = std::vector<std::string>;
};

TEST_F(EngineMatchesTest, ForEachRobotWaitsForThoseThatServeOthers) {
  DeployFlows();
  const CommandId a = Busy();
  Start();
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r2"));
  const CommandId r2 = commands_[0].id;
  EXPECT_THAT(Fact("urn:docent:run:F-2/A/0", "invocationState"), "pending");
  Turn({Done(r2)});
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running") << "r1 is not left out";
  Turn({Done(a)});
  Turn({Done(commands_.at(0).id)});
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r1"));
  Turn({Done(commands_.at(0).id)});
  EXPECT_TRUE(Says("F-2 running>done"));
}

TEST_F(EngineMatchesTest, ForEachRobotOpensThoughAllServeOthers) {
  DeployFlows();
  conditions_.Set("urn:all", {Named("robot", "urn:r1")});
  Busy();
  Start();
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running");
}

TEST_F(EngineMatchesTest, ForEachRobotPreemptsThoseThatServeLessUrgentRuns) {
  DeployFlows("ext:priority=\"100\" ext:preempt=\"true\"");
  const CommandId a = Busy();
  Start();
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r2"));
  Turn({Done(a)});
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r1")) << "at the step border, before the next node of Low";
}

TEST_F(EngineMatchesTest, ForEachRobotOneAfterTheOtherWaitsForItsTurn) {
  DeployFlows("", "ext:sequential=\"true\"");
  const CommandId a = Busy();
  Start();
  EXPECT_THAT(Sent(), IsEmpty()) << "the first is that of r1";
  Turn({Done(a)});
  Turn({Done(commands_.at(0).id)});
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r1"));
  Turn({Done(commands_.at(0).id)});
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r2"));
}

TEST_F(EngineMatchesTest, ForEachRobotWaitsForOneThatIsOfflineOrCharging) {
  DeployFlows();
  for (const bool offline : {true, false}) {
    robots_.offers[0].offline = offline;
    robots_.offers[0].out_of_service = offline ? "" : "is charging";
    Start();
    const std::string run = offline ? "F-1" : "F-2";
    EXPECT_THAT(Sent(), ElementsAre(run + " urn:r2"));
    EXPECT_THAT(Fact("urn:docent:run:" + run + "/A/0", "reason"), HasSubstr("urn:r1"));
    const CommandId r2 = commands_[0].id;
    robots_.offers[0].offline = false;
    robots_.offers[0].out_of_service.clear();
    Turn({Done(r2)});
    EXPECT_THAT(Sent(), ElementsAre(run + " urn:r1"));
    Turn({Done(commands_.at(0).id)});
    EXPECT_TRUE(Says(run + " running>done"));
  }
}

TEST_F(EngineMatchesTest, AnotherValueWhoseRobotServesOthersIsNotLeftOutEither) {
  std::string node = All("room", "pairs", "");
  Deploy(Flow(node) + "<flow name=\"Low\"><variable name=\"robot\"/><source name=\"s\"/>" +
         Node("A", "", "<invoke operation=\"go\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
         Link("A", "t") + "</flow>");
  TermBinding a = Named("room", "urn:a"), b = Named("room", "urn:b");
  a["robot"] = Term::Iri("urn:r1");
  b["robot"] = Term::Iri("urn:r2");
  conditions_.Set("urn:pairs", {a, b});
  const CommandId busy = Busy();
  Start();
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r2"));
  Turn({Done(busy)});
  EXPECT_THAT(Sent(), ElementsAre("F-2 urn:r1"));
}

TEST_F(EngineMatchesTest, ValuesThatAnyRobotMayServeAreSpreadOverThem) {
  Deploy(Flow(All("room", "pairs", "")));
  std::vector<TermBinding> pairs;
  for (const char* room : {"urn:a", "urn:b"}) {
    for (const char* robot : {"urn:r1", "urn:r2"}) {
      pairs.push_back(Named("room", room));
      pairs.back()["robot"] = Term::Iri(robot);
    }
  }
  conditions_.Set("urn:pairs", pairs);
  Start();
  EXPECT_THAT(Sent(), UnorderedElementsAre("F-1 urn:r1", "F-1 urn:r2"));
}

TEST_F(EngineMatchesTest, ARetryRepeatsOnlyTheValuesThatAreNotDone) {
  robots_.offers.resize(1);
  Deploy(Flow(All("room", "rooms", "ext:sequential=\"true\" ext:onFailure=\"incident\"")));
  Start();
  Turn({Done(commands_.at(0).id)});
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/1/$room", "variableValue"), "urn:b");
  Turn({Failed(commands_.at(0).id, "stuck")});
  EXPECT_EQ(State(), "incident");
  conditions_.Set("urn:rooms", {Named("room", "urn:b"), Named("room", "urn:c")});  // a needs nothing any more
  ASSERT_TRUE(Settle(Kind::kRetryNode).ok());
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/0", "invocationState"), "done");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/0/$room", "variableValue"), "urn:a");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/1/$room", "variableValue"), "urn:b");
  Turn({Done(commands_.at(0).id)});
  Turn({Done(commands_.at(0).id)});
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineMatchesTest, AFurtherAttemptRepeatsOnlyTheValuesThatAreNotDone) {
  robots_.offers.resize(1);
  Deploy(Flow(All("room", "rooms", "ext:sequential=\"true\" ext:retry=\"1\"")));
  Start();
  Turn({Done(commands_.at(0).id)});
  Turn({Failed(commands_.at(0).id, "stuck")});
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(commands_.size(), 1u) << i;
    Turn({Done(commands_[0].id)});
  }
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineMatchesTest, ARetryWithARobotThatDoesNotOfferItIsRefused) {
  Deploy(
      Flow("<node name=\"A\" ext:onFailure=\"incident\"><invoke operation=\"go\"/></node><sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  Start();
  Turn({Failed(commands_.at(0).id, "stuck")});
  EXPECT_THAT(std::string(Settle(Kind::kRetryNode, "urn:r9").message()),
              HasSubstr("<urn:r9> does not offer go"));
  EXPECT_EQ(State(), "incident");
}

TEST_F(EngineMatchesTest, ARetryThatWaitsForItsRobotCanBeTakenBack) {
  for (const Kind kind : {Kind::kRetryNode, Kind::kSkipNode, Kind::kFailNode}) {
    robots_.offers[1].offline = false;
    Deploy(Flow(
        "<node name=\"A\" ext:onFailure=\"incident\"><invoke operation=\"go\"/></node><sink name=\"t\"/>" +
        Link("s", "A") + Link("A", "t")));
    Start();
    Turn({Failed(commands_.at(0).id, "stuck")});
    robots_.offers[1].offline = true;
    RunRequest request;
    request.kind = Kind::kRetryNode;
    request.target = "F-" + std::to_string(kind == Kind::kRetryNode ? 1 : kind == Kind::kSkipNode ? 2 : 3);
    request.node = "A";
    request.robot = "urn:r2";
    ASSERT_TRUE(engine_.CheckRequest(request, &robots_).ok());
    Turn({}, {request});
    EXPECT_THAT(commands_, IsEmpty());
    request.kind = kind;
    request.robot.clear();
    ASSERT_TRUE(engine_.CheckRequest(request, &robots_).ok()) << engine_.CheckRequest(request, &robots_);
    Turn({}, {request});
    if (kind == Kind::kRetryNode) {
      ASSERT_EQ(commands_.size(), 1u);
      EXPECT_EQ(engine_.CheckRequest(request, &robots_).ok(), false) << "it has begun";
      Turn({Done(commands_[0].id)});
    }
    const std::string ended = kind == Kind::kFailNode ? "failed" : "done";
    EXPECT_TRUE(Says(request.target + " running>" + ended));
    robots_.offers[1].offline = false;
    Turn();
    EXPECT_THAT(commands_, IsEmpty()) << "nothing of it waits any more";
  }
}

}  // namespace
}  // namespace docent::engine
