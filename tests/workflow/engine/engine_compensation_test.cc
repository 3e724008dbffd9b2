// Compensation: what done nodes did is undone, the last first, when a run is cancelled so, and when it fails.
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/engine/engine_state.h"

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
  auto bytes = EncodeEngineState(engine_.Save());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  auto state =
      DecodeEngineState(*bytes, Limits{}, &dictionary_, [](const RunId&) { return std::vector<Quad>(); });
  ASSERT_TRUE(state.ok()) << state.status();
  engine_.Restore(*std::move(state));
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

}  // namespace
}  // namespace docent::engine
