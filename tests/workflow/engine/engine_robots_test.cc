// One robot, one exclusive command: what holds a robot, until when, and what may run beside what.
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/engine/engine_state.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EngineRobotsTest : public EngineTest {
 protected:
  using Outcome = CommandReport::Outcome;

  static std::string OneNode(const std::string& invokes, const std::string& node = "") {
    return Flow("<node name=\"A\" " + node + ">" + invokes + "</node><sink name=\"t\"/>" + Link("s", "A") +
                Link("A", "t"));
  }
  // F invokes G as a sub-flow, G invokes b; `more` stands after it in F.
  static std::string Nested(const std::string& invoke = "", const std::string& more = "") {
    return Flow(Node("A", "", "<invoke subflow=\"G\" " + invoke + "/>") + more + "<sink name=\"t\"/>" +
                Link("s", "A") + Link("A", "t")) +
           "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
           "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>" +
           "<flow name=\"H\"><source name=\"s\"/>" + Node("C", "", "<invoke operation=\"c\"/>") +
           "<sink name=\"t\"/>" + Link("s", "C") + Link("C", "t") + "</flow>";
  }
  void Begin(const std::string& flow) { Turn({}, {{RunRequest::Kind::kStart, "W/" + flow, {}}}); }
  void Cancel(const std::string& run) { Turn({}, {{RunRequest::Kind::kCancel, run, {}}}); }
  static CommandReport Report(const CommandId& id, Outcome outcome) { return {id, outcome, "", 0, "i1", {}}; }
  void Pass(int seconds) { now_us_ += seconds * int64_t{1000000}; }
  void Service(const std::string& invokes) {
    rsel::ParsedRsel parsed = rsel::ParseRsel(
        "<rsel name=\"S\" xmlns:ext=\"https://w3id.org/docent/rsel-ext#\"><process name=\"P\">" + invokes +
            "</process></rsel>",
        "s.xml");
    ASSERT_TRUE(parsed.ok());
    EXPECT_THAT(engine_.PutServices(parsed.document), IsEmpty());
  }
  std::vector<std::string> Facts(const std::string& subject, const std::string& predicate) const {
    std::vector<std::string> out;
    const auto s = dictionary_.FindIri(subject);
    const auto p = dictionary_.FindIri("https://w3id.org/docent#" + predicate);
    for (const Quad& quad : facts_) {
      if (quad.subject == s && quad.predicate == p) out.push_back(dictionary_.Decode(quad.object).lexical);
    }
    return out;
  }
  // The engine goes on from its saved state, as after a restart.
  void Restart() {
    auto bytes = EncodeEngineState(engine_.Save());
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    auto state = DecodeEngineState(*bytes, Limits{}, &dictionary_, [&](const RunId& run) {
      std::vector<Quad> facts;
      for (const Quad& quad : facts_) {
        if (dictionary_.Decode(quad.subject).lexical.find(run.value()) != std::string::npos)
          facts.push_back(quad);
      }
      return facts;
    });
    ASSERT_TRUE(state.ok()) << state.status();
    engine_.Restore(*std::move(state));
  }
};

TEST_F(EngineRobotsTest, TheRobotOfASubflowIsFreeOnceItsParentWasCancelledAndTheCommandHasEnded) {
  Deploy(Nested());
  Begin("F");
  const CommandId command = commands_[0].id;
  Cancel("F-1");
  EXPECT_THAT(cancels_, ElementsAre(command));
  EXPECT_EQ(Fact("urn:r1", "heldBy"), "urn:docent:run:F-1");
  EXPECT_THAT(Facts("urn:r1", "endingCommand"), ElementsAre(command.value()));
  Begin("H");
  EXPECT_THAT(commands_, IsEmpty()) << "the robot still brakes";
  Turn({Report(command, Outcome::kCancelled)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "c");
  EXPECT_EQ(Fact("urn:r1", "heldBy"), "urn:docent:run:H-3");
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(Fact("urn:r1", "heldBy"), "");
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineRobotsTest, TheRobotOfASubflowIsFreeOnceItsParentFailedAndTheCommandHasEnded) {
  Deploy(Nested("ext:timeout=\"5s\""));
  Begin("F");
  const CommandId command = commands_[0].id;
  Pass(5);
  Turn();
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_TRUE(Says("G-2 running>cancelled"));
  Begin("H");
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Report(command, Outcome::kCancelled)});
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineRobotsTest, AfterARestartACommandThatWasEndingStillHoldsItsRobot) {
  Deploy(Nested());
  Begin("F");
  const CommandId command = commands_[0].id;
  Cancel("F-1");
  Restart();
  ASSERT_EQ(engine_.OpenCommands().size(), 1u);
  EXPECT_TRUE(engine_.OpenCommands()[0].ending);
  Begin("H");
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Report(command, Outcome::kUnknown)});
  EXPECT_EQ(commands_.size(), 1u) << "the incarnation is gone";
}

TEST_F(EngineRobotsTest, ARefusedTurnLeavesTheLedgerAsItWas) {
  Deploy(Nested());
  Begin("F");
  const CommandId command = commands_[0].id;
  Cancel("F-1");
  std::vector<CommandReport> reports = {Report(command, Outcome::kCancelled)};
  EngineInput input{now_us_, Revision(9), false, &reports, nullptr, nullptr, &conditions_, &robots_};
  engine_.Step(input);
  engine_.Rollback();
  EXPECT_EQ(engine_.OpenCommands().size(), 1u);
  ASSERT_NE(engine_.HolderOf(RobotId("urn:r1")), nullptr);
  engine_.Step(input);
  engine_.Commit();
  EXPECT_THAT(engine_.OpenCommands(), IsEmpty());
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineRobotsTest, ARunThatEndsWhileABranchIsUnderWayKeepsTheRobotUntilThatHasEnded) {
  robots_.offers[0].occupies = {"base"};
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\" ext:timeout=\"2s\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  Begin("F");
  const CommandId command = commands_[0].id;
  Pass(2);
  Turn();
  EXPECT_TRUE(Says("F-1 running>failed"));
  Begin("F");
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Report(command, Outcome::kSucceeded)});
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineRobotsTest, ARetriedStepBeginsWhenTheAttemptBeforeHasEnded) {
  Service("<invoke operation=\"go\" ext:timeout=\"1s\" ext:retry=\"2\"/>");
  Turn({}, {{RunRequest::Kind::kInvokeService, "P", {}}});
  const CommandId first = commands_[0].id;
  Pass(1);
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first));
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(Fact("urn:docent:run:P-1/P/0", "reason"), HasSubstr("the end of the attempt before it"));
  Pass(4);
  Turn({Report(first, Outcome::kCancelled)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].deadline_us, now_us_ + 1000000) << "its time begins when it is sent";
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("P-1 running>done"));
}

TEST_F(EngineRobotsTest, AStepThatSucceedsAfterItsTimeIsNotDoneAgain) {
  Service("<invoke operation=\"go\" ext:timeout=\"1s\" ext:retry=\"2\"/>");
  Turn({}, {{RunRequest::Kind::kInvokeService, "P", {}}});
  const CommandId first = commands_[0].id;
  Pass(1);
  Turn();
  Turn({Done(first)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_TRUE(Says("P-1 running>done"));
}

TEST_F(EngineRobotsTest, ARetriedInvokeBeginsWhenTheAttemptBeforeHasEndedAndIsNotDoneTwice) {
  Deploy(OneNode("<invoke operation=\"a\" ext:timeout=\"1s\" ext:retry=\"1\"/>"));
  for (const Outcome outcome : {Outcome::kCancelled, Outcome::kSucceeded}) {
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    const CommandId first = commands_[0].id;
    Pass(1);
    Turn();
    EXPECT_THAT(cancels_, ElementsAre(first));
    EXPECT_THAT(commands_, IsEmpty());
    Turn({Report(first, outcome)});
    if (outcome == Outcome::kCancelled) {
      ASSERT_EQ(commands_.size(), 1u);
      Turn({Done(commands_[0].id)});
    }
    EXPECT_THAT(transitions_, ::testing::Contains(HasSubstr("running>done")));
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(EngineRobotsTest, ARetriedNodeBeginsWhenAllOfTheAttemptBeforeHasEnded) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  Deploy(OneNode("<invoke operation=\"a\"/><invoke operation=\"b\"/>", "ext:retry=\"1\""));
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  EXPECT_NE(commands_[0].robot, commands_[1].robot);
  const CommandId a = commands_[0].id, b = commands_[1].id;
  Turn({Failed(a, "slipped")});
  EXPECT_THAT(cancels_, ElementsAre(b));
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Report(b, Outcome::kCancelled)});
  EXPECT_EQ(commands_.size(), 2u);
}

TEST_F(EngineRobotsTest, TheTimeOfANodeIsThatOfEachAttemptAndBeginsWithIt) {
  const std::vector<std::string> retries = {"ext:retry=\"1\"", "ext:retry=\"1\" ext:retry-delay=\"10s\""};
  for (const std::string& retry : retries) {
    Deploy(OneNode("<invoke operation=\"a\"/>", "ext:timeout=\"2s\" " + retry));
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    const CommandId first = commands_[0].id;
    Pass(2);
    Turn();
    EXPECT_THAT(cancels_, ElementsAre(first));
    Pass(3);  // it still brakes
    Turn();
    ASSERT_EQ(engine_.live_runs(), 1u) << "the second attempt has not begun";
    Turn({Report(first, Outcome::kCancelled)});
    if (commands_.empty()) {
      Pass(7);
      Turn();
    }
    ASSERT_EQ(commands_.size(), 1u) << retry;
    const CommandId second = commands_[0].id;
    EXPECT_EQ(commands_[0].deadline_us, now_us_ + 2'000'000);
    Pass(1);
    Turn();
    EXPECT_EQ(engine_.live_runs(), 1u);
    Pass(1);
    Turn();
    EXPECT_EQ(engine_.live_runs(), 0u);
    Turn({Report(second, Outcome::kCancelled)});
  }
}

TEST_F(EngineRobotsTest, NoNodeWaitsForEverForTheEndOfAnAttempt) {
  const std::vector<std::string> documents = {
      OneNode("<invoke operation=\"a\"/>", "ext:timeout=\"2s\" ext:retry=\"5\""),
      OneNode("<invoke operation=\"a\" ext:timeout=\"2s\"/>", "ext:retry=\"5\"")};
  for (const std::string& document : documents) {
    Deploy(document);
    Start();
    ASSERT_EQ(commands_.size(), 1u) << document;
    const CommandId first = commands_[0].id;
    Pass(2);
    Turn();
    Pass(299);
    Turn();
    EXPECT_EQ(engine_.live_runs(), 1u) << document;
    Pass(1);
    Turn();
    EXPECT_EQ(engine_.live_runs(), 0u) << document;
    Turn({Report(first, Outcome::kCancelled)});
  }
}

TEST_F(EngineRobotsTest, ARetriedSubflowBeginsWhenTheCommandsOfTheOneBeforeHaveEnded) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  Deploy(Nested("ext:timeout=\"2s\" ext:retry=\"1\""));
  Begin("F");
  const CommandId first = commands_[0].id;
  Pass(2);
  Turn();
  EXPECT_TRUE(Says("G-2 running>cancelled"));
  EXPECT_THAT(commands_, IsEmpty()) << "another robot is free, and the attempt before has not ended";
  Turn({Report(first, Outcome::kCancelled)});
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineRobotsTest, AnUnknownOutcomeIsRepeatedAtNoLevelUnlessIdempotent) {
  const std::string invoke = "<invoke operation=\"a\" ext:retry=\"2\"/>";
  const std::vector<std::string> documents = {OneNode(invoke), OneNode(invoke, "ext:retry=\"2\""),
                                              Nested("ext:retry=\"2\"")};
  for (const std::string& document : documents) {
    Deploy(document);
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    Turn({Report(commands_[0].id, Outcome::kUnknown)});
    EXPECT_THAT(commands_, IsEmpty()) << document;
    EXPECT_EQ(engine_.live_runs(), 0u) << document;
  }
}

TEST_F(EngineRobotsTest, AnUnknownEndOfATimedOutAttemptIsNotFollowedByAnother) {
  const std::vector<std::string> documents = {
      OneNode("<invoke operation=\"a\" ext:timeout=\"1s\" ext:retry=\"2\"/>"),
      OneNode("<invoke operation=\"a\" ext:timeout=\"1s\"/>", "ext:retry=\"2\""),
      Nested("ext:timeout=\"1s\" ext:retry=\"2\"")};
  for (const std::string& document : documents) {
    Deploy(document);
    Start();
    ASSERT_EQ(commands_.size(), 1u);
    const CommandId first = commands_[0].id;
    Pass(1);
    Turn();
    EXPECT_EQ(engine_.live_runs(), 1u) << document;
    Turn({Report(first, Outcome::kUnknown)});
    EXPECT_THAT(commands_, IsEmpty()) << document;
    EXPECT_EQ(engine_.live_runs(), 0u) << document;
  }
}

TEST_F(EngineRobotsTest, AnAttemptWhoseEndIsNeverKnownIsNotWaitedForForEver) {
  Service("<invoke operation=\"go\" ext:timeout=\"1s\" ext:retry=\"2\"/>");
  Turn({}, {{RunRequest::Kind::kInvokeService, "P", {}}});
  Pass(1);
  Turn();
  Pass(Limits{}.default_step_timeout_ms / 1000);
  Turn();
  EXPECT_TRUE(Says("P-1 running>failed"));
  EXPECT_NE(engine_.HolderOf(RobotId("urn:r1")), nullptr) << "whatever it does, it gets nothing else";
}

TEST_F(EngineRobotsTest, ParallelNodesQueueForARobotThatEachOccupiesWhole) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("B", "", "<invoke operation=\"b\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("s", "B") + Link("A", "t") + Link("B", "t")));
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(Fact("urn:docent:run:F-1/B/0", "reason"), HasSubstr("another step of this run"));
  EXPECT_THAT(Facts("urn:r1", "heldFor"), ElementsAre("urn:docent:run:F-1/A/0"));
  Turn({Done(commands_[0].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "b");
}

TEST_F(EngineRobotsTest, OperationsThatShareNoResourceRunBesideEachOther) {
  robots_.by_operation = {
      {"drive", {"base"}}, {"show", {"screen"}}, {"say", {"voice"}}, {"act", {"base", "voice"}}};
  Deploy(
      OneNode("<invoke operation=\"drive\"/><invoke operation=\"show\"/><invoke operation=\"say\"/>"
              "<invoke operation=\"act\"/><invoke operation=\"all\"/>"));
  Start();
  ASSERT_EQ(commands_.size(), 3u);
  const CommandId drive = commands_[0].id, show = commands_[1].id, say = commands_[2].id;
  Turn({Done(drive)});
  EXPECT_THAT(commands_, IsEmpty()) << "act needs the voice, too";
  Turn({Done(say)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "act");
  const CommandId act = commands_[0].id;
  Turn({Done(act)});
  EXPECT_THAT(commands_, IsEmpty()) << "all needs the screen, too";
  Turn({Done(show)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "all");
}

TEST_F(EngineRobotsTest, ParallelStepsOfAServiceQueueForWhatTheyOccupy) {
  robots_.by_operation = {{"drive", {"base"}}, {"show", {"screen"}}};
  Service(
      "<invoke operation=\"drive\"/><invoke operation=\"show\" ext:parallel=\"true\"/>"
      "<invoke operation=\"dance\" ext:parallel=\"true\"/>");
  Turn({}, {{RunRequest::Kind::kInvokeService, "P", {}}});
  ASSERT_EQ(commands_.size(), 2u);
  const CommandId drive = commands_[0].id, show = commands_[1].id;
  Turn({Done(show)});
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(drive)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "dance");
}

TEST_F(EngineRobotsTest, ForEachUsesTheRobotsThatAreIdleAndQueuesForThem) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  Deploy(Flow("<node name=\"A\" ext:forEach=\"?o\">" + Condition("booths") +
              "<invoke operation=\"a\"/></node><sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  std::vector<TermBinding> booths;
  for (int i = 0; i < 3; ++i)
    booths.push_back({{"s", Term::Iri("urn:s")}, {"o", Term::Iri("urn:b" + std::to_string(i))}});
  conditions_.Set("urn:booths", booths);
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r1");
  EXPECT_EQ(commands_[1].robot.value(), "urn:r2");
  Turn({Done(commands_[1].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r2");
}

TEST_F(EngineRobotsTest, ARobotThatARunGivesBackServesOthersBeforeTheRunEnds) {
  const std::string lift = "<node name=\"A\"><invoke subflow=\"G\"/></node>" + Node("B", "later", "") +
                           "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") + Link("B", "t");
  Deploy(Flow(lift) +
         "<flow name=\"G\"><source name=\"s\"/><node name=\"R\"><invoke operation=\"ride\"/>"
         "<ext:release at=\"done\" robots=\"&lt;urn:r1&gt;\"/></node><sink name=\"t\"/>" +
         Link("s", "R") + Link("R", "t") + "</flow>");
  Start();
  Start();
  ASSERT_EQ(commands_.size(), 0u);
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1"))->value(), "F-1");
  Turn({Done(engine_.OpenCommands().at(0).command.id)});
  ASSERT_EQ(commands_.size(), 1u) << "the first run is live, and the second rides";
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1"))->value(), "F-3");
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(engine_.HolderOf(RobotId("urn:r1")), nullptr);
  EXPECT_EQ(Fact("urn:docent:run:F-1", "runState"), "running");
}

TEST_F(EngineRobotsTest, ARobotThatAnotherStepWorksWithIsNotGivenBack) {
  robots_.by_operation = {{"a", {"base"}}, {"b", {"screen"}}};
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") +
              Node("B", "", "<invoke operation=\"b\"/><ext:release at=\"done\" robots=\"&lt;urn:r1&gt;\"/>") +
              Node("C", "later", "") + "<sink name=\"t\"/>" + Link("s", "A") + Link("s", "B") +
              Link("A", "C") + Link("B", "C") + Link("C", "t")));
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  Turn({Done(commands_[1].id)});
  ASSERT_NE(engine_.HolderOf(RobotId("urn:r1")), nullptr);
}

TEST_F(EngineRobotsTest, SequentialForEachDoesOneAfterTheOther) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  Deploy(Flow("<node name=\"A\" ext:forEach=\"?o\" ext:sequential=\"true\">" + Condition("booths") +
              "<invoke operation=\"a\"/><invoke operation=\"b\"/></node><sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  conditions_.Set("urn:booths", {{{"s", Term::Iri("urn:s")}, {"o", Term::Iri("urn:b0")}},
                                 {{"s", Term::Iri("urn:s")}, {"o", Term::Iri("urn:b1")}}});
  Start();
  ASSERT_EQ(commands_.size(), 2u) << "both invokes of the first booth";
  const CommandId a = commands_[0].id, b = commands_[1].id;
  Turn({Done(a)});
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(b)});
  EXPECT_EQ(commands_.size(), 2u);
}

TEST_F(EngineRobotsTest, ARobotThatIsBusyChargingOrInMaintenanceGetsNoCommand) {
  Deploy(OneNode("<invoke operation=\"a\"/>"));
  for (const bool busy : {true, false}) {
    robots_.offers[0].busy = busy;
    robots_.offers[0].out_of_service = busy ? "" : "is charging";
    Start();
    EXPECT_THAT(commands_, IsEmpty());
    robots_.offers[0].busy = false;
    robots_.offers[0].out_of_service = "";
    Turn();
    ASSERT_EQ(commands_.size(), 1u);
    robots_.offers[0].busy = true;  // with this
    Turn({Done(commands_[0].id)});
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(EngineRobotsTest, AServiceGoesOnWhenItsRobotIsNoLongerBusyWithSomethingElse) {
  Service("<invoke operation=\"go\"/><invoke operation=\"show\"/>");
  Turn({}, {{RunRequest::Kind::kInvokeService, "P", {}}});
  robots_.offers[0].busy = true;
  Turn({Done(commands_[0].id)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(Fact("urn:docent:run:P-1/P/0", "reason"), HasSubstr("busy with something of its own"));
  robots_.offers[0].busy = false;
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineRobotsTest, ARobotIsNoLongerBusyWithACommandWhoseEndComesInTheSameTurn) {
  robots_.by_operation = {{"go", {"base"}}, {"turn", {"base"}}, {"show", {"screen"}}};
  Service("<invoke operation=\"go\"/><invoke operation=\"turn\"/>");
  Deploy(OneNode("<invoke operation=\"P\"/><invoke operation=\"show\"/>"));
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  robots_.offers[0].busy = true;
  Turn({Done(commands_[0].id), Done(commands_[1].id)});
  EXPECT_THAT(commands_, IsEmpty()) << "what it is busy with now is its own";
  robots_.offers[0].busy = false;
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineRobotsTest, AConditionIsMetWithAnotherRobotWhileOneIsCharging) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  robots_.offers[0].out_of_service = "is charging";
  std::string near = Condition("near");
  near.replace(near.find("?s"), 2, "?robot");
  Deploy(Flow("<node name=\"A\">" + near + "<invoke operation=\"a\"/></node><sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  const TermBinding r1 = {{"robot", Term::Iri("urn:r1")}, {"o", Term::Iri("urn:y")}};
  const TermBinding r2 = {{"robot", Term::Iri("urn:r2")}, {"o", Term::Iri("urn:y")}};
  conditions_.Set("urn:near", {r1, r2});
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r2");
  Start();
  EXPECT_THAT(commands_, IsEmpty());
  robots_.offers[0].out_of_service = "";
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r1");
}

TEST_F(EngineRobotsTest, AnExplicitTimeoutBeatsTheDefault) {
  Service("<invoke operation=\"go\" ext:timeout=\"20min\" ext:retry=\"1\"/><invoke operation=\"show\"/>");
  Deploy(OneNode("<invoke operation=\"P\"/>") +
         "<flow name=\"N\"><source name=\"s\"/><node name=\"A\" ext:timeout=\"40min\"><invoke "
         "operation=\"a\"/></node><sink name=\"t\"/>" +
         Link("s", "A") + Link("A", "t") + "</flow>");
  Start();
  EXPECT_EQ(commands_[0].deadline_us, now_us_ + 20 * 60 * int64_t{1000000});
  const CommandId first = commands_[0].id;
  Pass(20 * 60 - 1);
  Turn();
  EXPECT_EQ(engine_.live_runs(), 1u);
  Pass(1);
  Turn();
  Turn({Report(first, Outcome::kCancelled)});
  ASSERT_EQ(commands_.size(), 1u) << "the second attempt, after 20 minutes";
  Turn({Done(commands_[0].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].deadline_us, now_us_ + 5 * 60 * int64_t{1000000}) << "it has no timeout of its own";
  Turn({Done(commands_[0].id)});
  Begin("N");
  EXPECT_EQ(commands_[0].deadline_us, now_us_ + 40 * 60 * int64_t{1000000}) << "of its node";
}

}  // namespace
}  // namespace docent::engine
