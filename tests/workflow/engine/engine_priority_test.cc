// Priorities of runs, and pre-emption at step borders.
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

class EnginePriorityTest : public EngineTest {
 protected:
  // Flows Low, Mid and High, each with the node A, after which Low has B.
  void DeployFlows(const std::string& high, const std::string& low_operation = "drive") {
    const auto flow = [](const std::string& name, const std::string& attributes, const std::string& nodes,
                         const std::string& links) {
      return "<flow name=\"" + name + "\" " + attributes + "><source name=\"s\"/>" + nodes +
             "<sink name=\"t\"/>" + links + "</flow>";
    };
    const std::string a = Node("A", "", "<invoke operation=\"drive\"/>");
    const std::string one = Link("s", "A") + Link("A", "t");
    Deploy(flow("Low", "",
                Node("A", "", "<invoke operation=\"" + low_operation + "\"/>") +
                    Node("B", "", "<invoke operation=\"drive\"/>"),
                Link("s", "A") + Link("A", "B") + Link("B", "t")) +
           flow("Mid", "", a, one) + flow("High", high, a, one));
  }
  void PutTrip() {
    rsel::ParsedRsel parsed = rsel::ParseRsel(
        "<rsel name=\"S\"><process name=\"trip\"><invoke operation=\"go\"/><invoke "
        "operation=\"back\"/></process></rsel>",
        "s.xml");
    ASSERT_TRUE(parsed.ok());
    ASSERT_FALSE(HasErrors(engine_.PutServices(parsed.document)));
  }
  void StartFlow(const std::string& flow) { Turn({}, {{RunRequest::Kind::kStart, "W/" + flow, {}}}); }
  // The commands of the turn, as "RUN/NODE operation".
  std::vector<std::string> Sent() const {
    std::vector<std::string> sent;
    for (const RobotCommand& command : commands_) {
      const std::string& id = command.id.value();
      sent.push_back(id.substr(0, id.find('/', id.find('/') + 1)) + " " + command.operation);
    }
    return sent;
  }
  CommandId Only() const {
    EXPECT_EQ(commands_.size(), 1u);
    return commands_.empty() ? CommandId() : commands_[0].id;
  }
  std::string Holder(Engine* engine) const {
    const RunId* holder = engine->HolderOf(RobotId("urn:r1"));
    return holder == nullptr ? "" : holder->value();
  }
  using Commands = std::vector<std::string>;
};

TEST_F(EnginePriorityTest, AFreedRobotGoesToTheMostUrgentRunAndThenToTheOldest) {
  DeployFlows("ext:priority=\"10\"");
  StartFlow("Mid");
  const CommandId first = Only();
  StartFlow("Mid");
  StartFlow("High");
  Turn({Done(first)});
  EXPECT_EQ(Sent(), Commands{"High-3/A drive"});
  Turn({Done(Only())});
  EXPECT_EQ(Sent(), Commands{"Mid-2/A drive"});
}

TEST_F(EnginePriorityTest, AMoreUrgentRunTakesTheRobotBetweenTwoStepsOfAService) {
  PutTrip();
  DeployFlows("ext:priority=\"10\" ext:preempt=\"true\"", "trip");
  StartFlow("Low");
  const CommandId go = Only();
  EXPECT_EQ(Sent(), Commands{"Low-1/A go"});
  StartFlow("High");
  EXPECT_EQ(Sent(), Commands{}) << "not in the middle of a step";
  Turn({Done(go)});
  EXPECT_EQ(Sent(), Commands{"High-2/A drive"});
  EXPECT_EQ(Holder(&engine_), "High-2");
  EXPECT_TRUE(Fact("urn:docent:run:Low-1/A/0", "reason").starts_with("pre-empted")) << "and says so";
  Turn({Done(Only())});
  EXPECT_EQ(Sent(), Commands{"Low-1/A back"}) << "the step that is done is not done again";
  EXPECT_EQ(Holder(&engine_), "Low-1");
  EXPECT_EQ(Fact("urn:docent:run:Low-1/A/0", "reason"), "");
  Turn({Done(Only())});
  EXPECT_EQ(Sent(), Commands{"Low-1/B drive"});
}

TEST_F(EnginePriorityTest, AStepThatGoesOutNoLongerSaysWhatItWaitedFor) {
  PutTrip();
  DeployFlows("", "trip");
  StartFlow("Low");
  const CommandId go = Only();
  robots_.offers[0].out_of_service = "is charging";
  Turn({Done(go)});
  EXPECT_EQ(Sent(), Commands{});
  EXPECT_NE(Fact("urn:docent:run:Low-1/A/0", "reason"), "");
  robots_.offers[0].out_of_service = "";
  Turn();
  EXPECT_EQ(Sent(), Commands{"Low-1/A back"});
  EXPECT_EQ(Fact("urn:docent:run:Low-1/A/0", "reason"), "");
}

TEST_F(EnginePriorityTest, AMoreUrgentRunTakesTheRobotBetweenTwoNodes) {
  DeployFlows("ext:priority=\"10\" ext:preempt=\"true\"");
  StartFlow("Low");
  const CommandId a = Only();
  StartFlow("High");
  Turn({Done(a)});
  EXPECT_EQ(Sent(), Commands{"High-2/A drive"});
  EXPECT_TRUE(Says("Low-1 running>running")) << "the timeline has who took it";
  Turn({Done(Only())});
  EXPECT_EQ(Sent(), Commands{"Low-1/B drive"});
  Turn({Done(Only())});
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_EQ(Holder(&engine_), "");
}

TEST_F(EnginePriorityTest, WithoutPreemptOrPriorityNothingIsTaken) {
  for (const char* high :
       {"ext:priority=\"10\"", "ext:preempt=\"true\"", "ext:priority=\"-1\" ext:preempt=\"true\""}) {
    DeployFlows(high);
    StartFlow("Low");
    const CommandId a = Only();
    StartFlow("High");
    Turn({Done(a)});
    ASSERT_EQ(commands_.size(), 1u);
    EXPECT_TRUE(Sent()[0].starts_with("Low")) << high;
    Turn({Done(Only())});
    Turn({Done(Only())});
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(EnginePriorityTest, ARobotThatStillEndsACommandIsNotTaken) {
  DeployFlows("ext:priority=\"10\" ext:preempt=\"true\"");
  StartFlow("Low");
  const CommandId a = Only();
  StartFlow("High");
  Turn({}, {{RunRequest::Kind::kCancel, "Low-1", {}}});
  EXPECT_EQ(Sent(), Commands{}) << "it brakes";
  Turn({{a, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_EQ(Sent(), Commands{"High-2/A drive"});
}

TEST_F(EnginePriorityTest, ARunThatIsPreemptedMayBeCancelled) {
  PutTrip();
  DeployFlows("ext:priority=\"10\" ext:preempt=\"true\"", "trip");
  StartFlow("Low");
  const CommandId go = Only();
  StartFlow("High");
  Turn({Done(go)});
  const CommandId high = Only();
  Turn({}, {{RunRequest::Kind::kCancel, "Low-1", {}}});
  EXPECT_EQ(Holder(&engine_), "High-2");
  Turn({Done(high)});
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_EQ(Holder(&engine_), "");
}

TEST_F(EnginePriorityTest, ASnapshotKeepsWhoIsPreempted) {
  PutTrip();
  DeployFlows("ext:priority=\"10\" ext:preempt=\"true\"", "trip");
  StartFlow("Low");
  const CommandId go = Only();
  StartFlow("High");
  Turn({Done(go)});
  const CommandId high = Only();
  Restart();
  EXPECT_EQ(Holder(&engine_), "High-2");
  Turn({Done(high)});
  EXPECT_EQ(Sent(), Commands{"Low-1/A back"});
}

// The run is paused, and its robot taken in the turn in which the attempt that failed has ended. Until the next one it takes no
// place in the queue, and counts as no work for the robot.
TEST_F(EnginePriorityTest, APreemptedInvocationThatIsTriedAgainLaterDoesNotWaitMeanwhile) {
  PutTrip();
  DeployFlows("ext:priority=\"10\" ext:preempt=\"true\"", "trip\" ext:retry=\"1\" ext:retry-delay=\"30s");
  StartFlow("Low");
  const CommandId go = Only();
  now_us_ += (Limits{}.default_step_timeout_ms - 1000) * int64_t{1000};
  StartFlow("High");
  now_us_ += 1'000'000;
  Turn();
  EXPECT_EQ(cancels_, std::vector<CommandId>{go});
  Turn({}, {{RunRequest::Kind::kPause, "Low-1", {}}});
  Turn({{go, CommandReport::Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_EQ(Sent(), Commands{"High-2/A drive"});
  ASSERT_TRUE(Says("Low-1/A/0 running>pending"));
  EXPECT_EQ(Fact("urn:r1", "load"), "1");
}

class PreemptingConditionTest : public EnginePriorityTest {
 protected:
  // High's node A is opened by a condition that names the robot; Low's B has the condition `low`.
  void DeployFlows(const std::string& low) {
    Deploy("<flow name=\"Low\"><source name=\"s\"/>" + Node("A", "", "<invoke operation=\"drive\"/>") +
           Node("B", low, "<invoke operation=\"drive\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
           Link("A", "B") + Link("B", "t") +
           "</flow><flow name=\"High\" ext:priority=\"1000\" ext:preempt=\"true\"><source name=\"s\"/>"
           "<node name=\"A\"><condition><context name=\"c\"><rule><constraint><subject>?robot</subject>"
           "<verb>&lt;urn:near&gt;</verb><object>?o</object></constraint></rule></context></condition>"
           "<invoke operation=\"drive\"/></node><sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t") + "</flow>");
  }
  void BeNear() {
    conditions_.Set("urn:near", {{{"robot", Term::Iri("urn:r1")}, {"o", Term::Iri("urn:x")}}});
  }
};

TEST_F(PreemptingConditionTest, TheRobotThatItNamesIsTakenAtTheNextBorder) {
  DeployFlows("");
  BeNear();
  StartFlow("Low");
  const CommandId a = Only();
  StartFlow("High");
  EXPECT_EQ(Sent(), Commands{});
  Turn({Done(a)});
  EXPECT_EQ(Sent(), Commands{"High-2/A drive"});
}

TEST_F(PreemptingConditionTest, ARobotThatIsHeldBetweenTwoNodesIsTakenAtOnce) {
  DeployFlows("far");
  BeNear();
  StartFlow("Low");
  Turn({Done(Only())});
  EXPECT_EQ(Holder(&engine_), "Low-1");
  StartFlow("High");
  EXPECT_EQ(Sent(), Commands{"High-2/A drive"});
}

TEST_F(PreemptingConditionTest, TheVeryFirstRunWithTheHighestPriorityIsFoundToo) {
  DeployFlows("");
  StartFlow("High");
  StartFlow("Low");
  const CommandId a = Only();
  BeNear();
  Turn();
  EXPECT_EQ(Sent(), Commands{});
  Turn({Done(a)});
  EXPECT_EQ(Sent(), Commands{"High-1/A drive"});
}

TEST_F(EnginePriorityTest, OnlyTheRobotThatIsWantedIsTaken) {
  robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
  Deploy("<flow name=\"Low\"><source name=\"s\"/>" + Node("A", "", "<invoke operation=\"drive\"/>") +
         Node("B", "far", "<invoke operation=\"drive\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
         Link("A", "B") + Link("B", "t") +
         "</flow><flow name=\"High\" ext:priority=\"10\" ext:preempt=\"true\"><variable name=\"robot\"/>"
         "<source name=\"s\"/>" +
         Node("A", "", "<invoke operation=\"drive\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
         Link("A", "t") + "</flow>");
  StartFlow("Low");
  const CommandId first = Only();
  StartFlow("Low");
  const CommandId second = Only();
  Turn({Done(first), Done(second)});
  robots_.news = false;  // or all that are held are looked at
  Turn({}, {{RunRequest::Kind::kStart, "W/High", {{"robot", Term::Iri("urn:r2")}}}});
  EXPECT_EQ(Sent(), Commands{"High-3/A drive"});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].robot, RobotId("urn:r2"));
  EXPECT_EQ(Holder(&engine_), "Low-1");
}

}  // namespace
}  // namespace docent::engine
