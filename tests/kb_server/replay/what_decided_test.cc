// What decided then decides in the replay: one case of each thing that a run goes by.
#include "graph/rdf/docent_iris.h"
#include "kb_server/door/workflow_removal.h"
#include "tests/kb_server/replay/replay_fixture.h"
#include "tests/kb_server/turn/simulated_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr char kXml[] =
    "xmlns:w=\"urn:w:\" xmlns:docent=\"https://w3id.org/docent#\" "
    "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"";

std::string Flow(const std::string& name, const std::string& nodes, const std::vector<std::string>& order) {
  std::string text = absl::StrCat("<CAWL name=\"", name, "\" ", kXml, "><flow name=\"", name,
                                  "\"><source name=\"s\"/>", nodes, "<sink name=\"t\"/>");
  std::string from = "s";
  for (const std::string& node : order) {
    absl::StrAppend(&text, "<link from=\"", from, "\" to=\"", node, "\"/>");
    from = node;
  }
  return absl::StrCat(text, "<link from=\"", from, "\" to=\"t\"/></flow></CAWL>");
}
std::string Rule(const std::string& constraint, const std::string& attributes = "") {
  return absl::StrCat("<context name=\"c\"><rule", attributes, ">", constraint, "</rule></context>");
}

class WhatDecided : public ReplayTest {
 protected:
  // The replay on the server, and that of the saved file.
  void ExpectTheSame(const std::string& run) {
    const auto replayed = Replay("", false, run);
    EXPECT_THAT(Differences(replayed), IsEmpty()) << run;
    ASSERT_TRUE(replayed.ok());
    EXPECT_THAT(replayed->play.notes, IsEmpty());
    EXPECT_EQ(replayed->play.course, replayed->recorded.course);
    const auto read = DecodeCase(EncodeCase(replayed->recorded), "a.run.json");
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_THAT(Differences(Test(*read)), IsEmpty()) << run;
  }
  absl::StatusOr<Replayed> Test(const RunCase& saved, const std::string& text = "") {
    Cancellation cancellation;
    PlayOptions options{&functions_, Limits(), ReplayLimits(), &cancellation};
    return ReplayCase(saved, text, "edited.cawl.xml", options);
  }
  // The robot of the first command.
  static std::string SentTo(const Course& course) {
    for (const Decision& decision : course.decisions) {
      if (decision.kind == Decision::Kind::kCommand) return decision.robot.value();
    }
    return "";
  }
  // The clock of the server, until it has nothing more to say.
  void Clock() {
    while (true) {
      WriteBatch told = ClockTells(now_us_ + kSecond, dictionary_, *queries_.Newest());
      if (told.operations.empty()) return;
      Turn(std::move(told));
    }
  }
};

TEST_F(WhatDecided, FactThatTheRunTookAway) {
  Deploy(
      Flow("S",
           absl::StrCat("<node name=\"N\"><condition>", Rule(When("w:job", "w:is", "w:Ready")),
                        "</condition><ext:withdraw source=\"any\">w:job w:is w:Ready</ext:withdraw></node>"),
           {"N"}));
  Turn(test::Start("S"));
  Tell("job", "is", "Ready");
  EXPECT_EQ(Replay("", false, "S-1")->recorded.course.state, "done");
  ExpectTheSame("S-1");
}

TEST_F(WhatDecided, DowntimeOverWhichTheRunWaited) {
  Deploy(Flow("L",
              absl::StrCat("<node name=\"N\"><condition ext:timeout=\"3s\">",
                           Rule("<constraint name=\"c\"><subject>w:it</subject><verb>w:blocked</verb>"
                                "<object>true</object></constraint>",
                                " expression=\"not c\""),
                           "</condition></node>"),
              {"N"}));
  WriteBatch blocked = test::Tell({Fact("it", "blocked", Term::Boolean(true))});
  blocked.lifetime_ms = 4000;
  Turn(std::move(blocked));
  Turn(test::Start("L"));
  Tick(6 * kSecond);  // the time-out and the end of the fact are noticed in one turn
  EXPECT_EQ(Replay("", false, "L-1")->recorded.course.state, "done");
  ExpectTheSame("L-1");
}

TEST_F(WhatDecided, RobotThatRestedTheLongest) {
  World();
  Robot("R2");
  Deploy(Flow("Go", "<node name=\"N\"><invoke operation=\"come\"/></node>", {"N"}));
  for (int i = 1; i <= 4; ++i) {
    Turn(test::Start("Go"));
    Answer("come");
  }
  for (int i = 1; i <= 4; ++i) ExpectTheSame(absl::StrCat("Go-", i));
}

TEST_F(WhatDecided, RobotOfATriedNodeAndOfASimulation) {
  World();
  Robot("R2");
  const std::string text = Flow("Go", "<node name=\"N\"><invoke operation=\"come\"/></node>", {"N"});
  Deploy(text);
  std::vector<std::string> robots;
  for (int i = 1; i <= 3; ++i) {
    const TurnResult started = Turn(test::Start("Go"));
    robots.push_back(started.record.commands.at(0).robot.value());
    Answer("come");
    const auto trial = TryNode("N", std::nullopt, "", absl::StrCat("Go-", i));
    ASSERT_TRUE(trial.ok()) << trial.status();
    EXPECT_EQ(SentTo(trial->play.course), robots.back()) << i;
  }
  EXPECT_THAT(robots, ElementsAre(Name("R1"), Name("R2"), Name("R1")));
  RunReplays replays(Ports());
  Cancellation cancellation;
  SimulationRequest request;
  request.text = text;
  request.name = "go.cawl.xml";
  request.lasting_us = 60 * kSecond;
  request.now_us = now_us_;
  const auto simulation = replays.Simulate(request, &cancellation);
  ASSERT_TRUE(simulation.ok()) << simulation.status();
  EXPECT_EQ(SentTo(simulation->play.course), Name("R2")) << "R1 was used last";
}

TEST_F(WhatDecided, UndeployedAndPausedWorkflowsOfItsSubflows) {
  const std::string waits =
      absl::StrCat("<node name=\"N\"><condition>", Rule(When("w:it", "w:go", "?v")), "</condition></node>");
  for (const char* how : {"pause", "", kRemovesStarts}) {
    Deploy(Flow("Sub", waits, {"N"}));
    Deploy(Flow("Par",
                absl::StrCat("<node name=\"S\"><invoke subflow=\"Sub\"/></node><node name=\"W\"><condition>",
                             Rule(When("w:b", "w:go", "?v")), "</condition></node>",
                             "<node name=\"T\"><invoke subflow=\"Sub\"/></node>"),
                {"S", "W", "T"}));
    const TurnResult started = Turn(test::Start("Par"));
    Tell("it", "go", "Now");
    WriteBatch batch;
    if (std::string(how) == "pause")
      batch.run_requests.push_back({RunRequest::Kind::kPauseWorkflow, "Sub", {}});
    else
      batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Sub", how});
    Turn(std::move(batch));
    Tell("b", "go", "Now");
    ExpectTheSame(started.started.at(0).value());
    Turn(test::Tell({}, {Fact("it", "go", "Now"), Fact("b", "go", "Now")}));
  }
}

TEST_F(WhatDecided, OtherRunsAndTheirStates) {
  World();
  Deploy(Flow("Watch",
              absl::StrCat("<node name=\"N\"><condition>",
                           Rule(When("?run", "docent:runState", "\"cancelled\"")), "</condition></node>"),
              {"N"}));
  Turn(test::Start("Watch"));
  Tell("John", "docent:chose", "Guide");
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "Guide-2", {}});
  Turn(std::move(cancel));
  EXPECT_EQ(Replay("", false, "Watch-1")->recorded.course.state, "done");
  ExpectTheSame("Watch-1");
}

// It takes the robot that another run had then: that one waits, and is answered later.
TEST_F(WhatDecided, AnotherRunWaitsForTheRobotOfAnEditedOne) {
  World();
  const auto text = [](const std::string& first) {
    return Flow("Go",
                absl::StrCat("<node name=\"A\"><condition>", Rule(When("w:it", "w:is", first)),
                             "</condition><invoke operation=\"come\"/></node><node name=\"B\">"
                             "<invoke operation=\"lead\"/></node>"),
                {"A", "B"});
  };
  Deploy(text("w:Late"));
  Deploy(Flow("Other", "<node name=\"N\"><invoke operation=\"bye\"/></node>", {"N"}));
  Turn(test::Start("Go"));
  Tell("it", "is", "Early");
  Turn(test::Start("Other"));
  Answer("bye");
  Tell("it", "is", "Late");
  Answer("come");
  Answer("lead");
  ExpectTheSame("Go-1");
  const auto edited = Replay(text("w:Early"), false, "Go-1");
  ASSERT_TRUE(edited.ok()) << edited.status();
  EXPECT_THAT(Differences(edited), Not(IsEmpty()));
  EXPECT_EQ(edited->play.course.state, "done") << edited->play.stopped;
}

TEST_F(WhatDecided, TimesOfDayThatOnlyTheEditedDocumentAsksFor) {
  const auto text = [](const std::string& time) {
    return Flow(
        "W",
        absl::StrCat("<node name=\"N\"><condition expression=\"c and now\">", Rule(When("w:it", "w:p", "?v")),
                     "<context name=\"now\">", time, "</context></condition></node>"),
        {"N"});
  };
  Deploy(Flow(
      "W",
      absl::StrCat("<node name=\"N\"><condition>", Rule(When("w:it", "w:p", "?v")), "</condition></node>"),
      {"N"}));
  Turn(test::Start("W"));
  Tell("it", "p", "One");
  const auto day = Replay(text("<ext:time between=\"00:00-24:00\"/>"), false, "W-1");
  EXPECT_THAT(Differences(day), IsEmpty());
  EXPECT_EQ(day->play.course.state, "done") << day->play.stopped;
  // 22:13:20 in UTC
  const auto never = Replay(text("<ext:time between=\"03:00-04:00\"/>"), false, "W-1");
  EXPECT_THAT(Differences(never), Not(IsEmpty()));
  EXPECT_THAT(never->nodes.front().waits_for, HasSubstr("timeHolds"));
  for (const char* time : {"<ext:time between=\"00:00-24:00\"/>", "<ext:time between=\"22:00-23:00\"/>"}) {
    const auto trial = TryNode("N", std::nullopt, text(time), "W-1");
    ASSERT_TRUE(trial.ok()) << trial.status();
    EXPECT_EQ(trial->play.course.state, "done") << time;
  }
}

TEST_F(WhatDecided, TimesOfDayThatWereAskedFor) {
  const std::string text =
      Flow("W",
           "<node name=\"A\"><condition><context><ext:time between=\"22:14-22:15\"/></context>"
           "</condition></node><node name=\"B\"><condition><context><ext:time after=\"10s\"/>"
           "</context></condition></node>",
           {"A", "B"});
  Deploy(text);
  Turn(test::Start("W"));
  Clock();
  now_us_ += 40 * kSecond;
  Clock();
  now_us_ += 12 * kSecond;
  Clock();
  Tick();
  EXPECT_EQ(Replay("", false, "W-1")->recorded.course.state, "done");
  ExpectTheSame("W-1");
  EXPECT_THAT(Differences(Replay(text + "<!-- the same -->", false, "W-1")), IsEmpty());
}

TEST_F(WhatDecided, TimesOfASimulation) {
  const auto simulate = [this](const std::string& nodes, const std::string& activator = "") {
    RunReplays replays(Ports());
    Cancellation cancellation;
    SimulationRequest request;
    request.text = absl::StrCat(
        "<CAWL name=\"D\" ", kXml, ">", activator, "<flow name=\"D\"><source name=\"s\"/>", nodes,
        "<sink name=\"t\"/><link from=\"s\" to=\"N\"/><link from=\"N\" to=\"t\"/></flow></CAWL>");
    request.name = "d.cawl.xml";
    request.lasting_us = 7200 * kSecond;
    request.now_us = now_us_;
    const auto simulation = replays.Simulate(request, &cancellation);
    EXPECT_TRUE(simulation.ok()) << simulation.status();
    const TimeMicros begin_us = simulation->world.turns.front().time_us;
    std::string last = absl::StrCat(simulation->play.course.state, " ",
                                    (simulation->play.course.decisions.back().time_us - begin_us) / kSecond);
    for (const std::string& note : simulation->play.notes) absl::StrAppend(&last, "; ", note);
    return last;
  };
  const auto node = [](const std::string& context) {
    return absl::StrCat("<node name=\"N\"><condition><context>", context, "</context></condition></node>");
  };
  Tell("it", "is", "Here");  // it is 22:13:21
  EXPECT_EQ(simulate(node("<ext:time at=\"22:16\"/>")), "done 159");
  EXPECT_EQ(simulate(node("<ext:time between=\"22:16-22:20\"/>")), "done 159");
  EXPECT_EQ(simulate(node("<ext:time between=\"22:00-22:20\"/>")), "done 0");
  EXPECT_EQ(
      simulate(node("<rule expression=\"not t\"><ext:time name=\"t\" between=\"22:00-22:20\"/></rule>")),
      "done 399");
  EXPECT_EQ(simulate(node("<ext:time after=\"20s\"/>")), "done 20");
  EXPECT_EQ(simulate("<node name=\"N\"/>",
                     "<activator name=\"A\"><activate flow=\"D\"/><condition><context>"
                     "<ext:time between=\"22:00-22:20\"/></context></condition></activator>"),
            "done 0")
      << "the activator fires";
}

// As the version before this one wrote it.
TEST_F(WhatDecided, FileOfTheFormatBefore) {
  const std::string text = R"({
 "format": "docent-saved-run", "formatVersion": 1,
 "run": {"id": "Go-3", "number": 3, "workflow": "Go", "flow": "Go", "startedBy": "request", "values": {}, "lastTurn": 12, "ended": true},
 "course": {"state": "done", "variables": {}, "results": {}, "decisions": [
  {"turn": 9, "time": "2026-01-31T12:00:00Z", "from": "", "to": "running", "cause": "asked for"},
  {"turn": 9, "time": "2026-01-31T12:00:00Z", "node": "N", "from": "inactive", "to": "waiting"},
  {"turn": 10, "time": "2026-01-31T12:00:05Z", "node": "N", "from": "waiting", "to": "running"},
  {"turn": 10, "time": "2026-01-31T12:00:05Z", "node": "N", "command": "Go-3/N/0/0.1/1/1@7", "operation": "come", "robot": "urn:w:R1", "values": {}},
  {"turn": 12, "time": "2026-01-31T12:00:09Z", "node": "N", "from": "running", "to": "done"},
  {"turn": 12, "time": "2026-01-31T12:00:09Z", "from": "running", "to": "done"}]},
 "turns": [
  {"turn": 9, "time": "2026-01-31T12:00:00Z"},
  {"turn": 10, "time": "2026-01-31T12:00:05Z", "add": ["<urn:w:it> <urn:w:is> <urn:w:Ready> <urn:w:g> ."]},
  {"turn": 12, "time": "2026-01-31T12:00:09Z", "reports": [{"command": "Go-3/N/0/0.1/1/1@7", "outcome": "succeeded", "progress": 1.0}]}],
 "held": {},
 "document": {"kind": "workflow", "name": "go.cawl.xml", "text": ["$TEXT"]},
 "documents": [],
 "facts": [
  "<urn:w:R1> <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> <https://w3id.org/docent#Robot> <urn:w:R1> .",
  "<urn:w:R1> <https://w3id.org/docent#incarnation> \"i1\" <urn:w:R1> .",
  "<urn:w:R1> <https://w3id.org/docent#offers> <urn:docent:operation:come> <urn:w:R1> .",
  "<urn:w:R1> <https://w3id.org/docent#status> <https://w3id.org/docent#Standby> <urn:w:R1> ."]
})";
  const std::string document =
      Flow("Go",
           absl::StrCat("<node name=\"N\"><condition>", Rule(When("w:it", "w:is", "w:Ready")),
                        "</condition><invoke operation=\"come\"/></node>"),
           {"N"});
  const auto read =
      DecodeCase(absl::StrReplaceAll(text, {{"$TEXT", absl::StrReplaceAll(document, {{"\"", "\\\""}})}}),
                 "old.run.json");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(Differences(Test(*read)), IsEmpty());
  EXPECT_THAT(Differences(Test(*read, absl::StrReplaceAll(document, {{"w:Ready", "w:Done"}}))),
              Not(IsEmpty()));
}

}  // namespace
}  // namespace docent::server::test
