// Incidents: a node that failed waits for an operator. Further attempts with a delay, and on another robot.
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
using Kind = RunRequest::Kind;

class EngineIncidentsTest : public EngineTest {
 protected:
  using Outcome = CommandReport::Outcome;

  // A, whose attributes are given, then B; a failure of A leads to `handler`, if there is any.
  static std::string TwoNodes(const std::string& attributes, const std::string& of_flow = "",
                              bool handles = false) {
    std::string flow = Flow("<node name=\"A\" " + attributes + "><invoke operation=\"a\"/></node>" +
                            Node("B", "", "<invoke operation=\"b\"/>") +
                            (handles ? Node("H", "", "<invoke operation=\"h\"/>") : "") +
                            "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") + Link("B", "t") +
                            (handles ? Link("A", "H", "ext:onFailure=\"true\"") + Link("H", "t") : ""));
    return flow.replace(0, 5, "<flow " + of_flow);
  }
  absl::Status Settle(Kind kind, std::vector<std::pair<std::string, Term>> values = {},
                      const std::string& robot = "", const std::string& run = "F-1",
                      const std::string& node = "A") {
    RunRequest request;
    request.kind = kind;
    request.target = run;
    request.node = node;
    request.robot = robot;
    request.arguments = std::move(values);
    const absl::Status status = engine_.CheckRequest(request);
    if (status.ok()) Turn({}, {request});
    return status;
  }
  void Pass(int seconds) { now_us_ += seconds * int64_t{1000000}; }
  std::string Run(const std::string& predicate) const { return Fact("urn:docent:run:F-1", predicate); }
  std::string State(const std::string& node) const { return Fact("urn:docent:run:F-1/" + node, "nodeState"); }
  void FailFirst() {
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    Turn({Failed(commands_[0].id, "stuck")});
  }
};

TEST_F(EngineIncidentsTest, ANodeThatFailedWaitsForAnOperatorAndItsRobotIsFree) {
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  FailFirst();
  EXPECT_EQ(State("A"), "incident");
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "reason"), HasSubstr("stuck"));
  EXPECT_EQ(Run("runState"), "running");
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
  Start();
  EXPECT_EQ(commands_.size(), 1u) << "another run takes it";
}

TEST_F(EngineIncidentsTest, ARobotIsLetGoWhenItsCommandHasEnded) {
  Deploy(TwoNodes("ext:onFailure=\"incident\" ext:timeout=\"5s\""));
  Start();
  const CommandId first = commands_[0].id;
  Pass(5);
  Turn();
  EXPECT_EQ(State("A"), "incident");
  ASSERT_NE(engine_.HolderOf(RobotId("urn:r1")), nullptr);
  Turn({{first, Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineIncidentsTest, TheRobotOfANodeThatGoesOnIsKept) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  Deploy(Flow("<variable name=\"other\"/>" + Node("A", "", "<invoke operation=\"a\"/>") +
              "<node name=\"B\" ext:onFailure=\"incident\"><invoke operation=\"b\"><ext:input part=\"robot\" "
              "variable=\"other\"/></invoke></node>" +
              Node("C", "far", "<invoke operation=\"c\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("s", "B") + Link("A", "C") + Link("C", "t") + Link("B", "t")));
  Turn({}, {{Kind::kStart, "W/F", {{"other", Term::Iri("urn:r2")}}}});
  ASSERT_EQ(commands_.size(), 2u);
  const CommandId a = commands_[0].id, b = commands_[1].id;
  Turn({Done(a)});
  Turn({Failed(b, "stuck")});
  EXPECT_EQ(State("B"), "incident");
  EXPECT_EQ(State("C"), "waiting");
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r2")), nullptr);
  EXPECT_NE(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineIncidentsTest, ARetryBeginsTheNodeAgain) {
  Deploy(TwoNodes("ext:onFailure=\"incident\" ext:retry=\"1\""));
  Start();
  const CommandId first = commands_[0].id;
  Turn({Failed(first, "stuck")});
  const CommandId second = commands_[0].id;
  Turn({Failed(second, "stuck")});
  EXPECT_EQ(State("A"), "incident");
  ASSERT_TRUE(Settle(Kind::kRetryNode).ok());
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_NE(commands_[0].id, second);
  Turn({Failed(commands_[0].id, "stuck")});
  ASSERT_EQ(commands_.size(), 1u) << "its retries begin anew";
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(State("A"), "done");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "reason"), "");
}

TEST_F(EngineIncidentsTest, ARetryCanBeGivenARobot) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i2", false, false}};
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  FailFirst();
  ASSERT_TRUE(Settle(Kind::kRetryNode, {}, "urn:r2").ok());
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r2");
}

TEST_F(EngineIncidentsTest, ASkippedNodeCountsAsDoneWithItsValues) {
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  FailFirst();
  ASSERT_FALSE(Settle(Kind::kSkipNode, {{"nothing", Term::Integer(1)}}).ok());
  ASSERT_TRUE(Settle(Kind::kSkipNode).ok());
  EXPECT_EQ(State("A"), "done");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "b");
}

TEST_F(EngineIncidentsTest, WhatAnOperatorGaveAsReasonStandsInTheRun) {
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  FailFirst();
  RunRequest request{Kind::kSkipNode, "F-1", {}};
  request.node = "A";
  request.reason = "done by hand";
  ASSERT_TRUE(engine_.CheckRequest(request).ok());
  Turn({}, {request});
  EXPECT_EQ(State("A"), "done");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "reason"), "an operator skips it: done by hand");
}

// It was "another invocation of the node failed", where there is no other.
TEST_F(EngineIncidentsTest, AnInvocationEndsWithTheTimeOfItsNode) {
  Deploy(TwoNodes("ext:timeout=\"90s\""));
  Start();
  Pass(200);  // the server was down
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "reason"), "it was not done within 90 s: a on <urn:r1>: 1/1 a");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/0", "reason"), "it was not done within 90 s: a on <urn:r1>: 1/1 a");
}

TEST_F(EngineIncidentsTest, ASubflowThatIsTooLateIsNamed) {
  Deploy(Flow(Node("A", "", "<invoke subflow=\"G\" ext:timeout=\"2min\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  Start();
  Pass(120);
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:G-2", "reason"), "timed out: subflow G-2 was not done within 2 min");
  EXPECT_THAT(Run("reason"), HasSubstr("timed out: subflow G-2 was not done within 2 min"));
}

TEST_F(EngineIncidentsTest, ANodeThatIsLetFailFailsAsWithoutIncidents) {
  for (const bool handles : {false, true}) {
    Deploy(TwoNodes("ext:onFailure=\"incident\"", "", handles));
    Start();
    Turn({Failed(commands_[0].id, "stuck")});
    const std::string run = handles ? "F-2" : "F-1";
    ASSERT_TRUE(Settle(Kind::kFailNode, {}, "", run).ok());
    EXPECT_EQ(Fact("urn:docent:run:" + run, "runState"), handles ? "running" : "failed");
    EXPECT_EQ(commands_.size(), handles ? 1u : 0u);
  }
}

TEST_F(EngineIncidentsTest, AnIncidentIsSettledOnce) {
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  EXPECT_EQ(Settle(Kind::kRetryNode).code(), absl::StatusCode::kNotFound);
  FailFirst();
  EXPECT_EQ(Settle(Kind::kRetryNode, {}, "", "F-1", "Bb").code(), absl::StatusCode::kNotFound);
  ASSERT_TRUE(Settle(Kind::kSkipNode).ok());
  const absl::Status again = Settle(Kind::kSkipNode);
  EXPECT_EQ(again.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(again.message()), HasSubstr("it is done"));
  RunRequest skip;
  skip.kind = Kind::kFailNode;
  skip.target = "F-1";
  skip.node = "A";
  Turn({}, {skip});  // two in one turn
  EXPECT_EQ(State("A"), "done");
}

TEST_F(EngineIncidentsTest, AFlowSaysItForNodesThatHandleNoFailureThemselves) {
  Deploy(TwoNodes("", "ext:onFailure=\"incident\""));
  FailFirst();
  EXPECT_EQ(State("A"), "incident");
  Deploy(TwoNodes("", "ext:onFailure=\"incident\"", true));
  Start();
  Turn({Failed(commands_[0].id, "stuck")});
  EXPECT_EQ(Fact("urn:docent:run:F-2/H", "nodeState"), "running");
  Deploy(TwoNodes("ext:onFailure=\"fail\"", "ext:onFailure=\"incident\""));
  robots_.offers.push_back({RobotId("urn:r2"), "i2", false, false});
  Start();
  Turn({Failed(commands_[0].id, "stuck")});
  EXPECT_EQ(Fact("urn:docent:run:F-3", "runState"), "failed");
}

TEST_F(EngineIncidentsTest, AnIncidentOfASubflowIsSettledThere) {
  Deploy(Flow(Node("A", "", "<invoke subflow=\"G\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")) +
         "<flow name=\"G\"><source name=\"s\"/><node name=\"B\" ext:onFailure=\"incident\"><invoke "
         "operation=\"b\"/></node><sink name=\"t\"/>" +
         Link("s", "B") + Link("B", "t") + "</flow>");
  Start();
  Turn({Failed(commands_[0].id, "stuck")});
  EXPECT_EQ(Run("runState"), "running");
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
  ASSERT_TRUE(Settle(Kind::kSkipNode, {}, "", "G-2", "B").ok());
  EXPECT_EQ(Run("runState"), "done");
}

TEST_F(EngineIncidentsTest, AnIncidentIsSettledInAPauseAndGoesOnWithIt) {
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  FailFirst();
  Turn({}, {{Kind::kPause, "F-1", {}}});
  ASSERT_TRUE(Settle(Kind::kRetryNode).ok());
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(State("A"), "waiting");
  Turn({}, {{Kind::kResume, "F-1", {}}});
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineIncidentsTest, AnIncidentEndsWithItsRun) {
  Deploy(TwoNodes("ext:onFailure=\"incident\""));
  FailFirst();
  Turn({}, {{Kind::kCancel, "F-1", {}}});
  EXPECT_EQ(State("A"), "cancelled");
  EXPECT_EQ(Run("runState"), "cancelled");
}

TEST_F(EngineIncidentsTest, ARetryHasADelayThatGrows) {
  Deploy(
      Flow("<node name=\"A\"><invoke operation=\"a\" ext:retry=\"2\" ext:retry-delay=\"10s\" "
           "ext:retry-backoff=\"2\"/></node><sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  FailFirst();
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(engine_.NextDeadline(), now_us_ + 10'000'000);
  Pass(9);
  Turn();
  EXPECT_THAT(commands_, IsEmpty());
  Pass(1);
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  Turn({Failed(commands_[0].id, "stuck")});
  EXPECT_EQ(engine_.NextDeadline(), now_us_ + 20'000'000);
  Restart();
  EXPECT_EQ(engine_.NextDeadline(), now_us_ + 20'000'000);
  Pass(20);
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineIncidentsTest, TheDelayOfARetryStandsStillInAPause) {
  Deploy(
      Flow("<node name=\"A\" ext:retry=\"2\" ext:retry-delay=\"10s\"><invoke operation=\"a\"/></node>"
           "<sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  FailFirst();
  Pass(4);
  Turn({}, {{Kind::kPause, "F-1", {}}});
  Pass(100);
  Turn({}, {{Kind::kResume, "F-1", {}}});
  EXPECT_EQ(engine_.NextDeadline(), now_us_ + 6'000'000);
  Pass(6);
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineIncidentsTest, ARetryGoesToAnotherRobotWhileThereIsOne) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i2", false, false}};
  Deploy(
      Flow("<node name=\"A\"><invoke operation=\"a\" ext:retry=\"3\" ext:retry-other-robot=\"true\"/></node>"
           "<sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  FailFirst();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r2");
  Turn({Failed(commands_[0].id, "stuck")});
  ASSERT_EQ(commands_.size(), 1u) << "all have failed it: any may try again";
  EXPECT_EQ(commands_[0].robot.value(), "urn:r1");
}

}  // namespace
}  // namespace docent::engine
