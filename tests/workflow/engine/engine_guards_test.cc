// A guard is a guard: a command goes out only in a turn in which the condition of its node holds; ext:while-holds.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EngineGuardsTest : public EngineTest {
 protected:
  // A flow F with one node, and a flow H that keeps the robot.
  void DeployNode(const std::string& node, const std::string& more = "") {
    Deploy(Flow(node + more + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")) +
           "<flow name=\"H\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
           "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  }
  // The node opens when the bell rings and something is near.
  void DeployRungNode() {
    std::string near = Condition("near");
    near.replace(
        near.find("<condition>"), 11,
        "<condition expression=\"rang and near\"><case name=\"rang\"><event operation=\"bell\"/></case>");
    DeployNode("<node name=\"A\">" + near + "<invoke operation=\"a\"/></node>");
  }
  CommandId KeepRobot() {
    Turn({}, {{RunRequest::Kind::kStart, "W/H", {}}});
    return commands_[0].id;
  }
  static TermBinding Match(const std::string& s) { return {{"s", Term::Iri(s)}, {"o", Term::Iri("urn:o")}}; }
};

TEST_F(EngineGuardsTest, ACommandThatWaitedForARobotDoesNotGoOutIfItsConditionFellMeanwhile) {
  DeployNode(Node("A", "near", "<invoke operation=\"a\"/>"));
  const CommandId busy = KeepRobot();
  conditions_.Set("urn:near", {Match("urn:john")});
  Start();
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running");
  conditions_.Set("urn:near", {});
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "waiting");
  EXPECT_THAT(Fact("urn:docent:run:F-2/A", "waitsFor"), HasSubstr("urn:near"));
  Turn({Done(busy)});
  EXPECT_THAT(commands_, IsEmpty());
  conditions_.Set("urn:near", {Match("urn:john")});
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-2/A"));
}

TEST_F(EngineGuardsTest, ACommandThatWaitedCarriesARevisionAtWhichItsConditionHeld) {
  DeployNode(Node("A", "near", "<invoke operation=\"a\"/>"));
  const CommandId busy = KeepRobot();
  conditions_.Set("urn:near", {Match("urn:john")});
  Start();
  const uint64_t opened = revision_;
  Turn();
  Turn({Done(busy)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_GT(commands_[0].guard_revision.value(), opened) << "asked in the turn that sends it";
}

TEST_F(EngineGuardsTest, WhenTheMatchFellAndAnotherHoldsTheNodeOpensWithThat) {
  DeployNode(Node("A", "near", "<invoke operation=\"a\"/>"));
  const CommandId busy = KeepRobot();
  conditions_.Set("urn:near", {Match("urn:john"), Match("urn:mary")});
  Start();
  EXPECT_EQ(Fact("urn:docent:run:F-2/$s", "variableValue"), "urn:john");
  conditions_.Set("urn:near", {Match("urn:mary")});
  Turn({Done(busy)});
  EXPECT_EQ(commands_.size(), 1u);
  EXPECT_EQ(Fact("urn:docent:run:F-2/$s", "variableValue"), "urn:mary");
}

TEST_F(EngineGuardsTest, WhatAMatchGaveTheRunIsPutBackWhenTheNodeWaitsAgain) {
  DeployNode(Node("A", "near", "<invoke operation=\"a\"/>"));
  KeepRobot();
  conditions_.Set("urn:near", {Match("urn:john")});
  Start();
  conditions_.Set("urn:near", {});
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:F-2/$s", "variableValue"), "");
}

TEST_F(EngineGuardsTest, ARetryAsksTheConditionAgain) {
  const std::vector<std::string> nodes = {
      Node("A", "near", "<invoke operation=\"a\" ext:retry=\"1\"/>"),
      "<node name=\"A\" ext:retry=\"1\">" + Condition("near") + "<invoke operation=\"a\"/></node>"};
  for (const std::string& node : nodes) {
    DeployNode(node);
    conditions_.Set("urn:near", {Match("urn:john")});
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    const CommandId first = commands_[0].id;
    conditions_.Set("urn:near", {});
    Turn({Failed(first, "slipped")});
    EXPECT_THAT(commands_, IsEmpty());
    conditions_.Set("urn:near", {Match("urn:john")});
    Turn();
    ASSERT_EQ(commands_.size(), 1u);
    EXPECT_NE(commands_[0].id, first);
    Turn({Done(commands_[0].id)});
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(EngineGuardsTest, AnInvocationThatWaitsBesideOthersGoesOutWhenItsConditionHoldsAgain) {
  DeployNode(Node("A", "near", "<invoke operation=\"a\"/><invoke operation=\"c\"/>"));
  conditions_.Set("urn:near", {Match("urn:john")});
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  conditions_.Set("urn:near", {});
  Turn({Done(commands_[0].id)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "nodeState"), "running");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/1", "reason"), "condition near ceased to hold");
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "waitsFor"), HasSubstr("urn:near"));
  conditions_.Set("urn:near", {Match("urn:john")});
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "c");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "waitsFor"), "");
}

TEST_F(EngineGuardsTest, AnEventThatLeftDoesNotTakeBackWhatItOpened) {
  DeployRungNode();
  const CommandId busy = KeepRobot();
  TermBinding ring = Match("urn:john");
  conditions_.Set("urn:near", {Match("urn:john")});  // of the condition without the event
  conditions_.Set("bell", {});
  Start();
  ring["_event_1"] = Term::Iri("urn:e1");
  conditions_.Set("bell", {ring});
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running");
  conditions_.Set("bell", {});
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running");
  Turn({Done(busy)});
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineGuardsTest, WhatHeldBesideAnEventIsAskedForAgain) {
  DeployRungNode();
  const CommandId busy = KeepRobot();
  TermBinding ring = Match("urn:john");
  ring["_event_1"] = Term::Iri("urn:e1");
  conditions_.Set("urn:near", {Match("urn:john")});  // of the condition without the event
  conditions_.Set("bell", {});
  Start();
  conditions_.Set("bell", {ring});
  Turn();
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running");
  conditions_.Set("bell", {});
  conditions_.Set("urn:near", {});
  Turn({Done(busy)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "waiting");
}

TEST_F(EngineGuardsTest, WhatHasToHoldFallsAndTheNodeTakesItsInterruptLink) {
  Deploy(Flow("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"a\"/></node>" +
              Node("Stop", "", "<invoke operation=\"stop\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t") + Link("A", "Stop", "ext:onInterrupt=\"true\"") + Link("Stop", "t")));
  Start();
  EXPECT_THAT(commands_, IsEmpty()) << "it does not hold yet";
  EXPECT_THAT(Fact("urn:docent:run:F-1/A/0", "reason"), HasSubstr("has to hold"));
  conditions_.Set("urn:safe", {{}});
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  const CommandId first = commands_[0].id;
  conditions_.Set("urn:safe", {});
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first));
  EXPECT_THAT(commands_, IsEmpty()) << "the robot still brakes";
  Turn({{first, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_TRUE(Says("F-1/A running>cancelled"));
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "stop");
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineGuardsTest, WhatSucceedsAllTheSameIsDoneAndNotInterrupted) {
  for (const bool link : {false, true}) {
    conditions_.Set("urn:safe", {{}});
    Deploy(
        Flow("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"a\"/></node>" +
             Node("Stop", "", "<invoke operation=\"stop\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
             Link("A", "t") +
             Link("A", "Stop", link ? "ext:onInterrupt=\"true\"" : "ext:while=\"?r &lt;urn:never&gt; ?z\"") +
             Link("Stop", "t")));
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    const CommandId first = commands_[0].id;
    conditions_.Set("urn:safe", {});
    Turn();
    EXPECT_THAT(cancels_, ElementsAre(first));
    const std::string run = link ? "F-2" : "F-1";
    EXPECT_EQ(Fact("urn:docent:run:" + run + "/A", "nodeState"), "running") << "how it ends is not known";
    Turn({Done(first)});
    EXPECT_TRUE(Says(run + "/A running>done"));
    EXPECT_TRUE(Says(run + " running>done"));
    EXPECT_THAT(commands_, IsEmpty());
  }
}

TEST_F(EngineGuardsTest, OfAServiceThatIsInterruptedNoFurtherStepIsSent) {
  rsel::ParsedRsel parsed = rsel::ParseRsel(
      "<rsel name=\"S\"><process name=\"trip\"><invoke operation=\"go\"/><invoke "
      "operation=\"back\"/></process></rsel>",
      "s.xml");
  ASSERT_FALSE(HasErrors(engine_.PutServices(parsed.document)));
  conditions_.Set("urn:safe", {{}});
  DeployNode(
      "<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"trip\"/></node>");
  Start();
  const CommandId first = commands_[0].id;
  conditions_.Set("urn:safe", {});
  Turn();
  Turn({Done(first)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_TRUE(Says("F-1/A running>waiting"));
}

TEST_F(EngineGuardsTest, TheEndAtARobotThatIsOfflineIsNotWaitedFor) {
  for (const bool at_once : {true, false}) {
    robots_.offers[0].offline = false;
    conditions_.Set("urn:safe", {{}});
    DeployNode("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"a\"/></node>",
               Node("Stop", "", "") + Link("A", "Stop", "ext:onInterrupt=\"true\"") + Link("Stop", "t"));
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    const CommandId first = commands_[0].id;
    conditions_.Set("urn:safe", {});
    robots_.offers[0].offline = at_once;
    Turn();
    robots_.offers[0].offline = true;
    if (!at_once) Turn();
    EXPECT_TRUE(Says(at_once ? "F-1/Stop running>done" : "F-2/Stop running>done"));
    Turn({{first, CommandReport::Outcome::kUnknown, "", 0, "i2", {}}});
  }
}

TEST_F(EngineGuardsTest, ACommandWhoseEndIsNeverKnownDoesNotKeepAnInterruptForEver) {
  conditions_.Set("urn:safe", {{}});
  DeployNode("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"a\"/></node>",
             Node("Stop", "", "") + Link("A", "Stop", "ext:onInterrupt=\"true\"") + Link("Stop", "t"));
  Start();
  conditions_.Set("urn:safe", {});
  Turn();
  now_us_ += Limits{}.default_step_timeout_ms * int64_t{1000};
  Turn();
  EXPECT_TRUE(Says("F-1/A running>cancelled"));
  EXPECT_TRUE(Says("F-1/Stop running>done"));
}

TEST_F(EngineGuardsTest, WhatHasToHoldFallsAndTheNodeWaitsAgain) {
  DeployNode("<node name=\"A\" ext:while-holds=\"true\">" + Condition("near") +
             "<invoke operation=\"a\"/></node>");
  conditions_.Set("urn:near", {Match("urn:john"), Match("urn:mary")});
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  const CommandId first = commands_[0].id;
  conditions_.Set("urn:near", {Match("urn:mary")});  // still true, but not for John
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first));
  EXPECT_THAT(commands_, IsEmpty());
  Turn({{first, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_TRUE(Says("F-1/A running>waiting"));
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(Fact("urn:docent:run:F-1/$s", "variableValue"), "urn:mary");
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_EQ(conditions_.armed(), 0u);
}

// What has to hold counts from when the node begins something until it is done: also while nothing of it is under way.
class HoldBetweenAttemptsTest : public EngineGuardsTest {
 protected:
  // A node that has to be safe, with these attributes and invokes, and what is to come where it ceases to be.
  void DeploySafe(const std::string& attributes, const std::string& invokes) {
    Deploy(Flow("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\" " + attributes + ">" + invokes +
                "</node>" + Node("Stop", "", "") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t") +
                Link("A", "Stop", "ext:onInterrupt=\"true\"") + Link("Stop", "t")) +
           "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
           "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
    conditions_.Set("urn:safe", {{}});
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    first_ = commands_[0].id;
  }
  void Fall() {
    conditions_.Set("urn:safe", {});
    Turn();
  }
  bool IsInterrupted() const {
    return std::any_of(transitions_.begin(), transitions_.end(), [](const std::string& transition) {
      return transition.ends_with("/Stop running>done");
    });
  }
  CommandId first_;
};

TEST_F(HoldBetweenAttemptsTest, ItFallsDuringTheDelayBeforeTheNextAttempt) {
  const std::string invoke = "<invoke operation=\"a\"/>";
  const std::string delay = " ext:retry=\"2\" ext:retry-delay=\"3s\"";
  const std::vector<std::pair<std::string, std::string>> nodes = {
      {"", "<invoke operation=\"a\"" + delay + "/>"},
      {delay, invoke},
      {"", "<invoke subflow=\"G\"" + delay + "/>"}};
  for (const auto& [attributes, invokes] : nodes) {
    SCOPED_TRACE(attributes + invokes);
    DeploySafe(attributes, invokes);
    Turn({Failed(first_, "slipped")});
    EXPECT_THAT(commands_, IsEmpty());
    Fall();
    EXPECT_TRUE(IsInterrupted());
    EXPECT_EQ(engine_.live_runs(), 0u) << "and its robot is free";
  }
}

TEST_F(HoldBetweenAttemptsTest, ItFallsInTheTurnInWhichTheAttemptFails) {
  DeploySafe("", "<invoke operation=\"a\" ext:retry=\"1\"/>");
  conditions_.Set("urn:safe", {});
  Turn({Failed(first_, "slipped")});
  EXPECT_TRUE(IsInterrupted());
}

TEST_F(HoldBetweenAttemptsTest, ItFallsWhileAFurtherAttemptWaitsForARobot) {
  DeploySafe("", "<invoke operation=\"a\" ext:retry=\"1\"/>");
  robots_.offers[0].out_of_service = "is charging";
  Turn({Failed(first_, "slipped")});
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/0", "invocationState"), "pending");
  Fall();
  EXPECT_TRUE(IsInterrupted());
}

TEST_F(HoldBetweenAttemptsTest, ItFallsAndTheConditionOfTheNodeItselfIsMeant) {
  Deploy(Flow("<node name=\"A\" ext:while-holds=\"true\">" + Condition("near") +
              "<invoke operation=\"a\" ext:retry=\"1\" ext:retry-delay=\"3s\"/></node>" +
              Node("Stop", "", "") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t") +
              Link("A", "Stop", "ext:onInterrupt=\"true\"") + Link("Stop", "t")));
  conditions_.Set("urn:near", {Match("urn:john")});
  Start();
  Turn({Failed(commands_.at(0).id, "slipped")});
  conditions_.Set("urn:near", {});
  Turn();
  EXPECT_TRUE(IsInterrupted());
}

TEST_F(HoldBetweenAttemptsTest, ItFallsWhileTheEndOfTheAttemptBeforeIsAwaitedWhichIsAwaitedThenToo) {
  DeploySafe("ext:timeout=\"2s\" ext:retry=\"1\"", "<invoke operation=\"a\"/>");
  now_us_ += 2'000'000;
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first_));
  Fall();
  EXPECT_FALSE(IsInterrupted()) << "the robot still brakes";
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "reason"), HasSubstr("interrupted"));
  Turn({{first_, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_TRUE(IsInterrupted());
  EXPECT_THAT(commands_, IsEmpty());
}

TEST_F(HoldBetweenAttemptsTest, TheEndOfTheAttemptBeforeIsNotAwaitedForEver) {
  for (const bool offline : {false, true}) {
    robots_.offers[0].offline = false;
    DeploySafe("ext:timeout=\"2s\" ext:retry=\"1\"", "<invoke operation=\"a\"/>");
    now_us_ += 2'000'000;
    Turn();
    Fall();
    EXPECT_FALSE(IsInterrupted());
    if (offline)
      robots_.offers[0].offline = true;
    else
      now_us_ += Limits{}.default_step_timeout_ms * int64_t{1000};
    Turn();
    EXPECT_TRUE(IsInterrupted());
    Turn({{first_, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  }
}

TEST_F(HoldBetweenAttemptsTest, WithoutALinkItBeginsFromItsStartWithAllItsAttempts) {
  for (const bool of_node : {true, false}) {
    const std::string retry = "ext:retry=\"1\" ext:retry-delay=\"3s\"";
    DeployNode("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\" " + (of_node ? retry : "") +
               "><invoke operation=\"a\" " + (of_node ? "" : retry) + "/></node>");
    conditions_.Set("urn:safe", {{}});
    Start();
    Turn({Failed(commands_.at(0).id, "slipped")});
    conditions_.Set("urn:safe", {});
    Turn();
    EXPECT_TRUE(Says(of_node ? "F-1/A running>waiting" : "F-2/A running>waiting"));
    conditions_.Set("urn:safe", {{}});
    Turn();
    ASSERT_EQ(commands_.size(), 1u) << "at once: it is no further attempt";
    Turn({Failed(commands_[0].id, "slipped")});
    EXPECT_EQ(engine_.live_runs(), 1u);
    now_us_ += 3'000'000;
    Turn();
    ASSERT_EQ(commands_.size(), 1u);
    Turn({Done(commands_[0].id)});
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(HoldBetweenAttemptsTest, BeforeANodeHasBegunAnythingItWaits) {
  DeploySafe("", "<invoke operation=\"a\"/>");
  Start();
  conditions_.Set("urn:safe", {});
  Turn({Done(first_)});
  EXPECT_FALSE(IsInterrupted());
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "nodeState"), "running");
  EXPECT_THAT(Fact("urn:docent:run:F-2/A/0", "reason"), HasSubstr("has to hold"));
  EXPECT_THAT(Fact("urn:docent:run:F-2/A", "waitsFor"), HasSubstr("urn:safe"));
  conditions_.Set("urn:safe", {{}});
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
  EXPECT_EQ(Fact("urn:docent:run:F-2/A", "waitsFor"), "");
}

TEST_F(EngineGuardsTest, WhatHasToHoldEndsASubflow) {
  Deploy(Flow("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke subflow=\"G\"/></node>"
              "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  conditions_.Set("urn:safe", {{}});
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  const CommandId first = commands_[0].id;
  conditions_.Set("urn:safe", {});
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first));
  EXPECT_TRUE(Says("G-2 running>cancelled"));
  EXPECT_TRUE(Says("F-1/A running>waiting"));
  conditions_.Set("urn:safe", {{}});
  Turn();
  EXPECT_THAT(commands_, IsEmpty());
  Turn({{first, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_EQ(commands_.size(), 1u);
}

}  // namespace
}  // namespace docent::engine
