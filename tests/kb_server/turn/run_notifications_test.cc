// Notifications that nodes decide, and what their delivery does to the run.
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/workflow_limits.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {
namespace {

using test::Fact;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class RunNotifications : public RunActionsTest {
 protected:
  TurnResult Ended(const CommandId& id, CommandReport::Outcome outcome, const std::string& message = "") {
    WriteBatch report = test::Report(id, outcome);
    report.reports[0].message = message;
    return Must(report);
  }
};

constexpr char kHook[] = "<ext:notify to=\"http://h/x\" subject=\"$x\" variables=\"x y\"/>";

TEST_F(RunNotifications, TheNodeGoesOnAtOnce) {
  DeployOne(kHook);
  const TurnResult turn = Run({{"x", test::Iri("John")}});
  ASSERT_EQ(turn.notifications.size(), 1u);
  const Notification& sent = turn.notifications[0];
  EXPECT_EQ(sent.target, "http://h/x");
  EXPECT_EQ(sent.source, "urn:docent:run:F-1");
  EXPECT_EQ(sent.subject, "urn:w:John");
  EXPECT_EQ(sent.type, "org.w3id.docent.notification");
  ASSERT_EQ(sent.data.size(), 2u);
  EXPECT_EQ(sent.data[0].second, test::Iri("John"));
  EXPECT_EQ(sent.data[1].second, std::nullopt);
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
  EXPECT_EQ(stages_.engine.OpenNotifications().size(), 1u) << "it is kept after the run";
  const TurnResult end = Ended(sent.id, CommandReport::Outcome::kFailed, "nobody there");
  EXPECT_EQ(sent.id.value(), absl::StrCat("F-1/A/0/notify.1.0@", sent.time_us));
  EXPECT_THAT(Said(end), Contains("F-1/A notifying>failed: http://h/x: nobody there"));
  EXPECT_THAT(stages_.engine.OpenNotifications(), IsEmpty());
}

TEST_F(RunNotifications, OrWaitsForTheDelivery) {
  DeployOne("<ext:notify to=\"mqtt:a/b\" wait=\"true\"/><ext:tell>w:it w:is w:told</ext:tell>");
  const TurnResult turn = Run();
  EXPECT_FALSE(Has(Fact("it", "is", "told")));
  EXPECT_THAT(Said(Ended(turn.notifications[0].id, CommandReport::Outcome::kSucceeded)),
              Contains(HasSubstr("F-1 running>done")));
  EXPECT_TRUE(Has(Fact("it", "is", "told")));
}

TEST_F(RunNotifications, ThenAFailureIsOneOfTheNode) {
  Deploy("<node name=\"A\"><ext:notify to=\"http://h/x\" wait=\"true\"/></node><node name=\"Sorry\"/>", {},
         "",
         "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/><link from=\"A\" to=\"Sorry\" "
         "ext:onFailure=\"true\"/><link from=\"Sorry\" to=\"e\"/>");
  const TurnResult end = Ended(Run().notifications[0].id, CommandReport::Outcome::kFailed, "given up");
  EXPECT_THAT(Said(end), Contains("F-1/A running>failed: its notification was not delivered: given up"));
  EXPECT_THAT(Said(end), Contains(HasSubstr("F-1/Sorry running>done")));
}

TEST_F(RunNotifications, ANodeThatIsSkippedBeforeItsInvocationsMakesNone) {
  Must(test::WorldFacts());
  Deploy(
      "<node name=\"A\" ext:onFailure=\"incident\"><invoke operation=\"greet\"/><ext:notify "
      "to=\"http://h/x\" "
      "wait=\"true\"/><ext:tell>w:it w:is w:told</ext:tell></node>",
      {"A"});
  EXPECT_THAT(Said(Ended(Run().notifications[0].id, CommandReport::Outcome::kFailed, "given up")),
              Contains(HasSubstr("F-1/A running>incident")));
  WriteBatch skip;
  RunRequest request;
  request.kind = RunRequest::Kind::kSkipNode;
  request.target = "F-1";
  request.node = "A";
  skip.run_requests.push_back(request);
  const TurnResult skipped = Must(skip);
  EXPECT_TRUE(skipped.record.commands.empty());
  EXPECT_THAT(Said(skipped), Contains(HasSubstr("F-1 running>done")));
  EXPECT_FALSE(Has(Fact("it", "is", "told")));
}

// The attempt waits for its notification meanwhile, and has no invocation of the one before.
TEST_F(RunNotifications, TheTimeOfAnAttemptBeginsWithTheEndOfTheOneBeforeAlsoWhileItNotifies) {
  Must(test::WorldFacts());
  Deploy(
      "<node name=\"A\" ext:onFailure=\"incident\" ext:timeout=\"14s\"><ext:notify to=\"http://h/x\" "
      "wait=\"true\"/><invoke operation=\"greet\"/></node>",
      {"A"});
  const auto pass = [this](int seconds) {
    now_us_ += seconds * TimeMicros{1'000'000};
    return Said(Must(WriteBatch()));
  };
  const auto notified = CommandReport::Outcome::kSucceeded;
  const TurnResult sent = Ended(Run().notifications[0].id, notified);
  ASSERT_EQ(sent.record.commands.size(), 1u);
  EXPECT_THAT(pass(14), Contains(HasSubstr("F-1/A running>incident: it was not done within 14 s")));
  WriteBatch retry;
  RunRequest request;
  request.kind = RunRequest::Kind::kRetryNode;
  request.target = "F-1";
  request.node = "A";
  retry.run_requests.push_back(request);
  const TurnResult again = Must(retry);
  ASSERT_EQ(again.notifications.size(), 1u);
  pass(10);
  Ended(sent.record.commands[0].id, CommandReport::Outcome::kCancelled);
  EXPECT_EQ(Ended(again.notifications[0].id, notified).record.commands.size(), 1u);
  EXPECT_THAT(pass(13), IsEmpty());
  EXPECT_THAT(pass(1), Contains(HasSubstr("F-1/A running>incident: it was not done within 14 s")));
}

TEST_F(RunNotifications, ANodeThatOpensTwiceInOneTurnNotifiesTwice) {
  Must(test::Tell({Fact("a", "is", "here"), Fact("b", "is", "here")}));
  Deploy(
      "<node name=\"A\">" + When("?z", "w:is", "w:here") +
          "<ext:withdraw source=\"any\">?z w:is w:here</ext:withdraw><ext:notify to=\"http://h/x\"/></node>"
          "<node name=\"B\"/>",
      {}, "",
      "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/><link from=\"B\" to=\"e\"/>"
      "<link from=\"B\" to=\"A\" ext:while=\"?other w:is w:here\"/>");
  const TurnResult turn = Run();
  ASSERT_EQ(turn.notifications.size(), 2u);
  EXPECT_NE(turn.notifications[0].id, turn.notifications[1].id);
  EXPECT_EQ(stages_.engine.OpenNotifications().size(), 2u);
}

TEST_F(RunNotifications, ASkippedNodeWaitsForNoDelivery) {
  Deploy("<node name=\"A\" ext:onFailure=\"incident\" ext:forEach=\"?z\">" + When("?z", "w:is", "w:here") +
             "<ext:notify to=\"http://h/x\" wait=\"true\"/></node>",
         {"A"});
  Must(test::Tell({Fact("a", "is", "here"), Fact("b", "is", "here")}));
  const TurnResult turn = Run();
  ASSERT_EQ(turn.notifications.size(), 2u);
  Ended(turn.notifications[0].id, CommandReport::Outcome::kFailed, "given up");
  Ended(turn.notifications[1].id, CommandReport::Outcome::kSucceeded);
  WriteBatch skip;
  RunRequest request;
  request.kind = RunRequest::Kind::kSkipNode;
  request.target = "F-1";
  request.node = "A";
  skip.run_requests.push_back(request);
  EXPECT_THAT(Said(Must(skip)), Contains(HasSubstr("F-1 running>done")));
}

TEST_F(RunNotifications, AReportThatIsRepeatedIsNoNews) {
  DeployOne("<ext:notify to=\"http://h/x\" wait=\"true\"/>");
  const CommandId id = Run().notifications[0].id;
  Ended(id, CommandReport::Outcome::kSucceeded);
  EXPECT_THAT(Said(Ended(id, CommandReport::Outcome::kFailed)), IsEmpty());
}

TEST_F(RunNotifications, ATurnThatIsRefusedNotifiesNobody) {
  DeployOne(kHook);
  WriteBatch bad = test::Start("W", {{"x", test::Iri("John")}});
  bad.run_requests.push_back({RunRequest::Kind::kStart, "None", {}});
  bad.time_us = now_us_ += 1000;
  EXPECT_FALSE(RunTurn(&stages_, bad, head_ + 1).ok());
  EXPECT_THAT(stages_.engine.OpenNotifications(), IsEmpty());
}

TEST_F(RunNotifications, ThereAreNotMoreThanTheLimit) {
  const std::string all = "<ext:notify to=\"http://h/x\"/>";
  WriteBatch many = test::Tell({});
  for (int i = 0; i < 1000; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "a", "Thing")});
  Must(many);
  std::string ten;
  for (int i = 0; i < 10; ++i) ten += all;
  Deploy("<node name=\"A\" ext:forEach=\"?n\">" + When("?n", "a", "w:Thing") + ten + "</node>", {"A"});
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("F-1 running>done")));
  EXPECT_EQ(stages_.engine.OpenNotifications().size(), kWorkflowLimits.notifications_open);
  DeployOne(all);
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("the limit is notifications_open")));
}

TEST_F(RunNotifications, ASnapshotKeepsThem) {
  DeployOne(
      "<ext:tell lifetime=\"run\">w:it w:is w:here</ext:tell><ext:notify to=\"http://h/x\" wait=\"true\"/>");
  const CommandId id = Run().notifications[0].id;
  const auto bytes = engine::EncodeEngineState(stages_.engine.Save());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  auto state = engine::DecodeEngineState(*bytes, Limits{}, &dictionary_,
                                         [](const RunId&) { return std::vector<Quad>(); });
  ASSERT_TRUE(state.ok()) << state.status();
  stages_.engine.Restore(*std::move(state));
  ASSERT_EQ(stages_.engine.OpenNotifications().size(), 1u);
  EXPECT_EQ(stages_.engine.OpenNotifications()[0].id, id);
  Ended(id, CommandReport::Outcome::kSucceeded);
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
  EXPECT_FALSE(Has(Fact("it", "is", "here")));
}

}  // namespace
}  // namespace docent::server
