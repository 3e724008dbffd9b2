// Runs that ask for one thing: of those that begin or wait in one turn, one takes it.
#include <string>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;

// A node that takes the lift if no run has it.
std::string TakesLift(const std::string& more = "") {
  return absl::StrCat(
      "<node name=\"A\"><condition><context name=\"free\"><rule expression=\"not taken\"><constraint "
      "name=\"taken\"><subject>w:Lift</subject><verb>w:inUseBy</verb><object>?other</object></constraint></"
      "rule>"
      "</context></condition><ext:tell lifetime=\"run\">w:Lift w:inUseBy $x</ext:tell>",
      more, "</node>");
}

class LiftTest : public RunActionsTest {
 protected:
  void Take(const std::string& node) {
    Must(test::WorldFacts());
    Deploy(node + "<node name=\"B\">" + When("$x", "w:is", "w:There") + "</node>", {"A", "B"});
  }
  // Runs of John and Mary, begun in one turn.
  TurnResult Both() {
    WriteBatch batch = test::Start("W", {{"x", test::Iri("John")}});
    batch.run_requests.push_back(test::Start("W", {{"x", test::Iri("Mary")}}).run_requests[0]);
    return Must(std::move(batch));
  }
  std::string Has() const {
    std::string who;
    for (const char* name : {"John", "Mary"}) {
      if (RunActionsTest::Has(Fact("Lift", "inUseBy", name))) who += name;
    }
    return who;
  }
};

TEST_F(LiftTest, OfTwoRunsThatBeginInOneTurnOneTakesIt) {
  for (const std::string invoke : {"", "<invoke operation=\"greet\"/>"}) {
    Take(TakesLift(invoke));
    const TurnResult turn = Both();
    EXPECT_EQ(Has(), "John") << invoke;
    EXPECT_EQ(turn.record.commands.size(), invoke.empty() ? 0 : 1);
    if (!invoke.empty()) Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
    Must(Tell({Fact("John", "is", "There")}));
    EXPECT_EQ(Has(), "Mary") << "the next has it when the first has ended";
    Must(Tell({}, {Fact("John", "is", "There")}));
    WriteBatch cancel;
    cancel.run_requests.push_back({RunRequest::Kind::kCancel, invoke.empty() ? "F-2" : "F-4", {}});
    Must(cancel);
  }
}

TEST_F(LiftTest, OfTwoRunsThatWaitForItOneTakesIt) {
  Must(Tell({Fact("Lift", "inUseBy", "Ada")}));
  Take(TakesLift());
  Run({{"x", test::Iri("John")}});
  Run({{"x", test::Iri("Mary")}});
  Must(Tell({}, {Fact("Lift", "inUseBy", "Ada")}));
  EXPECT_EQ(Has(), "John");
}

TEST_F(LiftTest, WhatFollowsByRulesCountsAsWell) {
  Must(Put(Document::Kind::kRules, "r.rules",
           "PREFIX w: <urn:w:>\nRULE { ?a w:inUseBy ?b } WHERE { ?b w:rides ?a }"));
  std::string node = TakesLift();
  node.replace(node.find("w:Lift w:inUseBy $x"), 19, "$x w:rides w:Lift");
  Take(node);
  Both();
  EXPECT_EQ(Has(), "John");
}

TEST_F(LiftTest, WhatIsTakenAwayCountsAsWell) {
  Must(Tell({Fact("Key", "on", "Hook")}));
  Take("<node name=\"A\">" + When("w:Key", "w:on", "?hook") +
       "<ext:withdraw source=\"any\">w:Key w:on ?hook</ext:withdraw><ext:tell>w:Lift w:inUseBy "
       "$x</ext:tell></node>");
  Both();
  EXPECT_EQ(Has(), "John");
}

TEST_F(LiftTest, WhereMoreAskOneAfterTheOtherThanATurnHasRoundsTheyGoOnInTheNext) {
  std::string node = TakesLift();
  node.replace(node.find("?other"), 6, "w:Nobody");
  Take(node);
  WriteBatch batch;
  for (int i = 0; i < 40; ++i)
    batch.run_requests.push_back(test::Start("W", {{"x", test::Iri(absl::StrCat("U", i))}}).run_requests[0]);
  Must(std::move(batch));
  size_t turns = 1;
  for (; stages_.engine.AwaitsTick() && turns < 20; ++turns) {
    WriteBatch tick;
    tick.clock_tick = true;
    Must(tick);
  }
  EXPECT_GT(turns, 1u);
  for (int i = 0; i < 40; ++i)
    EXPECT_TRUE(RunActionsTest::Has(Fact("Lift", "inUseBy", absl::StrCat("U", i))));
}

}  // namespace
}  // namespace docent::server
