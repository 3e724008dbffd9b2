// Runs inside each other: how they end, how deep they go, and what stays of them.
#include <algorithm>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/cawl/parser.h"

namespace docent::engine {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EngineSubflowsTest : public EngineTest {};

// Whoever started a run of many sub-flows was told that there is no such run.
TEST_F(EngineSubflowsTest, WhatEndsInOneTurnLeavesTheGraphBeforeTheRunThatItIsNestedIn) {
  Limits limits;
  limits.runs_kept = 2;
  Engine small(&dictionary_, limits);
  Deploy(Flow(Node("A", "", "<invoke subflow=\"G\"/><invoke subflow=\"G\"/><invoke subflow=\"G\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "") + "<sink name=\"t\"/>" + Link("s", "B") +
         Link("B", "t") + "</flow>");
  ASSERT_TRUE(small.Deploy(engine_.FindWorkflow("W")).ok());
  std::vector<CommandReport> reports;
  std::vector<RunRequest> requests = {{RunRequest::Kind::kStart, "W/F", {}}};
  EngineInput input{now_us_, Revision(++revision_), false,   &reports, &requests,
                    nullptr, &conditions_,          &robots_};
  const EngineOutput output = small.Step(input);
  small.Commit();
  const auto stays = [&](const std::string& run) {
    const auto is_of_run = [&](const Quad& quad) {
      return quad.subject == dictionary_.FindIri("urn:docent:run:" + run);
    };
    return std::any_of(output.add.begin(), output.add.end(), is_of_run) &&
           std::none_of(output.remove.begin(), output.remove.end(), is_of_run);
  };
  EXPECT_TRUE(stays("F-1"));
  EXPECT_FALSE(stays("G-2"));
  EXPECT_FALSE(stays("G-3"));
  EXPECT_TRUE(stays("G-4"));
}

TEST_F(EngineSubflowsTest, ASubflowEndsItsInvocation) {
  Deploy(Flow(Node("A", "", "<invoke subflow=\"G\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  Start();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("G-2/B/"));
  EXPECT_EQ(Fact("urn:docent:run:G-2", "parentRun"), "urn:docent:run:F-1");
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("G-2 running>done"));
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineSubflowsTest, ARobotOfAnEndedSubflowIsNotFreeAfterARefusedTurn) {
  Deploy(Flow(Node("A", "", "<invoke subflow=\"G\"/>") + Node("C", "later", "<invoke operation=\"c\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "C") + Link("C", "t")) +
         "<flow name=\"G\"><source name=\"s\"/>" + Node("B", "", "<invoke operation=\"b\"/>") +
         "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") + "</flow>");
  Start();
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("G-2 running>done"));
  engine_.Rollback();  // of a turn that changed nothing
  Turn({}, {{RunRequest::Kind::kStart, "W/G", {}}});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(Fact("urn:docent:run:G-3/B/0", "reason"), HasSubstr("serves another run"));
}

TEST_F(EngineSubflowsTest, RunsInsideEachOtherHaveALimit) {
  const auto nested = [this](int i) {
    const std::string text = absl::StrCat(
        "<CAWL name=\"D", i, "\" namespace=\"urn:x\" version=\"1\"><flow name=\"G\"><source name=\"s\"/>",
        Node("B", "", absl::StrCat("<invoke subflow=\"D", i + 1, "\"/>")), "<sink name=\"t\"/>",
        Link("s", "B"), Link("B", "t"), "</flow></CAWL>");
    const cawl::ParsedCawl parsed = cawl::ParseCawl(text, "x.xml");
    ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
    ASSERT_TRUE(engine_.Deploy(parsed.document).ok());
  };
  const int deep = Limits().subflow_nesting;
  for (int i = 1; i <= deep + 1; ++i) nested(i);
  Deploy(Flow(Node("A", "", "<invoke subflow=\"D1\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("subflow_nesting"));
}

TEST_F(EngineSubflowsTest, ASubflowThatContainsItselfFails) {
  Deploy(Flow(Node("A", "", "<invoke subflow=\"X\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  std::string other =
      "<CAWL name=\"X\" namespace=\"urn:x\" version=\"1\"><flow name=\"G\"><source name=\"s\"/>" +
      Node("B", "", "<invoke subflow=\"W\"/>") + "<sink name=\"t\"/>" + Link("s", "B") + Link("B", "t") +
      "</flow></CAWL>";
  cawl::ParsedCawl parsed = cawl::ParseCawl(other, "x.xml");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, other);
  ASSERT_TRUE(engine_.Deploy(parsed.document).ok());
  Start();
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("it would run inside itself"));
}

}  // namespace
}  // namespace docent::engine
