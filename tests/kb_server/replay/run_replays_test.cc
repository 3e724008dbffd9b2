#include "kb_server/replay/run_replays.h"

#include "tests/kb_server/replay/replay_fixture.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

TEST_F(ReplayTest, TheDocumentThatRanDoesTheSame) {
  World();
  Visit();
  EXPECT_THAT(Differences(Replay()), IsEmpty());
  const auto replayed = Replay();
  EXPECT_EQ(replayed->recorded.course.state, "done");
  EXPECT_EQ(replayed->play.course.state, "done");
  EXPECT_THAT(replayed->play.notes, IsEmpty());
  EXPECT_EQ(replayed->play.stopped, "");
}

TEST_F(ReplayTest, AnotherGuardOpensAtAnotherTurn) {
  World();
  Visit();
  // John says that he is ready in no turn: the node waits, and what it waits for is told
  const auto never =
      Replay(Edited("<verb>docent:selected</verb><object>?booth</object>",
                    "<verb>docent:selected</verb><object>?booth</object></constraint>"
                    "<constraint><subject>$user</subject><verb>w:is</verb><object>w:ready</object>"));
  const std::vector<std::string> differences = Differences(never);
  ASSERT_FALSE(differences.empty());
  EXPECT_THAT(differences[0], StartsWith("Lead not reached 6: opened in turn 6 | still waiting"));
  EXPECT_THAT(never->nodes[0].waits_for, HasSubstr("ready"));
  EXPECT_THAT(never->nodes[0].missing, HasSubstr("ready"));
  EXPECT_THAT(never->play.stopped, HasSubstr("the recorded facts end with turn"));
  for (const NodeComparison& node : never->nodes) EXPECT_EQ(node.node == "Come", node.same()) << node.node;
}

TEST_F(ReplayTest, ALaterGuardIsAnsweredAfterTheRecordedTimes) {
  World();
  Tell("John", "docent:chose", "Guide");
  Answer("come");
  Tell("John", "docent:selected", "B03");  // turn 6
  Tell("John", "docent:feels", "docent:Glad");
  Answer("lead");  // turn 8, two turns later
  Answer("bye");
  const auto later = Replay(
      Edited("<verb>docent:selected</verb><object>?booth</object>",
             "<verb>docent:selected</verb><object>?booth</object></constraint>"
             "<constraint><subject>$user</subject><verb>docent:feels</verb><object>docent:Glad</object>"));
  const std::vector<std::string> differences = Differences(later);
  ASSERT_FALSE(differences.empty());
  EXPECT_THAT(differences[0], StartsWith("Lead turn 6: opened in turn 6 | opened in turn 7"));
  EXPECT_EQ(later->play.course.state, "done");
}

TEST_F(ReplayTest, AnotherValueIsNamedAndAnsweredByTheReportOfTheSameStep) {
  World();
  Visit();
  const auto replayed =
      Replay(Edited("<invoke operation=\"lead\"/>",
                    "<ext:assign variable=\"booth\" expression=\"w:B09\"/><invoke operation=\"lead\"/>"));
  const std::vector<std::string> differences = Differences(replayed);
  ASSERT_FALSE(differences.empty());
  EXPECT_THAT(absl::StrJoin(differences, "\n"), HasSubstr("B03"));
  EXPECT_THAT(absl::StrJoin(differences, "\n"), HasSubstr("B09"));
  EXPECT_EQ(replayed->play.course.state, "done");
}

TEST_F(ReplayTest, ACommandThatWasNeverSentEndsTheReplayUnlessItIsTakenAsDone) {
  World();
  Visit();
  const std::string edited = Edited("<invoke operation=\"lead\"/>", "<invoke operation=\"come\"/>");
  const auto stopped = Replay(edited);
  ASSERT_TRUE(stopped.ok()) << stopped.status();
  EXPECT_THAT(stopped->play.stopped, HasSubstr("there is no recorded report of come("));
  EXPECT_EQ(stopped->play.stopped_node, "Lead");
  EXPECT_EQ(stopped->play.stopped_turn, 6u);
  EXPECT_EQ(stopped->nodes[0].node, "Lead");
  EXPECT_EQ(stopped->nodes[0].differences[0].kind, "command");
  const auto taken = Replay(edited, true);
  ASSERT_TRUE(taken.ok()) << taken.status();
  EXPECT_EQ(taken->play.course.state, "done");
  EXPECT_THAT(absl::StrJoin(taken->play.notes, "\n"), HasSubstr("is taken to have succeeded at once"));
}

TEST_F(ReplayTest, AnActivatorThatDoesNotFireIsTheFirstDifference) {
  World();
  Visit();
  const auto replayed = Replay(Edited("<object>w:Guide</object>", "<object>w:Tour</object>"));
  ASSERT_TRUE(replayed.ok()) << replayed.status();
  EXPECT_EQ(replayed->nodes[0].node, kActivator);
  EXPECT_THAT(replayed->nodes[0].differences[0].replayed, HasSubstr("does not fire for user=<urn:w:John>"));
  EXPECT_THAT(replayed->nodes[0].missing, HasSubstr("Tour"));
}

TEST_F(ReplayTest, AnEarlierTimeoutFailsTheNodeBetweenTheRecordedTurns) {
  World();
  Tell("John", "docent:chose", "Guide");
  Answer("come");
  now_us_ += 20 * kSecond;
  Tell("John", "docent:selected", "B03");
  Answer("lead");
  Answer("bye");
  EXPECT_THAT(Differences(Replay()), IsEmpty());
  const std::vector<std::string> differences = Differences(Replay(Edited("60s", "5s")));
  ASSERT_FALSE(differences.empty());
  EXPECT_THAT(differences[0], StartsWith("Lead state 5: opened in turn 6 | failed in turn 5"));
}

TEST_F(ReplayTest, ATimeoutThatWasRecordedComesWithItsTurn) {
  World();
  Tell("John", "docent:chose", "Guide");
  Answer("come");
  Tick(60 * kSecond);
  EXPECT_THAT(Differences(Replay()), IsEmpty());
  EXPECT_EQ(Replay()->play.course.state, "failed");
}

TEST_F(ReplayTest, ARobotThatAnotherRunHeldIsHeldInTheReplay) {
  World();
  Turn(test::Tell(
      {Fact("Eve", "docent:isAt", "Hall"), Fact("Eve", "docent:chose", "Guide")}));  // Guide-1 takes R1
  Answer("come");
  const CommandId none;
  Tell("John", "docent:chose", "Guide");  // Guide-2 waits
  Tell("Eve", "docent:selected", "B01");
  Answer("lead");
  Answer("bye");  // R1 is free: Guide-2 takes it
  Answer("come");
  Tell("John", "docent:selected", "B03");
  Answer("lead");
  Answer("bye");
  EXPECT_THAT(Differences(Replay("", false, "Guide-2")), IsEmpty());
  EXPECT_THAT(Differences(Replay("", false, "Guide-1")), IsEmpty());
  EXPECT_EQ(Replay("", false, "Guide-2")->play.course.state, "done");
}

TEST_F(ReplayTest, AnotherRobotIsNamed) {
  World();
  Robot("R2");
  Visit();
  const auto other =
      Replay(Edited("<invoke operation=\"come\"/>",
                    "<ext:assign variable=\"robot\" expression=\"w:R2\"/><invoke operation=\"come\"/>"));
  EXPECT_THAT(absl::StrJoin(Differences(other), "\n"), HasSubstr("Come robot"));
}

TEST_F(ReplayTest, WhatAnOperatorDidIsDoneAgain) {
  World();
  Tell("John", "docent:chose", "Guide");
  Answer("come");
  WriteBatch pause;
  pause.run_requests.push_back({RunRequest::Kind::kPause, "Guide-1", {}});
  Turn(pause);
  Tell("John", "docent:selected", "B03");
  WriteBatch resume;
  resume.run_requests.push_back({RunRequest::Kind::kResume, "Guide-1", {}});
  Turn(resume);  // turn 8 opens Lead
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "Guide-1", {}});
  Turn(cancel);
  EXPECT_THAT(Differences(Replay()), IsEmpty());
  EXPECT_EQ(Replay()->play.course.state, "cancelled");
}

TEST_F(ReplayTest, ARunThatWasAskedForIsAskedForAgain) {
  World();
  Turn(Start("Guide", {{"user", Iri("John")}}));
  Answer("come");
  const auto replayed = Replay();
  EXPECT_THAT(Differences(replayed), IsEmpty());
  EXPECT_TRUE(replayed->recorded.asked);
  EXPECT_FALSE(replayed->recorded.ended);
  EXPECT_EQ(replayed->play.course.state, "running");
}

TEST_F(ReplayTest, BadRequestsSayWhatIsWrong) {
  World();
  Visit();
  EXPECT_THAT(Replay("", false, "Guide-7").status().message(),
              HasSubstr("there is no run \"Guide-7\", or no longer"));
  EXPECT_EQ(Replay("", false, "Guide-7").status().code(), absl::StatusCode::kNotFound);
  const auto broken = Replay(Edited("<verb>docent:selected</verb>", "<verb>nothing:selected</verb>"));
  EXPECT_EQ(broken.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(broken.status().message(), HasSubstr("edited.cawl.xml:"));
  EXPECT_THAT(Replay(Edited("name=\"Guide\" version", "name=\"Tour\" version")).status().message(),
              HasSubstr("the document is of workflow Tour, and run Guide-1 is of Guide"));
  RunReplays::Ports ports = Ports();
  ports.replay_limits.replay_turns = 3;
  RunReplays replays(ports);
  Cancellation cancellation;
  EXPECT_THAT(replays.Replay(RunId("Guide-1"), "", "", false, &cancellation).status().message(),
              HasSubstr("replay_turns is 3"));
  ports.replay_limits = ReplayLimits();
  ports.replay_limits.replay_facts = 3;
  RunReplays few(ports);
  EXPECT_THAT(few.Replay(RunId("Guide-1"), "", "", false, &cancellation).status().message(),
              HasSubstr("replay_facts"));
  Cancellation over;
  over.Cancel();
  EXPECT_EQ(few.Replay(RunId("Guide-1"), "", "", false, &over).status().code(), absl::StatusCode::kCancelled);
}

TEST_F(ReplayTest, OneNodeIsTriedOnTheFactsOfItsTurn) {
  World();
  Visit();
  auto trial = TryNode("Lead");
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->moment.last_turn, 6u);
  std::vector<std::string> sent;
  for (const Decision& decision : trial->play.course.decisions) {
    if (decision.kind == Decision::Kind::kCommand) sent.push_back(Describe(decision));
  }
  EXPECT_THAT(sent, ElementsAre(StartsWith("sent lead(")));
  EXPECT_EQ(trial->play.course.variables.at("booth"), Iri("B03"));
  // a turn before, John had not selected
  trial = TryNode("Lead", 5);
  ASSERT_TRUE(trial.ok()) << trial.status();
  ASSERT_EQ(trial->play.waits.size(), 1u);
  EXPECT_THAT(trial->play.waits[0].missing, HasSubstr("selected"));
  EXPECT_THAT(TryNode("Laed").status().message(), HasSubstr("did you mean Lead?"));
  EXPECT_EQ(TryNode("Lead", 2).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(TryNode("Lead", 700).status().code(), absl::StatusCode::kOutOfRange);
}

// It did not open: the event had left the graph, or stood before the node waited.
TEST_F(ReplayTest, ANodeThatWaitsForAnEventOpensOnTheFactsOfItsTurn) {
  World();
  Deploy(
      "<CAWL name=\"Ev\" xmlns:w=\"urn:w:\"><flow name=\"Ev\"><variable name=\"user\"/><source name=\"s\"/>"
      "<node name=\"Confirm\"><condition expression=\"ok and here\"><case name=\"ok\"><event "
      "operation=\"confirmed\"/></case><context name=\"here\"><rule>" +
      When("?ring", "w:by", "?user") + When("?user", "docent:isAt", "w:Hall") +
      "</rule></context></condition></node><sink name=\"e\"/><link from=\"s\" to=\"Confirm\"/>"
      "<link from=\"Confirm\" to=\"e\"/></flow></CAWL>");
  Turn(test::Start("Ev"));
  Turn(
      test::Tell({Fact("ring", "a", "docent:Event"),
                  Fact("ring", "docent:operation", Term::Literal("confirmed")), Fact("ring", "by", "John")}));
  const uint64_t opened = head_;
  for (int i = 0; i < 3; ++i) Tick(kSecond);
  auto trial = TryNode("Confirm", std::nullopt, "", "Ev-1");
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->moment.last_turn, opened);
  EXPECT_EQ(trial->play.course.state, "done") << trial->play.stopped;
  trial = TryNode("Confirm", opened - 1, "", "Ev-1");
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->play.course.state, "running");
  trial = TryNode("Confirm", opened, "", "Ev-1");
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->play.course.state, "done") << trial->play.stopped;
}

TEST_F(ReplayTest, ASavedRunIsTheSameRun) {
  World();
  Visit();
  const auto replayed = Replay();
  ASSERT_TRUE(replayed.ok());
  const std::string text = EncodeCase(replayed->recorded);
  const auto read = DecodeCase(text, "a.run.json");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(EncodeCase(*read), text);
  EXPECT_EQ(read->course, replayed->recorded.course);
  EXPECT_EQ(read->turns, replayed->recorded.turns);
  Cancellation cancellation;
  PlayOptions options;
  options.functions = &functions_;
  options.cancellation = &cancellation;
  EXPECT_THAT(Differences(ReplayCase(*read, "", "", options)), IsEmpty());
  EXPECT_THAT(Differences(ReplayCase(*read, Edited("w:saw $booth", "w:saw w:Nothing"), "e.xml", options)),
              Not(IsEmpty()));
}

// A service was always the one of then.
TEST_F(ReplayTest, AnEditedServiceIsTriedInPlaceOfTheOneOfThen) {
  const auto services = [](const std::string& operation) {
    return "<rsel name=\"Greetings\"><process name=\"greet\"><invoke operation=\"" + operation +
           "\"/></process></rsel>";
  };
  World();
  Turn(Put(Document::Kind::kRsel, "g.rsel.xml", services("come")));
  Deploy(
      "<CAWL name=\"Guide\"><flow name=\"Guide\"><source name=\"s\"/><node name=\"Hi\"><invoke "
      "operation=\"greet\"/></node><sink name=\"e\"/><link from=\"s\" to=\"Hi\"/><link from=\"Hi\" "
      "to=\"e\"/></flow></CAWL>");
  Turn(test::Start("Guide"));
  Answer("come");
  const auto recorded = Replay();
  ASSERT_TRUE(recorded.ok()) << recorded.status();
  EXPECT_TRUE(IsSame(recorded->nodes));
  Cancellation cancellation;
  PlayOptions options{&functions_, Limits(), ReplayLimits(), &cancellation, false};
  const auto with = [&](const std::string& text) {
    return ReplayCase(recorded->recorded, "", "", options,
                      {{Document::Kind::kRsel, Document::Action::kPut, "edited.rsel.xml", text, nullptr}});
  };
  const auto edited = with(services("bye"));
  ASSERT_TRUE(edited.ok()) << edited.status();
  EXPECT_FALSE(IsSame(edited->nodes));
  EXPECT_THAT(edited->play.stopped, HasSubstr("there is no recorded report of bye("));
  EXPECT_THAT(edited->play.notes, IsEmpty());
  const auto same = with(services("come"));
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_TRUE(IsSame(same->nodes));
  EXPECT_THAT(with("<rsel").status().message(), HasSubstr("edited.rsel.xml:1:"));
}

TEST_F(ReplayTest, ADamagedSavedRunIsRefusedWithItsPlace) {
  World();
  Visit();
  const std::string text = EncodeCase(Replay()->recorded);
  const auto wrong = [&](const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    const auto read = DecodeCase(absl::StrReplaceAll(text, {{from, to}}), "a.run.json");
    EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << from;
    return std::string(read.status().message());
  };
  EXPECT_THAT(DecodeCase(text.substr(0, text.size() / 2), "a.run.json").status().message(),
              HasSubstr("a.run.json is no saved run, or damaged"));
  EXPECT_THAT(DecodeCase("{}", "a.run.json").status().message(), HasSubstr("has no \"format\""));
  EXPECT_THAT(DecodeCase("[]", "a.run.json").status().message(), HasSubstr("has no \"format\""));
  EXPECT_THAT(wrong("\"formatVersion\": 2", "\"formatVersion\": 3"),
              HasSubstr("is of format version 3, and this program reads up to 2"));
  EXPECT_THAT(wrong("\"succeeded\"", "\"sucseeded\""),
              HasSubstr("outcome is \"sucseeded\", which means nothing here"));
  EXPECT_THAT(wrong("\"flow\"", "\"flaw\""), HasSubstr("run.flow is missing"));
  EXPECT_THAT(wrong("+ <urn:w:John> <https://w3id.org/docent#selected>", "+ <urn:w:John> nothing"),
              HasSubstr("facts has no fact in N-Quads at ["));
  EXPECT_THAT(wrong("+ <urn:w:John> <https://w3id.org/docent#selected>", "<urn:w:John> <urn:w:x>"),
              HasSubstr("begins neither with \"+ \" nor with \"- \""));
  EXPECT_THAT(wrong("\"state\": [\n  \"", "\"state\": [\n  \"x"), HasSubstr("state is no packed state"));
  EXPECT_THAT(wrong("\"turn\": 6", "\"turn\": \"six\""), HasSubstr("is no whole number"));
  EXPECT_THAT(wrong("\"turn\": 6", "\"turn\": 2"), HasSubstr("does not come after the turn before it"));
  ReplayLimits few;
  few.replay_turns = 2;
  EXPECT_THAT(DecodeCase(text, "a.run.json", few).status().message(), HasSubstr("the limit is replay_turns"));
  few = ReplayLimits();
  few.saved_run_bytes = 10;
  EXPECT_THAT(DecodeCase(text, "a.run.json", few).status().message(), HasSubstr("saved_run_bytes is 10"));
}

TEST_F(ReplayTest, ASubFlowThatIsTriedAgainIsOfItsNode) {
  Turn(Put(Document::Kind::kCawl, "t.cawl.xml",
           R"(<CAWL name="T" xmlns:ext="https://w3id.org/docent/cawl-ext#"><flow name="T"><source name="s"/>
<node name="N"><invoke subflow="Q" ext:retry="1" ext:retry-delay="2s"/></node><sink name="e"/>
<link from="s" to="N"/><link from="N" to="e"/></flow>
<flow name="Q"><source name="b"/><node name="W"><ext:fail reason="x"/></node><sink name="f"/>
<link from="b" to="W"/><link from="W" to="f"/></flow></CAWL>)"));
  Turn(test::Start("T"));
  Tick(2 * kSecond);
  const auto replayed = Replay("", false, "T-1");
  EXPECT_THAT(Differences(replayed), IsEmpty());
  std::vector<std::string> nodes;
  for (const NodeComparison& node : replayed->nodes) nodes.push_back(node.node);
  EXPECT_THAT(nodes, UnorderedElementsAre("", "N", "N/W", "N#2", "N#2/W"));
}

TEST_F(ReplayTest, ANodeThatIsTriedWaitsForItsTimeAndNotForARobot) {
  Turn(Put(Document::Kind::kCawl, "t.cawl.xml",
           R"(<CAWL name="T" xmlns:ext="https://w3id.org/docent/cawl-ext#"><flow name="T"><source name="s"/>
<node name="N"><condition><context name="c"><ext:time after="2h"/></context></condition></node><sink name="e"/>
<link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>)"));
  Turn(test::Start("T"));
  const auto trial = TryNode("N", std::nullopt, "", "T-1");
  ASSERT_TRUE(trial.ok()) << trial.status();
  ASSERT_EQ(trial->play.waits.size(), 1u);
  EXPECT_THAT(trial->play.waits[0].missing,
              HasSubstr("nothing but time: its condition holds, and may open it from"));
}

}  // namespace
}  // namespace docent::server::test
