// Compensation: what done nodes did is undone, the last first, when a run is cancelled so, and when it fails.
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
using ::testing::Not;
using Kind = RunRequest::Kind;

class EngineCompensationTest : public EngineTest {
 protected:
  using Outcome = CommandReport::Outcome;

  static std::string Undoable(const std::string& name) {
    return "<node name=\"" + name + "\" ext:compensate=\"undo" + name + "\"><invoke operation=\"do" + name +
           "\"/></node>";
  }
  static std::string ThreeNodes() {
    return Flow("<variable name=\"what\"/>" + Undoable("A") + Undoable("B") +
                Node("C", "", "<invoke operation=\"doC\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
                Link("A", "B") + Link("B", "C") + Link("C", "t"));
  }
  void Cancel(bool compensates, const std::string& run = "F-1") {
    RunRequest request;
    request.kind = Kind::kCancel;
    request.target = run;
    request.reason = "fire";
    request.compensates = compensates;
    Turn({}, {request});
  }
  // Starts the run and lets its first commands succeed; the next is under way.
  CommandId RunAfter(int done) {
    Start();
    for (int i = 0; i < done; ++i) Turn({Done(commands_[0].id)});
    return commands_[0].id;
  }
  // The turn sent one command, which succeeds.
  void Does(const std::string& operation) {
    ASSERT_THAT(Operations(), ElementsAre(operation));
    Turn({Done(commands_[0].id)});
  }
  std::vector<std::string> Operations() const {
    std::vector<std::string> operations;
    for (const RobotCommand& command : commands_) operations.push_back(command.operation);
    return operations;
  }
  static CommandReport Report(const CommandId& id, Outcome outcome) { return {id, outcome, "", 0, "i1", {}}; }
  std::string Run(const std::string& predicate) const { return Fact("urn:docent:run:F-1", predicate); }
};

TEST_F(EngineCompensationTest, ACancelledRunUndoesWhatItDidTheLastFirst) {
  Deploy(ThreeNodes());
  const CommandId third = RunAfter(2);
  Cancel(true);
  EXPECT_THAT(cancels_, ElementsAre(third));
  EXPECT_THAT(commands_, IsEmpty()) << "the robot still does C";
  EXPECT_EQ(Run("runState"), "running");
  EXPECT_THAT(Run("reason"), HasSubstr("is being undone"));
  Turn({Report(third, Outcome::kCancelled)});
  EXPECT_THAT(Operations(), ElementsAre("undoB"));
  EXPECT_EQ(commands_[0].robot.value(), "urn:r1");
  Turn({Done(commands_[0].id)});
  EXPECT_THAT(Operations(), ElementsAre("undoA"));
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; what it did was undone");
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineCompensationTest, ACancelWithoutItUndoesNothing) {
  Deploy(ThreeNodes());
  const CommandId third = RunAfter(2);
  Cancel(false);
  Turn({Report(third, Outcome::kCancelled)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(Run("runState"), "cancelled");
}

TEST_F(EngineCompensationTest, AStepThatCannotBeUndoneIsToldAndTheOthersGoOn) {
  Deploy(ThreeNodes());
  const CommandId third = RunAfter(2);
  Cancel(true);
  Turn({Report(third, Outcome::kCancelled)});
  Turn({Failed(commands_[0].id, "the door is shut")});
  EXPECT_THAT(Operations(), ElementsAre("undoA"));
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_THAT(Run("reason"), HasSubstr("not undone: B (undoB)"));
  EXPECT_THAT(Run("reason"), HasSubstr("the door is shut"));
  EXPECT_THAT(Run("reason"), Not(HasSubstr("undoA")));
}

TEST_F(EngineCompensationTest, ARunThatFailsUndoesWhatItDidAndEndsAsFailed) {
  Deploy(ThreeNodes());
  const CommandId third = RunAfter(2);
  Turn({Failed(third, "stuck")});
  EXPECT_THAT(Operations(), ElementsAre("undoB"));
  Turn({Done(commands_[0].id)});
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Run("runState"), "failed");
  EXPECT_THAT(Run("reason"), HasSubstr("stuck"));
  EXPECT_THAT(Run("reason"), HasSubstr("what it did was undone"));
}

TEST_F(EngineCompensationTest, EveryOtherNodeIsCancelledBeforeItUndoes) {
  Deploy(Flow(Node("First", "x", "<invoke operation=\"doF\"/>") + Undoable("A") +
              Node("C", "", "<invoke operation=\"doC\"/>") +
              Node("Last", "x", "<invoke operation=\"doL\"/>") + "<sink name=\"t\"/>" + Link("s", "First") +
              Link("s", "A") + Link("s", "Last") + Link("A", "C") + Link("First", "t") + Link("Last", "t") +
              Link("C", "t")));
  const CommandId second = RunAfter(1);
  Turn({Failed(second, "stuck")});
  EXPECT_THAT(Operations(), ElementsAre("undoA"));
  EXPECT_THAT(transitions_, ::testing::Contains("F-1/First waiting>cancelled"));
  EXPECT_THAT(transitions_, ::testing::Contains("F-1/Last waiting>cancelled"));
}

TEST_F(EngineCompensationTest, OfAnInterruptedNodeWhatWasDoneForSomeValuesIsUndone) {
  conditions_.Set("urn:safe", {{}});
  conditions_.Set("urn:near", {{{"s", Term::Iri("urn:john")}, {"o", Term::Iri("urn:x")}},
                               {{"s", Term::Iri("urn:mary")}, {"o", Term::Iri("urn:x")}}});
  Deploy(
      Flow("<node name=\"A\" ext:forEach=\"?s\" ext:compensate=\"undoA\" "
           "ext:while-holds=\"?r &lt;urn:safe&gt; ?z\">" +
           Condition("near") + "<invoke operation=\"doA\"/></node>" +
           Node("Stop", "", "<invoke operation=\"stop\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
           Link("A", "t") + Link("A", "Stop", "ext:onInterrupt=\"true\"") + Link("Stop", "t")));
  const CommandId second = RunAfter(1);
  conditions_.Set("urn:safe", {});
  Turn();
  Turn({Report(second, Outcome::kCancelled)});
  ASSERT_THAT(Operations(), ElementsAre("stop"));
  Turn({Failed(commands_[0].id, "stuck")});
  Does("undoA");
  EXPECT_EQ(Run("runState"), "failed");
  EXPECT_THAT(Run("reason"), HasSubstr("what it did was undone"));
}

TEST_F(EngineCompensationTest, ASecondCancelEndsTheUndoingAndSaysWhatIsLeft) {
  Deploy(ThreeNodes());
  const CommandId third = RunAfter(2);
  Cancel(true);
  Cancel(true);  // it is at it
  EXPECT_EQ(Run("runState"), "running");
  Turn({Report(third, Outcome::kCancelled)});
  const CommandId undo = commands_[0].id;
  Cancel(false);
  EXPECT_THAT(cancels_, ElementsAre(undo));
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_THAT(Run("reason"),
              HasSubstr("not undone: B (undoB): it was cancelled; A (undoA): it was not tried"));
  Turn({Report(undo, Outcome::kCancelled)});
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineCompensationTest, APausedRunThatIsCancelledSoUndoesWhatItDid) {
  Deploy(ThreeNodes());
  const CommandId second = RunAfter(1);
  Turn({}, {{Kind::kPause, "F-1", {}}});
  Turn({Done(second)});
  Cancel(true);
  ASSERT_THAT(Operations(), ElementsAre("undoB"));
  const CommandId undo = commands_[0].id;
  Turn({}, {{Kind::kPause, "F-1", {}}});
  Turn({Done(undo)});
  EXPECT_THAT(commands_, IsEmpty());
  Turn({}, {{Kind::kResume, "F-1", {}}});
  EXPECT_THAT(Operations(), ElementsAre("undoA"));
}

TEST_F(EngineCompensationTest, UndoingGoesOnAfterARestart) {
  Deploy(ThreeNodes());
  const CommandId third = RunAfter(2);
  Cancel(true);
  Restart();
  Turn({Report(third, Outcome::kCancelled)});
  EXPECT_THAT(Operations(), ElementsAre("undoB"));
}

TEST_F(EngineCompensationTest, WhatASubflowDidIsUndoneWithItsParent) {
  Deploy(Flow(Undoable("A") + Node("S", "", "<invoke subflow=\"G\"/>") + Undoable("Z") +
              Node("L", "", "<invoke operation=\"doL\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "S") + Link("S", "Z") + Link("Z", "L") + Link("L", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "B") +
         Link("B", "t") + "</flow>");
  const CommandId last = RunAfter(3);
  Cancel(true);
  Turn({Report(last, Outcome::kCancelled)});
  std::vector<std::string> undone;
  while (!commands_.empty() && undone.size() < 5) {
    undone.push_back(commands_[0].operation);
    Turn({Done(commands_[0].id)});
  }
  EXPECT_THAT(undone, ElementsAre("undoZ", "undoB", "undoA"));
}

TEST_F(EngineCompensationTest, WhatALiveSubflowDidIsUndoneToo) {
  Deploy(Flow(Undoable("A") + Node("S", "", "<invoke subflow=\"G\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "S") + Link("S", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Undoable("B") +
         Node("C", "", "<invoke operation=\"doC\"/>") + "<sink name=\"t\"/>" + Link("s", "B") +
         Link("B", "C") + Link("C", "t") + "</flow>");
  Start();
  for (int i = 0; i < 2; ++i) {
    now_us_ += 1000;
    Turn({Done(commands_[0].id)});
  }
  const CommandId last = commands_[0].id;
  Cancel(true);
  Turn({Report(last, Outcome::kCancelled)});
  EXPECT_THAT(Operations(), ElementsAre("undoB"));
  Turn({Done(commands_[0].id)});
  EXPECT_THAT(Operations(), ElementsAre("undoA"));
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Run("runState"), "cancelled");
}

TEST_F(EngineCompensationTest, EachValueOfForEachIsUndoneWithIt) {
  conditions_.Set("urn:near", {{{"s", Term::Iri("urn:1")}, {"o", Term::Iri("urn:o")}},
                               {{"s", Term::Iri("urn:2")}, {"o", Term::Iri("urn:o")}}});
  Deploy("<message name=\"m\"><part name=\"s\"/></message>" +
         Flow("<node name=\"A\" ext:forEach=\"?s\" ext:sequential=\"true\" ext:compensate=\"undoA\">" +
              Condition("near") + "<invoke operation=\"doA\"/></node>" +
              Node("L", "", "<invoke operation=\"doL\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "L") + Link("L", "t")));
  robots_.offers[0].inputs = std::vector<std::string>{"s"};
  const CommandId last = RunAfter(2);
  Cancel(true);
  Turn({Report(last, Outcome::kCancelled)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].arguments[0].second, Term::Iri("urn:2"));
  Turn({Done(commands_[0].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].arguments[0].second, Term::Iri("urn:1"));
}

TEST_F(EngineCompensationTest, ANodeThatAnOperatorSkippedIsNotUndone) {
  Deploy(
      Flow("<node name=\"A\" ext:compensate=\"undoA\" ext:onFailure=\"incident\"><invoke "
           "operation=\"doA\"/></node>" +
           Node("L", "", "<invoke operation=\"doL\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
           Link("A", "L") + Link("L", "t")));
  Start();
  Turn({Failed(commands_[0].id, "stuck")});
  RunRequest skip;
  skip.kind = Kind::kSkipNode;
  skip.target = "F-1";
  skip.node = "A";
  Turn({}, {skip});
  Cancel(true);
  EXPECT_EQ(Run("runState"), "cancelled");
}

// The robot brakes, and then says that it has done it.
TEST_F(EngineCompensationTest, WhatSucceedsThoughItWasCancelledIsUndoneInItsPlace) {
  Deploy(Flow(Undoable("A") + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "t")));
  const CommandId second = RunAfter(1);
  Cancel(true);
  EXPECT_THAT(commands_, IsEmpty()) << "how B ends is not known";
  EXPECT_EQ(Run("runState"), "running");
  Turn({Done(second)});
  Does("undoB");
  Does("undoA");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; what it did was undone");
}

TEST_F(EngineCompensationTest, WhatDidNothingBeforeItWasCancelledHasNothingUndone) {
  Deploy(Flow(Undoable("A") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  const CommandId first = RunAfter(0);
  Cancel(true);
  EXPECT_EQ(Run("runState"), "running");
  Turn({Report(first, Outcome::kCancelled)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire");
}

TEST_F(EngineCompensationTest, AnUnknownOutcomeIsSaidNotUndone) {
  Deploy(Flow(Undoable("A") + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "t")));
  const CommandId second = RunAfter(1);
  Cancel(true);
  Turn({Report(second, Outcome::kUnknown)});
  Does("undoA");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; not undone: B: how it ended is unknown");
}

TEST_F(EngineCompensationTest, AnUnknownOutcomeThatFailsTheRunIsSaidToo) {
  Deploy(Flow(Undoable("A") + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "t")));
  const CommandId second = RunAfter(1);
  Turn({Report(second, Outcome::kUnknown)});
  Does("undoA");
  EXPECT_THAT(Run("reason"), HasSubstr("not undone: B: how it ended is unknown"));
}

TEST_F(EngineCompensationTest, ARobotThatIsOutOfReachIsNotWaitedFor) {
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  Deploy(Flow(Undoable("A") + Undoable("B") + Node("J", "", "") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("s", "B") + Link("A", "J") + Link("B", "J") + Link("J", "t")));
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  const std::vector<RobotCommand> both = commands_;
  Turn({Done(both[0].id)});
  Cancel(true);
  EXPECT_THAT(commands_, IsEmpty());
  for (RobotOffer& offer : robots_.offers) offer.offline = offer.robot == both[1].robot;
  Turn();
  Does("undoA");
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; not undone: B (undoB): how it ends is not known yet");
}

TEST_F(EngineCompensationTest, AnOutcomeIsWaitedForAsLongAsAStep) {
  Deploy(Flow(Undoable("A") + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "t")));
  RunAfter(1);
  Cancel(true);
  now_us_ += Limits{}.default_step_timeout_ms * TimeMicros{1000} - 1;
  Turn();
  EXPECT_EQ(Run("runState"), "running");
  ASSERT_TRUE(engine_.NextDeadline());
  EXPECT_EQ(*engine_.NextDeadline(), now_us_ + 1);
  now_us_ += 1;
  Turn();
  EXPECT_THAT(commands_, IsEmpty()) << "the robot is held by B";
  now_us_ += Limits{}.default_step_timeout_ms * TimeMicros{1000};
  Turn();
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_THAT(Run("reason"), HasSubstr("A (undoA)"));
  EXPECT_THAT(Run("reason"), HasSubstr("B (undoB): how it ends is not known yet"));
}

TEST_F(EngineCompensationTest, WhatASiblingThatFailedEndedIsUndoneIfItSucceeds) {
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  Deploy(Flow(Undoable("B") + Node("Bad", "", "<invoke operation=\"bad\"/>") + Node("J", "", "") +
              "<sink name=\"t\"/>" + Link("s", "B") + Link("s", "Bad") + Link("B", "J") + Link("Bad", "J") +
              Link("J", "t")));
  Start();
  ASSERT_THAT(Operations(), ElementsAre("doB", "bad"));
  const std::vector<RobotCommand> both = commands_;
  Turn({Failed(both[1].id, "stuck")});
  EXPECT_THAT(cancels_, ElementsAre(both[0].id));
  EXPECT_EQ(Run("runState"), "running");
  Turn({Done(both[0].id)});
  ASSERT_THAT(Operations(), ElementsAre("undoB"));
  EXPECT_EQ(commands_[0].robot, both[0].robot);
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Run("runState"), "failed");
  EXPECT_EQ(Run("reason"), "node Bad: 1/1 bad: stuck; what it did was undone");
}

TEST_F(EngineCompensationTest, WhatALoopEndedIsUndoneIfItSucceeds) {
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  conditions_.Set("urn:again", {{{"s", Term::Iri("urn:1")}, {"o", Term::Iri("urn:o")}}});
  Deploy(Flow(Node("A", "", "") + Node("B", "", "<invoke operation=\"doB\"/>") + Undoable("C") +
              Node("J", "", "<invoke operation=\"bad\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "B") + Link("A", "C") + Link("B", "A", "ext:while=\"?s &lt;urn:again&gt; ?o\"") +
              Link("B", "J") + Link("C", "J") + Link("J", "t")));
  Start();
  ASSERT_THAT(Operations(), ElementsAre("doB", "doC"));
  const std::vector<RobotCommand> first = commands_;
  Turn({Done(first[0].id)});
  EXPECT_THAT(cancels_, ElementsAre(first[1].id));
  conditions_.Set("urn:again", {});
  ASSERT_THAT(Operations(), ElementsAre("doB"));
  const CommandId again = commands_[0].id;
  now_us_ += 1000;
  Turn({Done(first[1].id)});
  ASSERT_THAT(Operations(), ElementsAre("doC"));
  const CommandId second = commands_[0].id;
  Turn({Done(again)});
  now_us_ += 1000;
  Turn({Done(second)});
  ASSERT_THAT(Operations(), ElementsAre("bad"));
  Turn({Failed(commands_[0].id, "stuck")});
  std::vector<std::string> undone;
  while (!commands_.empty() && undone.size() < 5) {
    undone.push_back(commands_[0].operation);
    Turn({Done(commands_[0].id)});
  }
  EXPECT_THAT(undone, ElementsAre("undoC", "undoC"));
  EXPECT_EQ(Run("reason"), "node J: 1/1 bad: stuck; not undone: B: no ext:compensate");
}

TEST_F(EngineCompensationTest, WhatWasDoneAfterItsTimeIsUndone) {
  Deploy(
      Flow("<node name=\"A\" ext:compensate=\"undoA\"><invoke operation=\"doA\" ext:timeout=\"1s\"/></node>"
           "<sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  const CommandId first = RunAfter(0);
  now_us_ += 1000000;
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first));
  EXPECT_EQ(Run("runState"), "running");
  Turn({Done(first)});
  Does("undoA");
  EXPECT_EQ(Run("runState"), "failed");
  EXPECT_THAT(Run("reason"), HasSubstr("; what it did was undone"));
}

TEST_F(EngineCompensationTest, WhatALiveSubflowDoesAfterAllIsUndoneToo) {
  Deploy(Flow(Undoable("A") + Node("S", "", "<invoke subflow=\"G\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "S") + Link("S", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "B") +
         Link("B", "t") + "</flow>");
  const CommandId inner = RunAfter(1);
  Cancel(true);
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(inner)});
  Does("undoB");
  Does("undoA");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; what it did was undone");
}

// The sub-flow ends with its time, in the run in which it is nested another node goes on.
TEST_F(EngineCompensationTest, WhatASubflowThatWasEndedDoesAfterAllIsUndoneWithItsParent) {
  Deploy(Flow("<node name=\"S\"><invoke subflow=\"G\" ext:timeout=\"1s\"/></node>" +
              Node("L", "", "<invoke operation=\"doL\"/>") + "<sink name=\"t\"/>" + Link("s", "S") +
              Link("S", "L", "ext:onFailure=\"true\"") + Link("L", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("I", "", "<invoke subflow=\"H\"/>") +
         "<sink name=\"t\"/>" + Link("s", "I") + Link("I", "t") + "</flow>" +
         "<flow name=\"H\"><source name=\"s\"/>" + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "B") +
         Link("B", "t") + "</flow>");
  const CommandId inner = RunAfter(0);
  now_us_ += 1000000;
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(inner));
  Turn({Done(inner)});
  ASSERT_THAT(Operations(), ElementsAre("doL"));
  Turn({Failed(commands_[0].id, "stuck")});
  Does("undoB");
  EXPECT_EQ(Run("reason"), "node L: 1/1 doL: stuck; what it did was undone");
}

TEST_F(EngineCompensationTest, WhatIsUnderWayForAValueOfForEachIsUndoneIfItSucceeds) {
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  conditions_.Set("urn:near", {{{"s", Term::Iri("urn:1")}, {"o", Term::Iri("urn:o")}},
                               {{"s", Term::Iri("urn:2")}, {"o", Term::Iri("urn:o")}}});
  Deploy("<message name=\"m\"><part name=\"s\"/></message>" +
         Flow("<node name=\"A\" ext:forEach=\"?s\" ext:compensate=\"undoA\">" + Condition("near") +
              "<invoke operation=\"doA\"/></node>" + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  for (RobotOffer& offer : robots_.offers) offer.inputs = std::vector<std::string>{"s"};
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  const std::vector<RobotCommand> both = commands_;
  Turn({Failed(both[1].id, "stuck")});
  EXPECT_THAT(cancels_, ElementsAre(both[0].id));
  CommandReport late = Done(both[0].id);
  late.results = {{"place", Term::Iri("urn:shelf")}};
  Turn({late});
  ASSERT_THAT(Operations(), ElementsAre("undoA"));
  EXPECT_EQ(commands_[0].arguments[0].second, Term::Iri("urn:1"));
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Run("reason"), "node A: 1/1 doA: stuck; what it did was undone");
}

TEST_F(EngineCompensationTest, WhatAnIncidentEndedAndSucceedsIsDone) {
  Deploy(
      Flow("<node name=\"A\" ext:compensate=\"undoA\" ext:onFailure=\"incident\" ext:timeout=\"1s\"><invoke "
           "operation=\"doA\"/></node><sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  const CommandId first = RunAfter(0);
  now_us_ += 1000000;
  Turn();
  ASSERT_EQ(Fact("urn:docent:run:F-1/A", "nodeState"), "incident");
  Turn({Done(first)});
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/0", "invocationState"), "done");
  Cancel(true);
  Does("undoA");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; what it did was undone");
}

TEST_F(EngineCompensationTest, WhatSucceedsThoughItsNodeFailedIsNotDoneAgain) {
  Deploy(
      Flow("<node name=\"A\" ext:compensate=\"undoA\" ext:retry=\"1\" ext:timeout=\"1s\"><invoke "
           "operation=\"doA\"/></node>" +
           Node("L", "", "<invoke operation=\"doL\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
           Link("A", "L") + Link("L", "t")));
  const CommandId first = RunAfter(0);
  now_us_ += 1000000;
  Turn();
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(first)});
  ASSERT_THAT(Operations(), ElementsAre("doL"));
  Turn({Failed(commands_[0].id, "stuck")});
  Does("undoA");
  EXPECT_EQ(Run("reason"), "node L: 1/1 doL: stuck; what it did was undone");
}

TEST_F(EngineCompensationTest, WhatAnInterruptedNodeDidIsUndone) {
  conditions_.Set("urn:near", {{{"s", Term::Iri("urn:1")}, {"o", Term::Iri("urn:o")}},
                               {{"s", Term::Iri("urn:2")}, {"o", Term::Iri("urn:o")}}});
  conditions_.Set("urn:calm", {{{"s", Term::Iri("urn:1")}, {"o", Term::Iri("urn:o")}}});
  Deploy(
      Flow("<node name=\"A\" ext:forEach=\"?s\" ext:sequential=\"true\" ext:compensate=\"undoA\" "
           "ext:while-holds=\"?x &lt;urn:calm&gt; ?y\">" +
           Condition("near") + "<invoke operation=\"doA\"/></node><sink name=\"t\"/>" + Link("s", "A") +
           Link("A", "t")));
  const CommandId second = RunAfter(1);
  conditions_.Set("urn:near", {});
  conditions_.Set("urn:calm", {});
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(second));
  Turn({Report(second, Outcome::kCancelled)});
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "nodeState"), "waiting");
  Cancel(true);
  Does("undoA");
  EXPECT_EQ(Run("reason"), "cancelled on request: fire; what it did was undone");
}

TEST_F(EngineCompensationTest, ALateSuccessCountsAfterARestart) {
  Deploy(Flow(Undoable("A") + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "t")));
  const CommandId second = RunAfter(1);
  Cancel(true);
  Restart();
  Turn({Done(second)});
  EXPECT_THAT(Operations(), ElementsAre("undoB"));
}

TEST_F(EngineCompensationTest, ASecondCancelSaysHowMuchIsNotKnown) {
  Deploy(Flow(Undoable("A") + Undoable("B") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") +
              Link("B", "t")));
  RunAfter(1);
  Cancel(true);
  Cancel(false);
  EXPECT_EQ(Run("reason"),
            "cancelled on request: fire; not undone: A (undoA): it was not tried; B (undoB): how it ends is "
            "not known yet");
}

// A sub-flow is at undoing what it did when its parent is cancelled.
TEST_F(EngineCompensationTest, TheUndoingOfASubflowGoesOnInItsParent) {
  Deploy(Flow(Node("S", "", "<invoke subflow=\"G\"/>") + "<sink name=\"t\"/>" + Link("s", "S") +
              Link("S", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Undoable("A") + Undoable("B") +
         Node("C", "", "<invoke operation=\"doC\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
         Link("A", "B") + Link("B", "C") + Link("C", "t") + "</flow>");
  const CommandId third = RunAfter(2);
  Turn({Failed(third, "stuck")});
  ASSERT_THAT(Operations(), ElementsAre("undoB"));
  const CommandId undo = commands_[0].id;
  Cancel(true);
  EXPECT_THAT(cancels_, ElementsAre(undo));
  Turn({Report(undo, Outcome::kCancelled)});
  Does("undoA");
  EXPECT_THAT(Run("reason"), HasSubstr("B (undoB): it was cancelled"));
}

TEST_F(EngineCompensationTest, WhatHasNothingThatUndoesItIsNamed) {
  Deploy(Flow(Undoable("A") + Node("B", "", "<invoke operation=\"doB\"/>") +
              Node("C", "", "<invoke operation=\"doC\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "B") + Link("B", "C") + Link("C", "t")));
  const CommandId third = RunAfter(2);
  Restart();
  Turn({Failed(third, "stuck")});
  Does("undoA");
  EXPECT_EQ(Run("reason"), "node C: 1/1 doC: stuck; not undone: B: no ext:compensate");
}

TEST_F(EngineCompensationTest, SoItIsOfASubFlowThatHasEnded) {
  Deploy(Flow(Undoable("A") + Node("Call", "", "<invoke subflow=\"G\"/>") +
              Node("C", "", "<invoke operation=\"doC\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "Call") + Link("Call", "C") + Link("C", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"doB\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  const CommandId last = RunAfter(2);
  Turn({Failed(last, "stuck")});
  Does("undoA");
  EXPECT_EQ(Run("reason"), "node C: 1/1 doC: stuck; not undone: Call/B: no ext:compensate");
}

TEST_F(EngineCompensationTest, ARunWithoutCompensationSaysNothingOfIt) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"doA\"/>") + Node("C", "", "<invoke operation=\"doC\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "C") + Link("C", "t")));
  Turn({Failed(RunAfter(1), "stuck")});
  EXPECT_EQ(Run("reason"), "node C: 1/1 doC: stuck");
}

}  // namespace
}  // namespace docent::engine
