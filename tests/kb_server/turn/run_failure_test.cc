// Nodes that fail of their own, and what a node tells when it has failed.
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Tell;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class RunFailureTest : public RunActionsTest {
 protected:
  TurnResult After(TimeMicros seconds) {
    now_us_ += seconds * 1'000'000;
    WriteBatch tick;
    tick.clock_tick = true;
    return Must(std::move(tick));
  }
};

TEST_F(RunFailureTest, ANodeFailsWithItsReason) {
  DeployOne("<ext:fail reason=\"the door is locked\"/>");
  EXPECT_THAT(Said(Run()), Contains("F-1 running>failed: node A: the door is locked"));
  DeployOne("<ext:fail reason=\"$x\"/>");
  EXPECT_THAT(Said(Run({{"x", Term::Literal("no room")}})), Contains("F-2 running>failed: node A: no room"));
  EXPECT_THAT(Said(Run()), Contains("F-3 running>failed: node A: variable $x has no value"));
}

TEST_F(RunFailureTest, ItFollowsTheLinksOfAFailure) {
  Deploy(
      "<node name=\"A\" ext:retry=\"3\"><ext:tell>w:it w:was w:Told</ext:tell><ext:fail "
      "reason=\"no\"/></node>"
      "<node name=\"B\"><ext:tell>w:it w:went w:On</ext:tell></node>",
      {}, "",
      "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/><link from=\"A\" to=\"B\" "
      "ext:onFailure=\"true\"/><link from=\"B\" to=\"e\"/>");
  EXPECT_THAT(Said(Run()), Contains("F-1 running>done: "));
  EXPECT_TRUE(Has(Fact("it", "was", "Told"))) << "what stands before it is done";
  EXPECT_TRUE(Has(Fact("it", "went", "On")));
}

TEST_F(RunFailureTest, ItMayWaitForAnOperator) {
  Deploy("<node name=\"A\" ext:onFailure=\"incident\"><ext:fail reason=\"look\"/></node>", {"A"});
  EXPECT_THAT(Said(Run()), Contains("F-1/A running>incident: look"));
}

TEST_F(RunFailureTest, AFailedRunUndoesAndTells) {
  Must(Tell(test::FreeRobots({"R1"}, "drive")));
  Must(Tell(test::FreeRobots({"R1"}, "back")));
  Deploy(
      "<node name=\"A\" ext:compensate=\"back\"><invoke operation=\"drive\"/></node>"
      "<node name=\"B\"><ext:tell>w:it w:was w:Refused</ext:tell><ext:fail reason=\"refused\"/></node>",
      {"A", "B"});
  const TurnResult begun = Run();
  ASSERT_THAT(begun.record.commands, SizeIs(1));
  const TurnResult failed =
      Must(test::Report(begun.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_TRUE(Has(Fact("it", "was", "Refused")));
  ASSERT_THAT(failed.record.commands, SizeIs(1));
  EXPECT_EQ(failed.record.commands[0].operation, "back");
  EXPECT_THAT(Said(Must(test::Report(failed.record.commands[0].id, CommandReport::Outcome::kSucceeded))),
              Contains(HasSubstr("F-1 running>failed: node B: refused")));
}

TEST_F(RunFailureTest, ANodeTellsWhenItHasFailedForGood) {
  Must(Tell(test::FreeRobots({"R1"}, "drive")));
  DeployOne(
      "<invoke operation=\"drive\" ext:retry=\"1\"/><ext:tell at=\"failure\">$x a w:Stuck</ext:tell>"
      "<ext:tell at=\"failure\" lifetime=\"run\">w:it w:lasts w:Shortly</ext:tell>");
  TurnResult turn = Run({{"x", test::Iri("Door")}});
  turn = Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kFailed));
  EXPECT_FALSE(Has(Fact("Door", "a", "Stuck"))) << "it has another attempt";
  ASSERT_THAT(turn.record.commands, SizeIs(1));
  turn = Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kFailed));
  EXPECT_TRUE(Has(Fact("Door", "a", "Stuck")));
  EXPECT_FALSE(Has(Fact("it", "lasts", "Shortly"))) << "the run has ended";
  turn = Run({{"x", test::Iri("Gate")}});
  Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_FALSE(Has(Fact("Gate", "a", "Stuck"))) << "it has not failed";
}

TEST_F(RunFailureTest, AConditionThatDidNotHoldInTimeIsAFailureToo) {
  std::string condition = When("w:a", "w:is", "w:Open");
  condition.insert(std::string("<condition").size(), " ext:timeout=\"5s\"");
  DeployOne(condition + "<ext:tell at=\"failure\">w:it w:was w:Late</ext:tell>");
  Run();
  const TurnResult late = After(6);
  EXPECT_THAT(Said(late), Contains(HasSubstr("F-1 running>failed")));
  EXPECT_TRUE(Has(Fact("it", "was", "Late")));
}

TEST_F(RunFailureTest, WhatCannotBeToldIsSaidBesideTheReason) {
  DeployOne("<ext:fail reason=\"no\"/><ext:tell at=\"failure\">$x a w:Stuck</ext:tell>");
  EXPECT_THAT(Said(Run()),
              Contains(HasSubstr("F-1 running>failed: node A: no; at=\"failure\": it cannot tell: "
                                 "variable $x has no value")));
}

TEST_F(RunFailureTest, WhatIsCancelledHasNotFailed) {
  DeployOne(When("w:a", "w:is", "w:Open") + "<ext:tell at=\"failure\">w:it w:was w:Late</ext:tell>");
  Run();
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "F-1", {}});
  Must(std::move(cancel));
  EXPECT_FALSE(Has(Fact("it", "was", "Late")));
}

}  // namespace
}  // namespace docent::server
