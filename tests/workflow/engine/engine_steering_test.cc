// Pause and resume of runs and workflows; robots taken out of service; variables of live runs set.
#include <string>
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
using ::testing::Not;
using Kind = RunRequest::Kind;

class EngineSteeringTest : public EngineTest {
 protected:
  using Outcome = CommandReport::Outcome;

  static std::string Chain(const std::string& first, const std::string& second) {
    return Flow(first + second + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "B") + Link("B", "t"));
  }
  static std::string TwoNodes() {
    return Chain(Node("A", "", "<invoke operation=\"a\"/>"), Node("B", "", "<invoke operation=\"b\"/>"));
  }
  void Ask(Kind kind, const std::string& target, bool cancels_commands = false) {
    RunRequest request;
    request.kind = kind;
    request.target = target;
    request.reason = "why";
    request.cancels_commands = cancels_commands;
    ASSERT_TRUE(engine_.CheckRequest(request).ok()) << engine_.CheckRequest(request);
    Turn({}, {request});
  }
  absl::Status Check(Kind kind, const std::string& target) {
    RunRequest request;
    request.kind = kind;
    request.target = target;
    return engine_.CheckRequest(request);
  }
  absl::Status Set(const std::string& name, const Term& value) {
    RunRequest request;
    request.kind = Kind::kSetVariable;
    request.target = "F-1";
    request.arguments = {{name, value}};
    absl::Status status = engine_.CheckRequest(request);
    if (status.ok()) Turn({}, {request});
    return status;
  }
  void Pass(int seconds) { now_us_ += seconds * int64_t{1000000}; }
  std::string Run(const std::string& predicate) const { return Fact("urn:docent:run:F-1", predicate); }
  std::string State(const std::string& node) const { return Fact("urn:docent:run:F-1/" + node, "nodeState"); }
  static CommandReport Report(const CommandId& id, Outcome outcome) { return {id, outcome, "", 0, "i1", {}}; }
};

TEST_F(EngineSteeringTest, APausedRunLetsItsCommandEndAndOpensNoNode) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  EXPECT_THAT(cancels_, IsEmpty());
  EXPECT_NE(Run("pausedAt"), "");
  EXPECT_EQ(Run("pauseReason"), "why");
  Turn({Done(first)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(State("A"), "done");
  EXPECT_EQ(State("B"), "waiting");
  Ask(Kind::kResume, "F-1");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "b");
  EXPECT_EQ(Run("pausedAt"), "");
}

TEST_F(EngineSteeringTest, APausedRunTakesNoRobotThatBecomesFree) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Start();  // F-2 waits for the robot
  Start();  // F-3, too
  Ask(Kind::kPause, "F-2");
  Turn({Done(first)});
  Turn({Done(commands_[0].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("F-3/A"));
}

TEST_F(EngineSteeringTest, APauseIsAskedForTwiceAndAResumeOfWhatIsNotPausedChangesNothing) {
  Deploy(TwoNodes());
  Start();
  Ask(Kind::kPause, "F-1");
  Ask(Kind::kPause, "F-1");
  EXPECT_THAT(transitions_, IsEmpty());
  Ask(Kind::kResume, "F-1");
  EXPECT_TRUE(Says("F-1 paused>running"));
  Ask(Kind::kResume, "F-1");
  EXPECT_THAT(transitions_, IsEmpty());
  EXPECT_EQ(Check(Kind::kPause, "F-9").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Check(Kind::kResume, "F-9").code(), absl::StatusCode::kNotFound);
}

TEST_F(EngineSteeringTest, TimesOfWaitingStandStillDuringAPause) {
  std::string node = Node("A", "near", "<invoke operation=\"a\"/>");
  node.replace(node.find("<condition>"), 11, "<condition ext:timeout=\"10s\">");
  Deploy(Chain(node, Node("B", "", "")));
  Start();
  Pass(4);
  Ask(Kind::kPause, "F-1");
  EXPECT_FALSE(engine_.NextDeadline().has_value());
  Pass(1000);
  Turn();
  EXPECT_EQ(Run("runState"), "running");
  Ask(Kind::kResume, "F-1");
  Pass(5);
  Turn();
  EXPECT_EQ(Run("runState"), "running");
  Pass(1);
  Turn();
  EXPECT_EQ(Run("runState"), "failed");
}

TEST_F(EngineSteeringTest, TheTimeOfACommandUnderWayGoesOnDuringAPause) {
  Deploy(Chain("<node name=\"A\"><invoke operation=\"a\" ext:timeout=\"10s\"/></node>", Node("B", "", "")));
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  ASSERT_TRUE(engine_.NextDeadline().has_value());
  Pass(10);
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(first));
}

TEST_F(EngineSteeringTest, ACommandThatAPauseCancelsBeginsAgainIfItIsIdempotent) {
  robots_.offers = {{RobotId("urn:r1"), "i1", true, false}};
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1", true);
  EXPECT_THAT(cancels_, ElementsAre(first));
  Turn({Report(first, Outcome::kCancelled)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(State("A"), "running");
  Pass(1000);
  Ask(Kind::kResume, "F-1");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "a");
  EXPECT_NE(commands_[0].id, first);
  EXPECT_GT(commands_[0].deadline_us, now_us_) << "with a time of its own";
}

TEST_F(EngineSteeringTest, ACommandThatIsToStopSaysSoUntilItsRobotConfirmsIt) {
  for (const bool paused : {true, false}) {
    robots_.offers = {{RobotId("urn:r1"), "i1", true, false}};
    Deploy(TwoNodes());
    Start();
    const std::string invocation = absl::StrCat("urn:docent:run:F-", paused ? 1 : 2, "/A/0");
    Ask(paused ? Kind::kPause : Kind::kCancelCommands, paused ? "F-1" : "urn:r1", true);
    const CommandId stopped = cancels_[0];
    const char* why = paused ? "its run was paused" : "its robot was taken out of service";
    EXPECT_EQ(Fact(invocation, "reason"),
              absl::StrCat("asked to stop, and its robot has not yet confirmed it: ", why));
    CommandReport away = Report(stopped, Outcome::kUnreachable);
    away.message = "no answer";
    Turn({away});
    EXPECT_THAT(Fact(invocation, "reason"), HasSubstr(absl::StrCat(why, "; no answer")));
    Turn({Report(stopped, Outcome::kProgress)});
    EXPECT_THAT(Fact(invocation, "reason"), HasSubstr("not yet confirmed"));
    Turn({Report(stopped, Outcome::kCancelled)});
    EXPECT_THAT(Fact(invocation, "reason"), Not(HasSubstr("not yet confirmed")));
    if (paused) Ask(Kind::kCancel, "F-1");
  }
}

TEST_F(EngineSteeringTest, ACommandThatAPauseCancelsAndMustNotBeginAgainIsAskedAbout) {
  Deploy(TwoNodes());
  Start();
  Ask(Kind::kPause, "F-1", true);
  Turn({Report(cancels_[0], Outcome::kCancelled)});
  EXPECT_EQ(State("A"), "incident");
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "reason"), HasSubstr("not idempotent"));
  Ask(Kind::kResume, "F-1");
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(Run("runState"), "running");
}

TEST_F(EngineSteeringTest, ACommandThatSucceedsThoughItWasToStopIsDone) {
  Deploy(TwoNodes());
  Start();
  Ask(Kind::kPause, "F-1", true);
  Turn({Done(cancels_[0])});
  EXPECT_EQ(State("A"), "done");
}

TEST_F(EngineSteeringTest, SubflowsPauseWithTheirParent) {
  Deploy(Flow(Node("A", "", "<invoke subflow=\"G\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         Node("C", "", "<invoke operation=\"c\"/>") + "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "C") +
         Link("C", "t") + "</flow>");
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  Turn({Done(first)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(Check(Kind::kResume, "G-2").code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(Check(Kind::kResume, "G-2").message()), HasSubstr("F-1"));
  Ask(Kind::kPause, "G-2");
  Ask(Kind::kResume, "F-1");
  EXPECT_THAT(commands_, IsEmpty()) << "its own pause stays";
  Ask(Kind::kResume, "G-2");
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineSteeringTest, APauseOutlivesARestart) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1", true);
  Ask(Kind::kPauseWorkflow, "W");
  Restart();
  EXPECT_EQ(Check(Kind::kStart, "W/F").code(), absl::StatusCode::kFailedPrecondition);
  Turn({Report(first, Outcome::kCancelled)});
  EXPECT_EQ(State("A"), "incident");
}

TEST_F(EngineSteeringTest, APausedRunCanBeCancelled) {
  Deploy(TwoNodes());
  Start();
  Ask(Kind::kPause, "F-1");
  Ask(Kind::kCancel, "F-1");
  EXPECT_EQ(Run("runState"), "cancelled");
  EXPECT_THAT(Run("reason"), HasSubstr("why"));
  EXPECT_EQ(Run("pausedAt"), "");
}

TEST_F(EngineSteeringTest, AnEventDuringAPauseOpensItsNodeWhenTheRunGoesOn) {
  std::string near = Condition("near");
  near.replace(
      near.find("<condition>"), 11,
      "<condition expression=\"rang and near\"><case name=\"rang\"><event operation=\"bell\"/></case>");
  Deploy(Chain("<node name=\"A\">" + near + "<invoke operation=\"a\"/></node>", Node("B", "", "")));
  conditions_.Set("bell", {});
  Start();
  Ask(Kind::kPause, "F-1");
  conditions_.Set("bell",
                  {{{"s", Term::Iri("urn:j")}, {"o", Term::Iri("urn:o")}, {"_event_1", Term::Iri("urn:e")}}});
  Turn();
  EXPECT_EQ(State("A"), "waiting");
  Ask(Kind::kResume, "F-1");
  EXPECT_EQ(State("A"), "running");
}

TEST_F(EngineSteeringTest, WhatHasToHoldFallsDuringAPauseAndTheCommandIsCancelled) {
  conditions_.Set("urn:safe", {{}});
  Deploy(Chain("<node name=\"A\" ext:while-holds=\"?r &lt;urn:safe&gt; ?z\"><invoke operation=\"a\"/></node>",
               Node("B", "", "")));
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  conditions_.Set("urn:safe", {});
  Turn();
  EXPECT_EQ(cancels_.size(), 1u) << first.value();
  Turn({{first, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_EQ(State("A"), "waiting");
  conditions_.Set("urn:safe", {{}});
  Turn();
  EXPECT_THAT(commands_, IsEmpty());
}

TEST_F(EngineSteeringTest, APausedWorkflowPausesItsRunsAndStartsNone) {
  const std::string activator =
      "<activator name=\"On\"><activate flow=\"F\"/>" + Condition("rise") + "</activator>";
  Deploy(activator + TwoNodes());
  Start();
  Ask(Kind::kPauseWorkflow, "W");
  EXPECT_NE(Run("pausedAt"), "");
  EXPECT_NE(Fact("urn:docent:workflow:W", "pausedAt"), "");
  EXPECT_EQ(Check(Kind::kStart, "W").code(), absl::StatusCode::kFailedPrecondition);
  const TermBinding one = {{"s", Term::Iri("urn:1")}, {"o", Term::Iri("urn:o")}},
                    two = {{"s", Term::Iri("urn:2")}, {"o", Term::Iri("urn:o")}};
  conditions_.Set("urn:rise", {one, two});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 1u);
  conditions_.Set("urn:rise", {two});  // the first gave up
  Turn();
  Restart();
  Ask(Kind::kResumeWorkflow, "W");
  EXPECT_EQ(engine_.live_runs(), 2u);
  EXPECT_EQ(Run("pausedAt"), "");
  EXPECT_EQ(Fact("urn:docent:workflow:W", "pausedAt"), "");
  Ask(Kind::kPauseWorkflow, "W");
  Ask(Kind::kResumeWorkflow, "W");
  EXPECT_EQ(engine_.live_runs(), 2u) << "it started its run before";
}

TEST_F(EngineSteeringTest, AVariableIsSetWhileANodeWithoutAConditionWaitsForTheResume) {
  Deploy("<variable name=\"user\"/>" + TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  Turn({Done(first)});
  ASSERT_EQ(State("B"), "waiting");
  ASSERT_TRUE(Set("user", Term::Iri("urn:john")).ok());
  Ask(Kind::kResume, "F-1");
  EXPECT_EQ(State("B"), "running");
}

TEST_F(EngineSteeringTest, RunsOfAPausedWorkflowThatIsUndeployedStayPausedAndCanBeResumed) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPauseWorkflow, "W");
  EXPECT_TRUE(engine_.Undeploy("W"));
  Turn();
  EXPECT_EQ(Fact("urn:docent:workflow:W", "pausedAt"), "");
  Turn({Done(first)});
  EXPECT_THAT(commands_, IsEmpty());
  Ask(Kind::kResumeWorkflow, "W");
  EXPECT_EQ(commands_.size(), 1u);
  Deploy(TwoNodes());
  EXPECT_TRUE(Check(Kind::kStart, "W").ok());
}

TEST_F(EngineSteeringTest, ARobotThatIsTakenOutOfServiceEndsItsCommandAndGetsNoFurther) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  robots_.offers[0].out_of_service = "is out of service: a wheel";
  Turn({Done(first)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(Fact("urn:docent:run:F-1/B/0", "reason"), HasSubstr("a wheel"));
  robots_.offers[0].out_of_service = "";
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineSteeringTest, CommandsOfARobotTakenOutOfServiceAreCancelledAndRetriedElsewhere) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i2", false, false}};
  Deploy(Chain("<node name=\"A\"><invoke operation=\"a\" ext:retry=\"1\"/></node>", Node("B", "", "")));
  Start();
  ASSERT_EQ(commands_[0].robot.value(), "urn:r1");
  robots_.offers[0].out_of_service = "is out of service: a wheel";
  Ask(Kind::kCancelCommands, "urn:r1");
  ASSERT_EQ(cancels_.size(), 1u);
  Turn({Report(cancels_[0], Outcome::kCancelled)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot.value(), "urn:r2");
}

TEST_F(EngineSteeringTest, ACancelledCommandWaitsForItsRobotWithoutARetry) {
  robots_.offers = {{RobotId("urn:r1"), "i1", true, false}};
  Deploy(TwoNodes());
  Start();
  robots_.offers[0].out_of_service = "is out of service: a wheel";
  Ask(Kind::kCancelCommands, "urn:r1");
  Turn({Report(cancels_[0], Outcome::kCancelled)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(transitions_, ::testing::Contains("F-1/A/0 1/1 a running>cancelled"));
  EXPECT_EQ(State("A"), "running");
  robots_.offers[0].out_of_service = "";
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineSteeringTest, ACommandThatWasOverdueWhenItWasStoppedIsAsGoodAsNewWhenItIsSentAgain) {
  robots_.offers = {{RobotId("urn:r1"), "i1", true, false}};
  const rsel::ParsedRsel parsed = rsel::ParseRsel(
      "<rsel name=\"S\" xmlns:ext=\"https://w3id.org/docent/rsel-ext#\"><process name=\"P\"><invoke "
      "operation=\"a\" "
      "ext:timeout=\"10s\" ext:retry=\"1\"/></process></rsel>",
      "s.rsel.xml");
  ASSERT_TRUE(parsed.ok());
  EXPECT_THAT(engine_.PutServices(parsed.document), IsEmpty());
  Deploy(Chain(Node("A", "", "<invoke operation=\"P\"/>"), Node("B", "", "<invoke operation=\"b\"/>")));
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1", true);
  now_us_ = *engine_.NextDeadline();
  Turn();
  Turn({Report(first, Outcome::kCancelled)});
  Ask(Kind::kResume, "F-1");
  ASSERT_EQ(commands_.size(), 1u);
  const RobotCommand again = commands_[0];
  EXPECT_GT(again.deadline_us, now_us_);
  Turn({Report(again.id, Outcome::kUnknown)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_TRUE(commands_[0].id.value().starts_with(again.id.value()))
      << "it is sent again, and no other attempt begins";
}

// What was decided of a command is told its proxy again after a restart, until its end is known.
TEST_F(EngineSteeringTest, AStopSurvivesARestart) {
  const CommandUnderWay going_on = {}, stopped = {{}, true, true}, recalled = {{}, false, true};
  const auto open = [this] {
    std::vector<CommandUnderWay> commands = engine_.OpenCommands();
    EXPECT_EQ(commands.size(), 1u);
    commands.at(0).command = {};
    return commands.at(0);
  };
  Deploy(TwoNodes());
  Start();
  EXPECT_EQ(open(), going_on);
  Ask(Kind::kPause, "F-1");
  Restart();
  EXPECT_EQ(open(), recalled);
  Ask(Kind::kPause, "F-1", true);
  Restart();
  EXPECT_EQ(open(), stopped);
  Ask(Kind::kResume, "F-1");
  Restart();
  EXPECT_EQ(open(), stopped) << "it has yet to hear it";
}

TEST_F(EngineSteeringTest, ARobotsStopSurvivesARestart) {
  Deploy(TwoNodes());
  Start();
  robots_.offers[0].out_of_service = "is out of service: a wheel";
  Turn();
  Restart();
  EXPECT_TRUE(engine_.OpenCommands().at(0).recalled);
  EXPECT_FALSE(engine_.OpenCommands().at(0).ending);
  Ask(Kind::kCancelCommands, "urn:r1");
  Restart();
  EXPECT_TRUE(engine_.OpenCommands().at(0).ending);
}

// The robot was out of reach.
TEST_F(EngineSteeringTest, WhatARobotHasNotBegunIsCalledBackByAPauseAndSentAgainAfterIt) {
  Deploy(TwoNodes());  // not idempotent
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  EXPECT_THAT(recalls_, ElementsAre(first));
  EXPECT_THAT(cancels_, IsEmpty());
  Turn({Report(first, Outcome::kNotBegun)});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_EQ(State("A"), "running");
  EXPECT_THAT(Fact("urn:docent:run:F-1/A/0", "reason"), HasSubstr("not begun: its run was paused"));
  Pass(1000);
  Turn();
  Restart();
  robots_.offers[0].incarnation = "i2";
  Ask(Kind::kResume, "F-1");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_NE(commands_[0].id, first);
  EXPECT_EQ(commands_[0].expected_incarnation, "i2");
  EXPECT_GT(commands_[0].deadline_us, now_us_) << "with a time of its own";
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(State("A"), "done");
}

// The adapter came back as another one meanwhile, and describes the operation otherwise.
TEST_F(EngineSteeringTest, WhatIsSentAgainIsMeantForTheAdapterThatLivesThen) {
  Deploy(TwoNodes());
  for (const bool paused : {true, false}) {
    for (const bool began : {false, true}) {
      robots_.offers[0] = {RobotId("urn:r1"), "i1", began, false};
      Start();
      const RobotCommand first = commands_.at(0);
      const std::string run = first.id.value().substr(0, first.id.value().find('/'));
      if (!paused) robots_.offers[0].out_of_service = "is out of service: a wheel";
      paused ? Ask(Kind::kPause, run, began) : Turn();
      if (began && !paused) Ask(Kind::kCancelCommands, "urn:r1");
      Turn({Report(first.id, began ? Outcome::kCancelled : Outcome::kNotBegun)});
      robots_.offers[0].incarnation = "i2";
      robots_.offers[0].idempotent = !began;
      robots_.offers[0].occupies = {"base"};
      Turn();
      robots_.offers[0].out_of_service = "";
      paused ? Ask(Kind::kResume, run) : Turn();
      ASSERT_EQ(commands_.size(), 1u) << paused << began;
      EXPECT_EQ(commands_[0].expected_incarnation, "i2") << paused << began;
      EXPECT_EQ(commands_[0].idempotent, !began) << "as it is described now";
      Turn({Done(commands_[0].id)});
      ASSERT_EQ(commands_.size(), 1u) << "the next step";
      EXPECT_EQ(commands_[0].expected_incarnation, "i2");
      Turn({Done(commands_[0].id)});
      EXPECT_EQ(engine_.live_runs(), 0u);
    }
  }
}

TEST_F(EngineSteeringTest, WhatIsSentAgainIsOfTheTypeThatTheRobotTakesThen) {
  Deploy(Flow("<variable name=\"n\"/>" + Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  robots_.offers[0].inputs = {"n"};
  Turn({}, {{Kind::kStart, "W/F", {{"n", Term::Literal("many")}}}});
  ASSERT_EQ(commands_.size(), 1u);
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  Turn({Report(first, Outcome::kNotBegun)});
  robots_.offers[0].input_types = {{"n", "http://www.w3.org/2001/XMLSchema#integer"}};
  Ask(Kind::kResume, "F-1");
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_THAT(Run("reason"), HasSubstr("cannot take"));
}

// Its adapter stood still, and read the command after the pause: it was cancelled then.
TEST_F(EngineSteeringTest, WhatIsCalledBackAndBeginsAllTheSameIsSentAgainOrAnIncident) {
  Deploy(TwoNodes());
  Start();
  Ask(Kind::kPause, "F-1");
  Turn({Report(recalls_[0], Outcome::kCancelled)});
  EXPECT_EQ(State("A"), "incident") << "it may have done something";
  robots_.offers[0].idempotent = true;
  Start();
  Ask(Kind::kPause, "F-2");
  Turn({Report(recalls_[0], Outcome::kCancelled)});
  Ask(Kind::kResume, "F-2");
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineSteeringTest, WhatWasCancelledBeforeItBeganIsNoIncident) {
  Deploy(TwoNodes());  // not idempotent
  Start();
  Ask(Kind::kPause, "F-1", true);
  Turn({Report(cancels_[0], Outcome::kNotBegun)});
  EXPECT_EQ(State("A"), "running");
  Ask(Kind::kResume, "F-1");
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineSteeringTest, WhatARobotHasNotBegunIsCalledBackWhenItTakesNoCommandsAnyMore) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  robots_.offers[0].out_of_service = "is out of service: a wheel";
  Turn();
  EXPECT_THAT(recalls_, ElementsAre(first));
  Turn();
  EXPECT_THAT(recalls_, IsEmpty()) << "once";
  Turn({Report(first, Outcome::kNotBegun)});
  EXPECT_THAT(commands_, IsEmpty());
  robots_.offers[0].out_of_service = "";
  Turn();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineSteeringTest, WhatARobotHadBegunWhenItWasCalledBackIsDoneOnce) {
  Deploy(TwoNodes());
  Start();
  const CommandId first = commands_[0].id;
  Ask(Kind::kPause, "F-1");
  Ask(Kind::kResume, "F-1");
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(first)});
  EXPECT_EQ(State("A"), "done");
}

TEST_F(EngineSteeringTest, ANodeWaitsWithAVariablesNewValueFromTheTurnThatSetsIt) {
  std::string near = Condition("near");
  near.replace(near.find("?s</subject>"), 12, "$user</subject>");
  Deploy(
      Flow("<variable name=\"user\" type=\"docent:Person\"/><variable name=\"times\" type=\"xsd:integer\"/>"
           "<node name=\"A\">" +
           near + "<invoke operation=\"a\"/></node><sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Turn({}, {{Kind::kStart, "W/F", {{"user", Term::Iri("urn:john")}}}});
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "waitsFor"), HasSubstr("urn:john"));
  ASSERT_TRUE(Set("user", Term::Iri("urn:mary")).ok());
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "waitsFor"), HasSubstr("urn:mary"));
  EXPECT_EQ(Fact("urn:docent:run:F-1/$user", "variableValue"), "urn:mary");
  EXPECT_THAT(std::string(Set("user", Term::Literal("mary")).message()),
              HasSubstr("is of type docent:Person"));
  EXPECT_THAT(std::string(Set("times", Term::Literal("two")).message()), HasSubstr("xsd:integer"));
  EXPECT_THAT(std::string(Set("usr", Term::Iri("urn:mary")).message()), HasSubstr("did you mean user?"));
  EXPECT_TRUE(Set("times", Term::Integer(2)).ok());
}

}  // namespace
}  // namespace docent::engine
