// What becomes of the firings of an activator: ext:mode and ext:max.
#include "gmock/gmock.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "tests/kb_server/turn/turn_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ActivatorModesTest : public test::TurnTest {
 protected:
  void SetUp() override { Turn(test::WorldFacts()); }

  // A run waits in its node until its visitor is glad, unless `node` is another one.
  static std::string Text(const std::string& mode, const std::string& variables = "<variable name=\"user\"/>",
                          const std::string& node = "") {
    return absl::StrCat(
        R"(<CAWL name="Call" xmlns:docent="https://w3id.org/docent#" xmlns:w="urn:w:"
              xmlns:ext="https://w3id.org/docent/cawl-ext#">
           <activator name="OnCall" )",
        mode, ">", variables, R"(<activate flow="Come"/>
             <condition><context name="c"><rule name="r"><constraint name="k">
               <subject>?user</subject><verb>w:calls</verb><object>?what</object>
             </constraint></rule></context></condition></activator>
           <flow name="Come"><variable name="user"/><source name="s"/>)",
        node.empty() ? R"(<node name="N"><condition expression="glad and d">
               <case name="glad"><event operation="glad"/></case>
               <context name="d"><rule name="r"><constraint name="k">
                 <subject>?event</subject><verb>w:of</verb><object>$user</object>
               </constraint></rule></context></condition></node>)"
                     : node,
        R"(<sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>)");
  }
  void Deploy(const std::string& text) { Turn(Put(Document::Kind::kCawl, "call.cawl.xml", text)); }
  TurnResult Call(const std::string& who, const std::string& what) {
    return Turn(Tell({Fact(who, "calls", what)}));
  }
  // The runs of `who` that are live end; not those that start with that.
  TurnResult Glad(const std::string& who) {
    return Turn(Tell({Fact("glad", "a", "docent:Event"),
                      Fact("glad", "docent:operation", Term::Literal("glad")), Fact("glad", "of", who)}));
  }
  static std::vector<std::string> Said(const TurnResult& result, const std::string& to) {
    std::vector<std::string> causes;
    for (const Transition& t : result.record.transitions) {
      if (t.subject == "activator/Call" && t.to == to) causes.push_back(t.cause);
    }
    return causes;
  }
  static std::vector<std::string> Ended(const TurnResult& result, const std::string& state) {
    std::vector<std::string> runs;
    for (const Transition& t : result.record.transitions) {
      if (t.from == "running" && t.to == state && t.subject.find('/') == std::string::npos)
        runs.push_back(t.subject);
    }
    return runs;
  }
  // The object of a fact about the workflow in the graph of runs; empty: none.
  std::string Told(const std::string& property) const {
    return GraphReader(dictionary_, stages_->writer.current())
        .Object(WorkflowIri("Call"), DocentIri(property));
  }
};

TEST_F(ActivatorModesTest, WithoutAModeEachBindingStartsARun) {
  Deploy(Text(""));
  EXPECT_THAT(Started(Call("John", "a")), SizeIs(1));
  EXPECT_THAT(Started(Call("John", "b")), IsEmpty()) << "the key has started its run and still holds";
  Turn(Tell({}, {Fact("John", "calls", "a"), Fact("John", "calls", "b")}));
  EXPECT_THAT(Started(Call("John", "c")), SizeIs(1)) << "though the run before it is live";
}

TEST_F(ActivatorModesTest, SingleIgnoresWhatFiresWhileTheKeyHasARun) {
  Deploy(Text("ext:mode=\"single\""));
  EXPECT_THAT(Started(Call("John", "a")), ElementsAre("Come-1"));
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  const TurnResult again = Call("John", "b");
  EXPECT_THAT(Started(again), IsEmpty());
  EXPECT_THAT(Said(again, "ignored"), ElementsAre(HasSubstr("Come-1 of the same key is live")));
  EXPECT_EQ(Told("ignoredFirings"), "1");
  EXPECT_THAT(Started(Call("Ann", "a")), SizeIs(1)) << "another key";
  Restart();
  Turn(Tell({}, {Fact("John", "calls", "b")}));
  EXPECT_THAT(Said(Call("John", "c"), "ignored"), SizeIs(1)) << "the run counts after a restart";
  EXPECT_EQ(Told("ignoredFirings"), "2");
  EXPECT_THAT(Started(Glad("John")), IsEmpty()) << "what was ignored is not made up for";
  Turn(Tell({}, {Fact("John", "calls", "c")}));
  EXPECT_THAT(Started(Call("John", "d")), SizeIs(1));
}

TEST_F(ActivatorModesTest, QueuedRunsOneAfterTheOther) {
  Deploy(Text("ext:mode=\"queued\" ext:max=\"2\"", "<variable name=\"user\"/>"));
  Call("John", "a");
  for (const char* what : {"b", "c", "d"}) {
    Turn(Tell({}, {Fact("John", "calls", "a"), Fact("John", "calls", "b"), Fact("John", "calls", "c")}));
    const TurnResult again = Call("John", what);
    EXPECT_THAT(Started(again), IsEmpty());
    EXPECT_THAT(Said(again, what[0] == 'd' ? "ignored" : "queued"), SizeIs(1)) << what;
  }
  EXPECT_EQ(Told("waitingFirings"), "2");
  EXPECT_EQ(Told("ignoredFirings"), "1");
  EXPECT_THAT(Started(Call("Ann", "a")), SizeIs(1)) << "another key does not wait";
  Restart();
  EXPECT_THAT(Started(Glad("John")), SizeIs(1));
  EXPECT_EQ(Told("waitingFirings"), "1");
  EXPECT_THAT(Started(Glad("John")), SizeIs(1));
  EXPECT_EQ(Told("waitingFirings"), "");
  EXPECT_THAT(Started(Glad("John")), IsEmpty());
}

TEST_F(ActivatorModesTest, AQueueOfRunsThatTakeNoTimeIsDoneInOneTurn) {
  Deploy(Text("ext:mode=\"queued\"", "<variable name=\"none\"/>"));
  WriteBatch both = Tell({Fact("John", "calls", "a"), Fact("Ann", "calls", "a")});
  Turn(both);
  Deploy(Text("ext:mode=\"queued\"", "", "<node name=\"N\"/>"));
  EXPECT_THAT(Started(Turn(Tell({Fact("Bob", "calls", "a"), Fact("Cid", "calls", "b")}))), SizeIs(2));
}

TEST_F(ActivatorModesTest, WhatWaitsRunsWithTheValuesOfItsMatch) {
  Deploy(Text("ext:mode=\"queued\"", "<variable name=\"user\"/>"));
  Call("John", "a");
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  Call("John", "b");
  Turn(Tell({}, {Fact("John", "calls", "b")}));  // it is queued, and has ceased to hold
  EXPECT_THAT(Started(Glad("John")), SizeIs(1));
  const auto value = dictionary_.FindIri(DocentIri("variableValue")), b = dictionary_.FindIri("urn:w:b");
  EXPECT_EQ(stages_->writer.current().Count({{}, *value, *b, {}}), 1u);
}

TEST_F(ActivatorModesTest, RestartCancelsTheRunAndItsRobotIsFreeWithTheFinalReport) {
  Deploy(Text("ext:mode=\"restart\"", "<variable name=\"user\"/>",
              "<node name=\"N\"><invoke operation=\"greet\"/></node>"));
  const TurnResult first = Call("John", "a");
  ASSERT_THAT(first.record.commands, SizeIs(1));
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  const TurnResult second = Call("John", "b");
  EXPECT_THAT(Ended(second, "cancelled"), ElementsAre("Come-1"));
  EXPECT_THAT(second.cancels, ElementsAre(first.record.commands[0].id));
  EXPECT_THAT(Started(second), ElementsAre("Come-2"));
  EXPECT_THAT(second.record.commands, IsEmpty()) << "the robot still ends what it did";
  Restart();
  const TurnResult ended =
      Turn(test::Report(first.record.commands[0].id, CommandReport::Outcome::kCancelled));
  ASSERT_THAT(ended.record.commands, SizeIs(1));
  EXPECT_THAT(ended.record.commands[0].id.value(), HasSubstr("Come-2/"));
}

TEST_F(ActivatorModesTest, ParallelStartsUpToMax) {
  Deploy(Text("ext:max=\"2\"", "<variable name=\"user\"/>"));
  Call("John", "a");
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  EXPECT_THAT(Started(Call("John", "b")), SizeIs(1));
  Turn(Tell({}, {Fact("John", "calls", "b")}));
  EXPECT_THAT(Said(Call("John", "c"), "ignored"),
              ElementsAre(HasSubstr("2 runs of the same key are live (ext:max)")));
}

TEST_F(ActivatorModesTest, EventsOfOneKeyAreCountedTogether) {
  std::string text = Text("ext:mode=\"single\"", "");
  const size_t from = text.find("<context name=\"c\">");
  text.replace(from, text.find("</context>", from) + 10 - from, "<case><event operation=\"bell\"/></case>");
  Deploy(text);
  const auto ring = [this](const char* event) {
    return Turn(
        Tell({Fact(event, "a", "docent:Event"), Fact(event, "docent:operation", Term::Literal("bell"))}));
  };
  EXPECT_THAT(Started(ring("r1")), SizeIs(1));
  EXPECT_THAT(Said(ring("r2"), "ignored"), SizeIs(1));
  EXPECT_THAT(Said(ring("r2"), "ignored"), SizeIs(1)) << "the same again";
  EXPECT_EQ(Told("ignoredFirings"), "2");
}

TEST_F(ActivatorModesTest, FiringsThatWaitAreBounded) {
  std::string text = Text("ext:mode=\"queued\"", "");
  const size_t from = text.find("<context name=\"c\">");
  text.replace(from, text.find("</context>", from) + 10 - from, "<case><event operation=\"bell\"/></case>");
  Deploy(text);
  std::vector<TermQuad> rings;
  for (size_t i = 0; i < kWorkflowLimits.firings_waiting + 2; ++i) {
    rings.push_back(Fact(absl::StrCat("r", i), "a", "docent:Event"));
    rings.push_back(Fact(absl::StrCat("r", i), "docent:operation", Term::Literal("bell")));
  }
  const TurnResult result = Turn(Tell(rings));
  EXPECT_THAT(Started(result), SizeIs(1));
  EXPECT_THAT(Said(result, "ignored"), ElementsAre(HasSubstr("firings_waiting")));
  EXPECT_EQ(Told("waitingFirings"), absl::StrCat(kWorkflowLimits.firings_waiting));
}

TEST_F(ActivatorModesTest, AnotherModeOfTheDocumentCountsTheSameRuns) {
  Deploy(Text(""));
  Call("John", "a");
  Deploy(Text("ext:mode=\"single\""));
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  EXPECT_THAT(Said(Call("John", "b"), "ignored"), SizeIs(1));
  Deploy(Text("ext:mode=\"queued\""));
  Turn(Tell({}, {Fact("John", "calls", "b")}));
  EXPECT_THAT(Said(Call("John", "c"), "queued"), SizeIs(1));
}

WriteBatch Act(const std::string& what) {
  WriteBatch batch;
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Call", what});
  return batch;
}

TEST_F(ActivatorModesTest, UndeployDropsWhatWaitsAndCancelsRunsWhereAsked) {
  Deploy(Text("ext:mode=\"queued\"", "<variable name=\"user\"/>",
              "<node name=\"N\"><invoke operation=\"greet\"/></node>"));
  const TurnResult first = Call("John", "a");
  ASSERT_THAT(first.record.commands, SizeIs(1));
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  Call("John", "b");
  EXPECT_EQ(Told("waitingFirings"), "1");
  const TurnResult gone = Turn(Act(kRemovesRuns));
  EXPECT_THAT(Ended(gone, "cancelled"), ElementsAre("Come-1"));
  EXPECT_THAT(gone.undeployed, ElementsAre(RunId("Come-1")));
  EXPECT_EQ(Told("waitingFirings"), "");
  EXPECT_NE(stages_->engine.HolderOf(RobotId("urn:w:R1")), nullptr) << "it still brakes";
  Restart();
  Turn(test::Report(first.record.commands[0].id, CommandReport::Outcome::kCancelled));
  EXPECT_EQ(stages_->engine.HolderOf(RobotId("urn:w:R1")), nullptr);
}

TEST_F(ActivatorModesTest, RunsThatOutliveTheirWorkflowCountWhenItIsDeployedAgain) {
  Deploy(Text("ext:mode=\"single\""));
  Call("John", "a");
  EXPECT_THAT(Ended(Turn(Act("")), "cancelled"), IsEmpty());
  Restart();
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  Deploy(Text("ext:mode=\"single\""));
  EXPECT_THAT(Said(Call("John", "b"), "ignored"), SizeIs(1));
  Glad("John");
  Turn(Tell({}, {Fact("John", "calls", "b")}));
  EXPECT_THAT(Started(Call("John", "c")), SizeIs(1));
}

TEST_F(ActivatorModesTest, ADisabledWorkflowStartsNoRunAndMakesUpForWhatStillHolds) {
  Deploy(Text(""));
  Call("John", "a");
  Turn(Act(kRemovesStarts));
  EXPECT_THAT(Started(Call("Ann", "a")), IsEmpty());
  Call("Bob", "a");
  Turn(Tell({}, {Fact("Bob", "calls", "a")}));
  Restart();
  WriteBatch start = test::Start("Call");
  start.time_us = now_us_ += 1000;
  EXPECT_THAT(std::string(RunTurn(stages_.get(), start, head_ + 1).status().message()),
              HasSubstr("is disabled"));
  Deploy(Text("", "<variable name=\"user\"/>", "<node name=\"N\"/>"));
  EXPECT_FALSE(stages_->engine.IsEnabled("Call")) << "also with another text";
  EXPECT_THAT(Started(Turn(Act(kRemovesDisablement))), SizeIs(1)) << "Ann's; Bob has left, John has run";
  EXPECT_THAT(Started(Turn(Act(kRemovesDisablement))), IsEmpty());
}

// The bell rings while the workflow is paused or disabled.
class BellTest : public ActivatorModesTest {
 protected:
  static std::string Bell(const std::string& mode, const std::string& node = "<node name=\"N\"/>") {
    return absl::StrCat(
        R"(<CAWL name="Call" xmlns:w="urn:w:" xmlns:ext="https://w3id.org/docent/cawl-ext#">
           <activator name="OnCall" )",
        mode,
        R"(><variable name="user"/><activate flow="Come"/><condition expression="rang and by"><case name="rang"><event operation="ring"/></case>
             <context name="by"><rule><constraint><subject>?event</subject><verb>w:by</verb><object>?user</object></constraint></rule>
             </context></condition></activator>
           <flow name="Come"><variable name="user"/><source name="s"/>)",
        node, R"(<sink name="e"/><link from="s" to="N"/><link from="N" to="e"/></flow></CAWL>)");
  }
  TurnResult Ring(const std::string& who) {
    const std::string event = absl::StrCat("ring", ++rings_);
    const TurnResult rang = Turn(Tell({Fact(event, "a", "docent:Event"), Fact(event, "by", who),
                                       Fact(event, "docent:operation", Term::Literal("ring"))}));
    Tick();
    return rang;
  }
  TurnResult Ask(RunRequest::Kind kind) {
    WriteBatch batch;
    batch.run_requests.push_back({kind, "Call", {}});
    return Turn(std::move(batch));
  }
  std::vector<std::string> Users(const TurnResult& result) const {
    std::vector<std::string> users;
    for (const std::string& run : Started(result)) {
      users.push_back(
          GraphReader(dictionary_, stages_->writer.current())
              .Object(absl::StrCat("urn:docent:run:", run, "/$user"), DocentIri("variableValue")));
    }
    return users;
  }
  int rings_ = 0;
};

TEST_F(BellTest, EventsOfAPausedWorkflowWaitForTheResumeAsItsModeSays) {
  struct Case {
    std::string mode;
    std::vector<std::string> started;
    size_t ignored;
  };
  for (const Case& c : std::vector<Case>{
           {"", {"urn:w:Ann", "urn:w:Ann", "urn:w:Bob"}, 0},
           {"ext:mode=\"queued\"", {"urn:w:Ann", "urn:w:Bob"}, 0},  // the second of Ann after the first
           {"ext:mode=\"queued\" ext:max=\"1\"", {"urn:w:Ann", "urn:w:Bob"}, 1},
           {"ext:mode=\"single\"", {"urn:w:Ann", "urn:w:Bob"}, 1},
           {"ext:mode=\"restart\"", {"urn:w:Ann", "urn:w:Bob"}, 1}}) {
    Deploy(Bell(c.mode,
                "<node name=\"N\"><condition><context name=\"d\"><rule><constraint><subject>w:x</subject>"
                "<verb>w:y</verb><object>w:z</object></constraint></rule></context></condition></node>"));
    Ask(RunRequest::Kind::kPauseWorkflow);
    size_t ignored = 0;
    for (const char* who : {"Ann", "Ann", "Bob"}) {
      const TurnResult rang = Ring(who);
      EXPECT_THAT(Started(rang), IsEmpty()) << c.mode;
      ignored += Said(rang, "ignored").size();
      EXPECT_GE(Said(rang, "ignored").size() + Said(rang, "queued").size(), 1u) << c.mode;
    }
    EXPECT_EQ(ignored, c.ignored) << c.mode;
    Restart();
    EXPECT_EQ(Users(Ask(RunRequest::Kind::kResumeWorkflow)), c.started) << c.mode;
    Turn(Act(kRemovesRuns));
  }
}

TEST_F(BellTest, AnEventOfADisabledWorkflowIsIgnoredWithAWord) {
  Deploy(Bell(""));
  Turn(Act(kRemovesStarts));
  EXPECT_THAT(Said(Ring("Ann"), "ignored"), ElementsAre(HasSubstr("ignored: the workflow is disabled")));
  EXPECT_EQ(Told("ignoredFirings"), "1");
  EXPECT_THAT(Started(Turn(Act(kRemovesDisablement))), IsEmpty());
}

TEST_F(BellTest, AtMostSoManyFiringsWaitForTheResume) {
  Deploy(Bell(""));
  Ask(RunRequest::Kind::kPauseWorkflow);
  std::vector<TermQuad> rings;
  for (size_t i = 0; i <= kWorkflowLimits.firings_waiting; ++i) {
    const std::string event = absl::StrCat("e", i);
    rings.insert(rings.end(), {Fact(event, "a", "docent:Event"), Fact(event, "by", "Ann"),
                               Fact(event, "docent:operation", Term::Literal("ring"))});
  }
  EXPECT_THAT(Said(Turn(Tell(rings)), "ignored"), ElementsAre(HasSubstr("firings_waiting")));
  EXPECT_EQ(Started(Ask(RunRequest::Kind::kResumeWorkflow)).size(), kWorkflowLimits.firings_waiting);
}

TEST_F(ActivatorModesTest, ATurnThatIsRefusedCountsNothing) {
  Deploy(Text("ext:mode=\"single\""));
  Call("John", "a");
  Turn(Tell({}, {Fact("John", "calls", "a")}));
  WriteBatch bad = Tell({Fact("John", "calls", "b"), Fact("Ann", "calls", "b")});
  bad.documents.push_back({Document::Kind::kRules, Document::Action::kRemove, "none", ""});
  bad.time_us = now_us_ += 1000;
  EXPECT_FALSE(RunTurn(stages_.get(), bad, head_ + 1).ok());
  EXPECT_EQ(Told("ignoredFirings"), "");
  EXPECT_THAT(Started(Call("Ann", "b")), SizeIs(1));
}

}  // namespace
}  // namespace docent::server
