// Runs that wait for a robot.
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

using EngineWaitingTest = EngineTest;

TEST_F(EngineWaitingTest, ARobotServesOneRunAtATimeAndTheNextWaits) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  CommandId first = commands_[0].id;
  Start();
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(Fact("urn:docent:run:F-2/A/0", "reason"), HasSubstr("serves another run"));
  Turn({Done(first)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-2/"));
}

TEST_F(EngineWaitingTest, TheRunThatCameFirstGetsTheRobotThatBecomesFree) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  for (int i = 1; i <= 11; ++i) Start();
  for (int i = 2; i <= 11; ++i) {
    std::vector<CommandUnderWay> open = engine_.OpenCommands();
    ASSERT_EQ(open.size(), 1u);
    Turn({Done(open[0].command.id)});
    ASSERT_EQ(commands_.size(), 1u);
    EXPECT_THAT(commands_[0].id.value(), ::testing::StartsWith("F-" + std::to_string(i) + "/"));
  }
}

TEST_F(EngineWaitingTest, ARobotThatJoinsGoesToTheOldestNotToTheRunThatBeginsInThatTurn) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  Start();
  EXPECT_THAT(commands_, IsEmpty());
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-2/"));
}

TEST_F(EngineWaitingTest, AFreedRobotWakesOneRunNotAll) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  robots_.news = false;
  Start();
  CommandId first = commands_[0].id;
  for (int i = 0; i < 50; ++i) Start();
  Turn({Done(first)});
  EXPECT_EQ(commands_.size(), 1u);
  // 1: the run that ended; 2: the one that got the robot. The other 49 were not examined.
  EXPECT_LE(robots_.asked, 10);
}

TEST_F(EngineWaitingTest, ARobotThatTheOldestCannotUseGoesToTheNext) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  robots_.news = false;
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  auto start_with = [this](const std::string& robot) {
    Turn({}, {{RunRequest::Kind::kStart, "W/F", {{"robot", Term::Iri(robot)}}}});
  };
  start_with("urn:r1");
  CommandId first = commands_[0].id;
  start_with("urn:r2");
  CommandId second = commands_[0].id;
  start_with("urn:r1");  // waits for r1
  start_with("urn:r2");  // waits for r2
  Turn({Done(second)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-4/"));
  Turn({Done(first)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-3/"));
}

TEST_F(EngineWaitingTest, ANodeWhoseRobotsAreBusyOpensWhenOneIsFreedOrAnotherOneAppears) {
  std::string near = Condition("near");
  near.replace(near.find("?s"), 2, "?robot");
  Deploy(Flow("<node name=\"A\">" + near + "<invoke operation=\"a\"/></node><sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")) +
         "<flow name=\"H\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  robots_.news = false;
  Turn({}, {{RunRequest::Kind::kStart, "W/H", {}}});
  CommandId busy = commands_[0].id;
  TermBinding r1 = {{"robot", Term::Iri("urn:r1")}, {"o", Term::Iri("urn:y")}};
  TermBinding r2 = {{"robot", Term::Iri("urn:r2")}, {"o", Term::Iri("urn:y")}};
  conditions_.Set("urn:near", {r1});
  Start();
  Start();
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(busy)});
  ASSERT_EQ(commands_.size(), 1u);  // F-2 has r1 now, F-3 waits on
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-2/"));
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, false});
  conditions_.Set("urn:near", {r1, r2});
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r2");
}

// An event that came while its robot served another run is not lost; one that is gone by then is.
TEST_F(EngineWaitingTest, AnEventWaitsForABusyRobotAsLongAsItStands) {
  std::string near = Condition("near");
  near.replace(near.find("?s"), 2, "?robot");
  near.replace(
      near.find("<condition>"), 11,
      "<condition expression=\"rang and near\"><case name=\"rang\"><event operation=\"bell\"/></case>");
  Deploy(Flow("<node name=\"A\">" + near + "<invoke operation=\"a\"/></node><sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")) +
         "<flow name=\"H\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  robots_.news = false;
  auto ring = [](const std::string& event) {
    return TermBinding{
        {"robot", Term::Iri("urn:r1")}, {"o", Term::Iri("urn:y")}, {"_event_1", Term::Iri(event)}};
  };
  Turn({}, {{RunRequest::Kind::kStart, "W/H", {}}});
  CommandId busy = commands_[0].id;
  Start();
  conditions_.Set("urn:near", {ring("urn:e1")});
  Turn();
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(busy)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-2/"));

  busy = commands_[0].id;
  Start();
  conditions_.Set("urn:near", {ring("urn:e1"), ring("urn:e2")});
  Turn();
  conditions_.Set("urn:near",
                  {ring("urn:e1")});  // e2 is gone before the robot is free; e1 came before the run
  Turn();
  Turn({Done(busy)});
  EXPECT_THAT(commands_, IsEmpty());
}

TEST_F(EngineWaitingTest, AServiceThatIsRegisteredLaterIsUsedByTheInvocationThatWaits) {
  robots_.offers.clear();
  robots_.only = "go";
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}};
  robots_.news = false;
  Deploy(Flow(Node("A", "", "<invoke operation=\"Tour\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  EXPECT_THAT(commands_, IsEmpty());
  std::string text =
      "<rsel name=\"S\" namespace=\"urn:s\" version=\"1\"><process name=\"Tour\"><invoke operation=\"go\"/>"
      "</process></rsel>";
  rsel::ParsedRsel parsed = rsel::ParseRsel(text, "s.xml");
  ASSERT_TRUE(parsed.ok());
  EXPECT_THAT(engine_.PutServices(parsed.document), IsEmpty());
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "go");
}

TEST_F(EngineWaitingTest, NoRobotOnlineIsSaidAndWaitedFor) {
  robots_.offers[0].offline = true;
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  EXPECT_THAT(Fact("urn:docent:run:F-1/A/0", "reason"), HasSubstr("no robot that is online offers a"));
  robots_.offers[0].offline = false;
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

}  // namespace
}  // namespace docent::engine
