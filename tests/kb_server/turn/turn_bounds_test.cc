// Workflows that their own runs start again, and conditions with very many matches: the turn ends, and others go on.
#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/run_limits.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;
using ::testing::HasSubstr;

std::string Constraint(const std::string& subject, const std::string& verb, const std::string& object) {
  return absl::StrCat("<constraint name=\"", subject.substr(1), "_", object.size(), "\"><subject>", subject,
                      "</subject><verb>", verb, "</verb><object>", object, "</object></constraint>");
}

// A workflow that starts a run, which ends at once, for each match of these constraints.
std::string Workflow(const std::string& name, const std::string& constraints, const std::string& nodes = "",
                     const std::string& links = "<link from=\"s\" to=\"t\"/>") {
  return absl::StrCat(
      "<CAWL name=\"", name,
      "\" xmlns:docent=\"https://w3id.org/docent#\" xmlns:w=\"urn:w:\"><activator name=\"A\"><activate "
      "flow=\"",
      name, "\"/><condition><context name=\"c\"><rule name=\"r\">", constraints,
      "</rule></context></condition></activator><flow name=\"", name, "\"><source name=\"s\"/>", nodes,
      "<sink name=\"t\"/>", links, "</flow></CAWL>");
}

class TurnBoundsTest : public ::testing::Test {
 protected:
  absl::StatusOr<TurnResult> Turn(WriteBatch batch) {
    batch.time_us = now_us_ += 1000;
    absl::StatusOr<TurnResult> result = RunTurn(&stages_, std::move(batch), head_ + 1);
    if (result.ok()) ++head_;
    return result;
  }
  TurnResult Must(WriteBatch batch) {
    absl::StatusOr<TurnResult> result = Turn(std::move(batch));
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : TurnResult();
  }
  absl::StatusOr<TurnResult> Deploy(const std::string& text) {
    return Turn(Put(Document::Kind::kCawl, "w.xml", text));
  }
  static std::vector<std::string> Failures(const TurnResult& result) {
    std::vector<std::string> causes;
    for (const Transition& t : result.record.transitions) {
      if (t.to == "failed") causes.push_back(absl::StrCat(t.subject, ": ", t.cause));
    }
    return causes;
  }
  static size_t Started(const TurnResult& result) {
    const auto& all = result.record.transitions;
    return std::count_if(all.begin(), all.end(),
                         [](const Transition& t) { return t.from.empty() && t.to == "running"; });
  }
  // So many facts of as many things.
  static WriteBatch Facts(int count, const std::string& predicate, int first = 0) {
    WriteBatch batch;
    for (int i = first; i < first + count; ++i) {
      batch.operations.push_back(
          {QuadOperation::Kind::kAdd, Fact(absl::StrCat("x", i), predicate, absl::StrCat("y", i))});
    }
    return batch;
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  Stages stages_{&dictionary_, &functions_, Limits{}};
  uint64_t head_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
};

TEST_F(TurnBoundsTest, AnActivatorThatAnyFactMatchesIsNotDeployed) {
  Must(Facts(50, "in"));
  for (const std::string& constraints :
       {Constraint("?a", "?b", "?c"), Constraint("?a", "?b", "?c") + Constraint("?d", "?e", "?f")}) {
    const auto deployed = Deploy(Workflow("Any", constraints));
    EXPECT_TRUE(absl::IsResourceExhausted(deployed.status())) << deployed.status();
    EXPECT_THAT(std::string(deployed.status().message()), HasSubstr("Any"));
    EXPECT_TRUE(stages_.engine.workflows().empty());
    EXPECT_EQ(stages_.standing_conditions.size(), 0u);
  }
  Must(Facts(10, "out"));
}

TEST_F(TurnBoundsTest, AnActivatorWithAMatchForEachPairOfFactsIsNotDeployed) {
  Must(Facts(400, "in"));  // 160,000 pairs
  const auto deployed =
      Deploy(Workflow("Pairs", Constraint("?a", "w:in", "?b") + Constraint("?c", "w:in", "?d")));
  EXPECT_TRUE(absl::IsResourceExhausted(deployed.status())) << deployed.status();
  EXPECT_THAT(std::string(deployed.status().message()), HasSubstr("condition_matches"));
  Must(Facts(10, "out"));
}

TEST_F(TurnBoundsTest, AnActivatorThatComesToHaveTooManyMatchesIsGivenUp) {
  ASSERT_TRUE(
      Deploy(Workflow("Pairs", Constraint("?a", "w:in", "?b") + Constraint("?c", "w:in", "?d"))).ok());
  const TurnResult many = Must(Facts(400, "in"));
  ASSERT_EQ(Failures(many).size(), 1u);
  EXPECT_THAT(Failures(many)[0], HasSubstr("condition_matches"));
  EXPECT_EQ(stages_.standing_conditions.size(), 0u);
  EXPECT_TRUE(Failures(Must(Facts(400, "in", 1000))).empty());
  EXPECT_EQ(stages_.engine.workflows().size(), 1u);
}

TEST_F(TurnBoundsTest, AnActivatorStartsSoManyRunsInATurn) {
  const int most = static_cast<int>(kRunLimits.runs_started_per_turn);
  ASSERT_TRUE(Deploy(Workflow("In", Constraint("?a", "w:in", "?b"))).ok());
  const TurnResult all = Must(Facts(most, "in"));
  EXPECT_EQ(Started(all), kRunLimits.runs_started_per_turn);
  EXPECT_TRUE(Failures(all).empty());
  const TurnResult more = Must(Facts(most + 2, "in", most));
  EXPECT_EQ(Started(more), kRunLimits.runs_started_per_turn);
  ASSERT_EQ(Failures(more).size(), 1u) << "once for all";
  EXPECT_THAT(Failures(more)[0], HasSubstr("and 1 more"));
  EXPECT_THAT(Failures(more)[0], HasSubstr("runs_started_per_turn"));
  EXPECT_EQ(Started(Must(Facts(3, "out"))), 0u) << "it is not tried again";
}

TEST_F(TurnBoundsTest, ADeploymentThatStartsMoreIsRefused) {
  Must(Facts(static_cast<int>(kRunLimits.runs_started_per_turn) + 1, "in"));
  const auto deployed = Deploy(Workflow("In", Constraint("?a", "w:in", "?b")));
  EXPECT_TRUE(absl::IsResourceExhausted(deployed.status())) << deployed.status();
  EXPECT_THAT(std::string(deployed.status().message()), HasSubstr("runs_started_per_turn"));
  EXPECT_TRUE(stages_.engine.workflows().empty());
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

TEST_F(TurnBoundsTest, ARunThatFailsAndStartsAnotherByItStopsInTheTurn) {
  // a subflow that is not there: the run fails
  const std::string fails = "<node name=\"N\"><invoke subflow=\"Nowhere\"/></node>";
  const std::string links = "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"t\"/>";
  ASSERT_TRUE(
      Deploy(Workflow("Repair", Constraint("?run", "docent:runState", "\"failed\""), fails, links)).ok());
  WriteBatch broken = Put(Document::Kind::kCawl, "broken.xml",
                          absl::StrCat("<CAWL name=\"Broken\"><flow name=\"Broken\"><source name=\"s\"/>",
                                       fails, "<sink name=\"t\"/>", links, "</flow></CAWL>"));
  Must(broken);
  for (int i = 0; i < 3; ++i) {
    const TurnResult started = Must(test::Start("Broken"));
    EXPECT_GT(Started(started), 2u) << "it reacts to the failure";
    EXPECT_LE(Started(started), 2u + kRunLimits.activation_rounds_per_turn);
    bool says_why = false;
    for (const std::string& failure : Failures(started))
      says_why = says_why || failure.find("activation_rounds_per_turn") != std::string::npos;
    EXPECT_TRUE(says_why);
  }
}

TEST_F(TurnBoundsTest, TwoWorkflowsThatStartEachOtherStopInTheTurn) {
  for (const auto& [name, other] : {std::pair("Ping", "Pong"), std::pair("Pong", "Ping")}) {
    Must(Put(Document::Kind::kCawl, absl::StrCat(name, ".xml"),
             Workflow(name, Constraint("?run", "docent:workflow", absl::StrCat("\"", other, "\"")))));
  }
  const TurnResult started = Must(test::Start("Ping"));
  EXPECT_GT(Started(started), 4u);
  EXPECT_LE(Started(started), 2u * kRunLimits.activation_rounds_per_turn + 2);
  EXPECT_EQ(Started(Must(Facts(5, "in"))), 0u) << "what was not started is not tried again";
}

TEST_F(TurnBoundsTest, RulesOverFactsOfRunsThatStartRunsStopInTheTurn) {
  Must(Put(Document::Kind::kRules, "need.rules",
           "PREFIX docent: <https://w3id.org/docent#> RULE { ?run <urn:w:needs> <urn:w:Care> } WHERE { ?run "
           "docent:runState \"done\" }"));
  ASSERT_TRUE(Deploy(Workflow("Care", Constraint("?x", "w:needs", "w:Care"))).ok());
  const TurnResult started = Must(test::Start("Care"));
  EXPECT_LE(Started(started), 2u + kRunLimits.activation_rounds_per_turn);
  Must(Facts(5, "in"));
}

TEST_F(TurnBoundsTest, ANodeWhoseConditionHasTooManySolutionsFails) {
  Must(Facts(400, "in"));
  const std::string node = "<node name=\"N\"><condition><context name=\"c\"><rule name=\"r\">" +
                           Constraint("?a", "w:in", "?b") + Constraint("?c", "w:in", "?d") +
                           "</rule></context></condition></node>";
  Must(Put(Document::Kind::kCawl, "n.xml",
           "<CAWL name=\"N\" xmlns:w=\"urn:w:\"><flow name=\"N\"><source name=\"s\"/>" + node +
               "<sink name=\"t\"/><link from=\"s\" to=\"N\"/><link from=\"N\" to=\"t\"/></flow></CAWL>"));
  const TurnResult started = Must(test::Start("N"));
  ASSERT_FALSE(Failures(started).empty());
  EXPECT_THAT(Failures(started)[0], HasSubstr("condition_matches"));
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

}  // namespace
}  // namespace docent::server
