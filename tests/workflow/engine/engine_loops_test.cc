// Loops that branch: what leads back, and what begins again.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"

namespace docent::engine {
namespace {

using ::testing::HasSubstr;

class EngineLoopsTest : public EngineTest {
 protected:
  static std::string Does(const std::string& name) {
    return Node(name, "", "<invoke operation=\"" + name + "\"/>");
  }
  static std::string While(const std::string& word) { return "ext:while=\"?x &lt;urn:" + word + "&gt; ?y\""; }
  void Hold(const std::string& word, bool holds) {
    if (holds) {
      conditions_.Set("urn:" + word, {{}});
    } else {
      conditions_.Set("urn:" + word, {});
    }
  }
  // The operations of the commands that were sent, with blanks between.
  std::string Sent() const {
    std::string sent;
    for (const RobotCommand& command : commands_) sent += (sent.empty() ? "" : " ") + command.operation;
    return sent;
  }
  // Ends the only command. What was sent then.
  std::string Next() {
    EXPECT_EQ(commands_.size(), 1u) << Sent();
    if (commands_.size() == 1) Turn({Done(commands_[0].id)});
    return Sent();
  }
};

TEST_F(EngineLoopsTest, AWayBackThatIsReachedByAChoiceDoesNotKeepItsRunFromBeginning) {
  Deploy(Flow(Does("Wait") + Does("Show") + Does("Over") + "<sink name=\"t\"/>" + Link("s", "Wait") +
              Link("Wait", "Show") + Link("Show", "Over", While("another")) + Link("Show", "t") +
              Link("Over", "Wait", While("more")) + Link("Over", "t")));
  Hold("another", true);
  Hold("more", true);
  Start();
  EXPECT_EQ(Sent(), "Wait");
  EXPECT_EQ(Next(), "Show");
  EXPECT_EQ(Next(), "Over");
  EXPECT_EQ(Next(), "Wait");
  EXPECT_EQ(Next(), "Show");
  Hold("more", false);
  EXPECT_EQ(Next(), "Over");
  EXPECT_EQ(Next(), "");
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineLoopsTest, AChoiceInALoopIsMadeAgainEachTime) {
  Deploy(Flow(Does("A") + Does("Left") + Does("Right") + Does("Join") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "Left", While("left")) + Link("A", "Right") + Link("Left", "Join") +
              Link("Right", "Join") + Link("Join", "A", While("more")) + Link("Join", "t")));
  Hold("more", true);
  Start();
  for (const bool left : {true, true, false, true}) {
    EXPECT_EQ(Sent(), "A");
    Hold("left", left);
    EXPECT_EQ(Next(), left ? "Left" : "Right") << "the branch of the time before is over";
    EXPECT_EQ(Next(), "Join");
    Next();
  }
  EXPECT_EQ(Sent(), "A");
  Hold("more", false);
  EXPECT_EQ(Next(), "Left");
  EXPECT_EQ(Next(), "Join");
  EXPECT_EQ(Next(), "");
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineLoopsTest, SeveralWaysBackByChoicesGoOnAtTheSameNode) {
  Deploy(Flow(Does("A") + Does("B") + Does("C") + Does("D") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "B", While("b")) + Link("A", "t") + Link("B", "C", While("c")) + Link("B", "D") +
              Link("C", "A", While("again")) + Link("C", "t") + Link("D", "A", While("again")) +
              Link("D", "t")));
  Hold("b", true);
  Hold("again", true);
  Start();
  for (const bool c : {false, true, true, false}) {
    EXPECT_EQ(Sent(), "A");
    Hold("c", c);
    EXPECT_EQ(Next(), "B");
    EXPECT_EQ(Next(), c ? "C" : "D");
    Next();
  }
  Hold("b", false);
  EXPECT_EQ(Next(), "");
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineLoopsTest, ABranchThatIsTakenTogetherWithTheWayBackGoesOnBesideTheLoop) {
  for (const bool first : {true, false}) {
    const std::string side = Link("B", "Side", While("alarm")), back = Link("B", "A", While("more"));
    Deploy(Flow(Does("A") + Does("B") + Does("Side") + "<sink name=\"t\"/>" + Link("s", "A") +
                Link("A", "B") + (first ? side + back : back + side) + Link("B", "t") + Link("Side", "t")));
    robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
    Hold("alarm", true);
    Hold("more", true);
    Start();
    EXPECT_EQ(Next(), "B");
    Next();
    ASSERT_EQ(commands_.size(), 2u) << Sent();
    const CommandId a = commands_[commands_[0].operation == "A" ? 0 : 1].id;
    const CommandId beside = commands_[commands_[0].operation == "A" ? 1 : 0].id;
    Turn({Done(beside)});
    Hold("alarm", false);
    Hold("more", false);
    Turn({Done(a)});
    EXPECT_EQ(Sent(), "B");
    EXPECT_EQ(Next(), "");
    EXPECT_EQ(engine_.live_runs(), 0u) << first;
  }
}

TEST_F(EngineLoopsTest, ALoopThatCanBeEnteredAtTwoNodesBeginsAtBoth) {
  Deploy(Flow(Does("A") + Does("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("s", "B") +
              Link("A", "B", While("ab")) + Link("A", "t") + Link("B", "A", While("ba")) + Link("B", "t")));
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  Start();
  ASSERT_EQ(Sent(), "A") << "B waits for what comes from A";
  EXPECT_EQ(Next(), "B");
  Hold("ba", true);
  EXPECT_EQ(Next(), "A");
  Hold("ba", false);
  EXPECT_EQ(Next(), "B");
  EXPECT_EQ(Next(), "");
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineLoopsTest, ALinkForFailuresAndInterruptsIsFollowedInBothCases) {
  const std::string flow =
      Flow("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"A\"/></node>" +
           Does("Sorry") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t") +
           Link("A", "Sorry", "ext:onFailure=\"true\" ext:onInterrupt=\"true\"") + Link("Sorry", "t"));
  for (const bool fails : {true, false}) {
    Deploy(flow);
    Hold("safe", true);
    Start();
    ASSERT_EQ(Sent(), "A");
    const CommandId command = commands_[0].id;
    if (fails) {
      Turn({Failed(command, "slipped")});
    } else {
      Hold("safe", false);
      Turn();
      Turn({{command, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
    }
    EXPECT_EQ(Sent(), "Sorry") << fails;
    Next();
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
  Deploy(flow);
  Hold("safe", true);
  Start();
  EXPECT_EQ(Next(), "") << "not where it succeeds";
  EXPECT_EQ(engine_.live_runs(), 0u);
}

TEST_F(EngineLoopsTest, ALoopThatWaitsForNothingFailsItsRunAndNothingElse) {
  Deploy(Flow(Node("A", "", "") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "A", "ext:while=\"?x &lt;urn:more&gt; ?y\"") + Link("A", "t")) +
         "<flow name=\"H\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  conditions_.Set("urn:more", {{{"x", Term::Iri("urn:x")}}});
  Turn({}, {{RunRequest::Kind::kStart, "W/F", {}}, {RunRequest::Kind::kStart, "W/H", {}}});
  EXPECT_EQ(commands_.size(), 1u);  // the other run goes on
  for (int turns = 0; engine_.AwaitsTick() && turns < 2000; ++turns) Turn();
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("node_iterations"));
  EXPECT_EQ(engine_.live_runs(), 1u);
}

TEST_F(EngineLoopsTest, ALoopGoesOnWhileItsConditionHolds) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "A", "ext:while=\"?x &lt;urn:more&gt; ?y\"") + Link("A", "t")));
  conditions_.Set("urn:more", {{{"x", Term::Iri("urn:x")}}});
  Start();
  CommandId first = commands_[0].id;
  Turn({Done(first)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-1/A/1/"));
  conditions_.Set("urn:more", {});
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineLoopsTest, WhatComesAfterALoopIsNotDeadWhileTheLoopGoesOn) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("B", "", "<invoke operation=\"b\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "A", "ext:while=\"?x &lt;urn:more&gt; ?y\"") +
              Link("A", "B") + Link("B", "t")));
  conditions_.Set("urn:more", {{{"x", Term::Iri("urn:x")}}});
  Start();
  Turn({Done(commands_[0].id)});
  EXPECT_FALSE(Says("F-1/B inactive>skipped"));
  conditions_.Set("urn:more", {});
  Turn({Done(commands_[0].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "b");
}

TEST_F(EngineLoopsTest, ALoopAroundALoopDoesNotGiveTheSameCommandIdTwice) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("B", "", "<invoke operation=\"b\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "B", "ext:while=\"?x &lt;urn:inner&gt; ?y\"") +
              Link("B", "A", "ext:while=\"?x &lt;urn:outer&gt; ?y\"") + Link("B", "t")));
  Start();
  std::set<std::string> ids;
  auto finish = [&] {
    ASSERT_EQ(commands_.size(), 1u);
    EXPECT_TRUE(ids.insert(commands_[0].id.value()).second) << commands_[0].id.value();
    Turn({Done(commands_[0].id)});
  };
  finish();  // A
  conditions_.Set("urn:inner", {{{"x", Term::Iri("urn:x")}}});
  finish();  // B, then B again
  conditions_.Set("urn:inner", {});
  conditions_.Set("urn:outer", {{{"x", Term::Iri("urn:x")}}});
  finish();  // B, then A again
  finish();  // A
  conditions_.Set("urn:outer", {});
  finish();  // B
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineLoopsTest, AJoinInALoopRemembersThatABranchOutsideIsDead) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("Repair", "", "<invoke operation=\"r\"/>") +
              Node("B", "", "<invoke operation=\"b\"/>") + Node("C", "", "<invoke operation=\"c\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "Repair", "ext:onFailure=\"true\"") +
              Link("Repair", "C") + Link("A", "B") + Link("B", "C") +
              Link("C", "B", "ext:while=\"?x &lt;urn:more&gt; ?y\"") + Link("C", "t")));
  conditions_.Set("urn:more", {{{"x", Term::Iri("urn:x")}}});
  Start();
  for (const char* operation : {"a", "b", "c", "b", "c"}) {
    ASSERT_EQ(commands_.size(), 1u);
    EXPECT_EQ(commands_[0].operation, operation);
    Turn({Done(commands_[0].id)});
  }
}

}  // namespace
}  // namespace docent::engine
