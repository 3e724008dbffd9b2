#include "workflow/engine/engine.h"

#include <algorithm>
#include <set>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/cawl/parser.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(EngineTest, ASequenceWaitsForItsConditionsAndEnds) {
  Deploy(Flow(Node("A", "one", "<invoke operation=\"go\"/>") +
              Node("B", "two", "<invoke operation=\"show\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "B") + Link("B", "t")));
  Start();
  EXPECT_TRUE(Says("F-1/A inactive>waiting"));
  EXPECT_THAT(Fact("urn:docent:run:F-1/A", "waitsFor"), HasSubstr("urn:one"));
  EXPECT_THAT(commands_, IsEmpty());

  conditions_.Set("urn:one", {{{"s", Term::Iri("urn:x")}}});
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "go");
  EXPECT_EQ(commands_[0].robot.value(), "urn:r1");
  EXPECT_EQ(commands_[0].expected_incarnation, "i1");
  EXPECT_EQ(Fact("urn:docent:run:F-1/A", "firedBecause"), "<urn:s> <urn:p> <urn:o> .\n");
  EXPECT_EQ(engine_.OpenCommands().size(), 1u);

  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1/A running>done"));
  EXPECT_TRUE(Says("F-1/B inactive>waiting"));

  conditions_.Set("urn:two", {{{"s", Term::Iri("urn:x")}}});
  Turn();
  ASSERT_EQ(commands_.size(), 1u);
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1 running>done"));
  EXPECT_EQ(Fact("urn:docent:run:F-1", "runState"), "done");
  EXPECT_EQ(engine_.live_runs(), 0u);
  EXPECT_EQ(conditions_.armed(), 0u);
}

TEST_F(EngineTest, AConditionThatHoldsAlreadyFiresInTheSameTurn) {
  Deploy(Flow(Node("A", "one", "<invoke operation=\"go\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  conditions_.Set("urn:one", {{{"s", Term::Iri("urn:x")}}});
  Start();
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(EngineTest, ParallelLinksJoinWhenAllHaveCome) {
  robots_.by_operation = {{"a", {"base"}}, {"b", {"screen"}}};
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("B", "", "<invoke operation=\"b\"/>") +
              Node("C", "", "<invoke operation=\"c\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("s", "B") + Link("A", "C") + Link("B", "C") + Link("C", "t")));
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  CommandId a = commands_[0].id, b = commands_[1].id;
  Turn({Done(b)});
  EXPECT_THAT(commands_, IsEmpty());
  Turn({Done(a)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "c");
}

TEST_F(EngineTest, AJoinConditionOpensEarly) {
  robots_.by_operation = {{"a", {"base"}}, {"b", {"screen"}}, {"c", {"screen"}}};
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("B", "", "<invoke operation=\"b\"/>") +
              Node("C", "", "<wait joinCondition=\"A or B\"/><invoke operation=\"c\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("s", "B") + Link("A", "C") + Link("B", "C") +
              Link("C", "t")));
  Start();
  Turn({Done(commands_[1].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "c");
}

TEST_F(EngineTest, InvokesOfANodeRunTogetherAndAllMustEnd) {
  robots_.by_operation = {{"show", {"screen"}}, {"say", {"voice"}}};
  Deploy(Flow(Node("A", "", "<invoke operation=\"show\"/><invoke operation=\"say\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Start();
  ASSERT_EQ(commands_.size(), 2u);
  CommandId show = commands_[0].id, say = commands_[1].id;
  EXPECT_NE(show, say);
  Turn({Done(show)});
  EXPECT_EQ(engine_.live_runs(), 1u);
  Turn({Done(say)});
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineTest, AFailureFollowsTheFailureLinkOrEndsTheRun) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + Node("Repair", "", "<invoke operation=\"r\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t") +
              Link("A", "Repair", "ext:onFailure=\"true\"") + Link("Repair", "t")));
  Start();
  Turn({Failed(commands_[0].id, "wheel lost")});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "r");
  Turn({Failed(commands_[0].id, "no tools")});
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("no tools"));
}

TEST_F(EngineTest, AStepThatHangsTimesOutAndIsCancelled) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\" ext:timeout=\"2s\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  Start();
  CommandId id = commands_[0].id;
  ASSERT_TRUE(engine_.NextDeadline().has_value());
  EXPECT_EQ(*engine_.NextDeadline(), now_us_ + 2000000);
  now_us_ += 2000000;
  Turn();
  EXPECT_THAT(cancels_, ElementsAre(id));
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("timed out: 1/1 a"));
  EXPECT_FALSE(engine_.NextDeadline().has_value());
}

TEST_F(EngineTest, AStepThatFindsNoRobotInTimeSaysSo) {
  robots_.offers.clear();
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\" ext:timeout=\"2s\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  Start();
  now_us_ += 2000000;
  Turn();
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("timed out: no robot became free for it"));
}

// The time of the invoke, or of its node.
TEST_F(EngineTest, ATimeThatIsOverNamesTheRobotsThatCouldNotBegin) {
  robots_.offers.push_back({RobotId("urn:r2"), "i1", false, true});
  robots_.offers.push_back({RobotId("urn:r3"), "i1", false, false});
  robots_.offers[2].out_of_service = "is out of service: smoke";
  const std::string time = " ext:timeout=\"3s\"";
  const auto second_of = [&](const std::string& of_node, const std::string& of_invoke, int run) {
    Deploy(Flow("<node name=\"A\"" + of_node + "><invoke operation=\"a\"" + of_invoke +
                "/></node><sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
    Start();
    const CommandId first = commands_[0].id;
    Start();
    now_us_ += 3000000;
    Turn();
    Turn({Failed(first, "stopped")});
    return Fact(absl::StrCat("urn:docent:run:F-", run), "reason");
  };
  EXPECT_EQ(
      second_of("", time, 2),
      "node A: timed out: no robot became free for it within 3 s: <urn:r1> is held by run F-1; <urn:r2> "
      "is offline; <urn:r3> is out of service: smoke");
  EXPECT_EQ(
      second_of(time, "", 4),
      "node A: it was not done within 3 s: a: no robot became free for it: <urn:r1> is held by run F-3; "
      "<urn:r2> is offline; <urn:r3> is out of service: smoke");
}

TEST_F(EngineTest, ATimeThatIsOverNamesTheStepThatHangs) {
  Deploy(Flow("<node name=\"A\" ext:timeout=\"3s\"><invoke operation=\"a\"/></node><sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  Start();
  now_us_ += 3000000;
  Turn();
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"),
              HasSubstr("it was not done within 3 s: a on <urn:r1>: 1/1 a"));
}

TEST_F(EngineTest, AConditionThatNeverHoldsTimesOut) {
  std::string condition = Condition("one");
  condition.replace(condition.find("<condition>"), 11, "<condition ext:timeout=\"5s\">");
  Deploy(
      Flow("<node name=\"A\">" + condition + "</node><sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Start();
  now_us_ += 5000000;
  Turn();
  EXPECT_TRUE(Says("F-1/A waiting>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("did not hold within 5 s"));
}

TEST_F(EngineTest, RetryTriesAgainUnderANewId) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\" ext:retry=\"1\"/>") + "<sink name=\"t\"/>" +
              Link("s", "A") + Link("A", "t")));
  Start();
  CommandId first = commands_[0].id;
  Turn({Failed(first, "slipped")});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_NE(commands_[0].id, first);
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineTest, AnUnknownOutcomeIsSentAgainOnlyIfIdempotent) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  Turn({{commands_[0].id, CommandReport::Outcome::kUnknown, "the adapter restarted", 0, "i2", {}}});
  EXPECT_TRUE(Says("F-1 running>failed"));
  robots_.offers[0].idempotent = true;
  Start();
  CommandId first = commands_[0].id;
  robots_.offers[0].incarnation = "i2";  // it has joined
  Turn({{first, CommandReport::Outcome::kUnknown, "the adapter restarted", 0, "i2", {}}});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_NE(commands_[0].id, first);
  EXPECT_EQ(commands_[0].expected_incarnation, "i2");
  first = commands_[0].id;
  Turn({{first, CommandReport::Outcome::kUnknown, "the adapter restarted", 0, "i3", {}}});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].expected_incarnation, "") << "any that is there: the new one has not joined yet";
}

// It was sent to nobody: another adapter joined before.
TEST_F(EngineTest, WhatTheAdapterThatIsGoneNeverGotIsSentToTheNewOne) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  const CommandId first = commands_[0].id;
  robots_.offers[0].incarnation = "i2";
  Turn({{first, CommandReport::Outcome::kNotBegun, "i1 was replaced", 0, "i1", {}}});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_NE(commands_[0].id, first);
  EXPECT_EQ(commands_[0].expected_incarnation, "i2");
  EXPECT_TRUE(Says("F-1/A/0 1/1 a running>not begun"));
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1 running>done"));
}

TEST_F(EngineTest, AnIdempotentCommandIsNotMeantForTheIncarnationThatIsGone) {
  robots_.offers[0].idempotent = true;
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  ASSERT_EQ(commands_[0].expected_incarnation, "i1");
  Turn({{commands_[0].id, CommandReport::Outcome::kUnknown, "meant for incarnation i1", 0, "i1", {}}});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].expected_incarnation, "");
}

TEST_F(EngineTest, ACommandWhoseOutcomeIsAlwaysUnknownIsNotSentForEver) {
  robots_.offers[0].idempotent = true;
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  for (int i = 0; i < 3; ++i) {
    Turn({{commands_[0].id, CommandReport::Outcome::kUnknown, "not ready", 0, "i1", {}}});
    ASSERT_EQ(commands_.size(), 1u);
  }
  Turn({{commands_[0].id, CommandReport::Outcome::kUnknown, "not ready", 0, "i1", {}}});
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("not ready"));
}

TEST_F(EngineTest, AnActivatorStartsOneRunForEachBindingAndAgainWhenItComesBack) {
  Deploy("<activator name=\"act\"><activate flow=\"F\"/>" + Condition("arrived") + "</activator>" +
         Flow(Node("A", "go", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Turn();
  EXPECT_EQ(engine_.live_runs(), 0u);
  TermBinding john = {{"s", Term::Iri("urn:john")}, {"o", Term::Iri("urn:hall")}};
  TermBinding mary = {{"s", Term::Iri("urn:mary")}, {"o", Term::Iri("urn:hall")}};
  conditions_.Set("urn:arrived", {john});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 1u);
  conditions_.Set("urn:arrived", {john, mary});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 2u);
  conditions_.Set("urn:arrived", {mary});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 2u);
  conditions_.Set("urn:arrived", {john, mary});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 3u);
  EXPECT_EQ(Fact("urn:docent:run:F-1/$s", "variableValue"), "urn:john");
}

TEST_F(EngineTest, AnActivatorWithoutFreeVariablesStartsARunWheneverItsConditionRises) {
  Deploy(
      "<activator name=\"act\"><activate flow=\"F\"/><condition><context name=\"c\"><rule "
      "name=\"r\"><constraint name=\"c\">"
      "<subject>&lt;urn:door&gt;</subject><verb>&lt;urn:is&gt;</verb><object>&lt;urn:open&gt;</object></"
      "constraint></rule>"
      "</context></condition></activator>" +
      Flow(Node("A", "go", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
           Link("A", "t")));
  Turn();
  EXPECT_EQ(engine_.live_runs(), 0u);
  conditions_.Set("urn:door", {{}});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 1u);
  conditions_.Set("urn:door", {});
  Turn();
  conditions_.Set("urn:door", {{}});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 2u);
}

TEST_F(EngineTest, AReplacedActivatorStartsARunForABindingThatItMeetsLater) {
  auto deploy = [this](const std::string& word) {
    Deploy("<activator name=\"act\"><activate flow=\"F\"/>" + Condition(word) + "</activator>" +
           Flow(Node("A", "go", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
                Link("A", "t")));
  };
  TermBinding john = {{"s", Term::Iri("urn:john")}, {"o", Term::Iri("urn:hall")}};
  conditions_.Set("urn:arrived", {john});
  conditions_.Set("urn:chose", {});
  deploy("arrived");
  Turn();
  EXPECT_EQ(engine_.live_runs(), 1u);
  deploy("arrived");
  Turn();
  EXPECT_EQ(engine_.live_runs(), 1u);  // the same John
  deploy("chose");
  Turn();
  conditions_.Set("urn:chose", {john});
  Turn();
  EXPECT_EQ(engine_.live_runs(), 2u);
}

TEST_F(EngineTest, ANodesRetryGivesItsInvokesTheirOwnRetriesAgain) {
  Deploy(Flow(
      "<node name=\"A\" ext:retry=\"1\"><invoke operation=\"a\" ext:retry=\"1\"/></node><sink name=\"t\"/>" +
      Link("s", "A") + Link("A", "t")));
  Start();
  std::set<CommandId> ids;
  for (int attempt = 1; attempt <= 4; ++attempt) {  // two of the invoke, twice
    ASSERT_EQ(commands_.size(), 1u) << attempt;
    EXPECT_TRUE(ids.insert(commands_[0].id).second);
    Turn({Failed(commands_[0].id, "slipped")});
  }
  EXPECT_TRUE(Says("F-1 running>failed"));
}

TEST_F(EngineTest, FactsOfEndedRunsLeaveTheGraphAfterALimit) {
  Limits limits;
  limits.runs_kept = 2;
  Engine small(&dictionary_, limits);
  Deploy(Flow(Node("A", "", "") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  ASSERT_TRUE(small.Deploy(engine_.FindWorkflow("W")).ok());
  std::vector<Quad> facts;
  std::vector<CommandReport> reports;
  std::vector<RunRequest> requests = {{RunRequest::Kind::kStart, "W/F", {}}};
  auto step = [&] {
    EngineInput input{now_us_, Revision(++revision_), false,   &reports, &requests,
                      nullptr, &conditions_,          &robots_};
    EngineOutput output = small.Step(input);
    std::vector<Quad> after = facts;
    for (const Quad& quad : output.remove) std::erase(after, quad);
    after.insert(after.end(), output.add.begin(), output.add.end());
    return after;
  };
  auto has = [this](const std::vector<Quad>& all, const std::string& run) {
    return std::any_of(all.begin(), all.end(), [&](const Quad& quad) {
      return quad.subject == dictionary_.FindIri("urn:docent:run:" + run);
    });
  };
  for (int i = 0; i < 3; ++i) {
    facts = step();
    small.Commit();
  }
  EXPECT_FALSE(has(facts, "F-1"));
  EXPECT_TRUE(has(facts, "F-2"));
  EXPECT_TRUE(has(facts, "F-3"));
  std::vector<Quad> once = step();
  small.Rollback();
  std::vector<Quad> twice = step();
  EXPECT_EQ(once, twice);
  EXPECT_FALSE(has(twice, "F-2"));
  EXPECT_TRUE(has(twice, "F-4"));
}

std::string NamesOf(const std::vector<std::pair<std::string, Term>>& arguments) {
  std::string names;
  for (const auto& [name, value] : arguments) absl::StrAppend(&names, names.empty() ? "" : " ", name);
  return names;
}

TEST_F(EngineTest, AnOperationOfARobotIsSentWhatItTakesAndNoOtherVariable) {
  const std::string flow = Flow(
      "<message name=\"M\"><part name=\"note\"/><part name=\"unset\"/></message><variable name=\"user\"/>"
      "<variable name=\"note\"/>" +
      Node("A", "", "<invoke operation=\"go\"/>") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t"));
  Deploy(flow);
  const std::vector<RunRequest> start = {
      {RunRequest::Kind::kStart, "W/F", {{"user", Term::Iri("urn:john")}, {"note", Term::Literal("n")}}}};
  const auto sent = [&] {
    Turn({}, start);
    EXPECT_EQ(commands_.size(), 1u);
    if (commands_.empty()) return std::string("nothing");
    const RobotCommand command = commands_[0];
    Turn({Done(command.id)});
    return NamesOf(command.arguments);
  };
  robots_.offers[0].inputs = std::vector<std::string>{"user"};
  EXPECT_EQ(sent(), "user");
  robots_.offers[0].inputs = std::vector<std::string>();
  EXPECT_EQ(sent(), "");
  robots_.offers[0].inputs = std::nullopt;
  EXPECT_EQ(sent(), "note") << "the parts of the messages that the node sees, as far as they have values";
  robots_.offers[0].inputs = std::vector<std::string>{"user", "speed"};
  Turn({}, start);
  EXPECT_EQ(commands_.size(), 0u);
  EXPECT_TRUE(Says("F-4 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-4", "reason"), HasSubstr("needs a value for speed"));
}

TEST_F(EngineTest, ARunThatEndedUsesNoRobot) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"go\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  EXPECT_EQ(Fact("urn:docent:run:F-1", "usesRobot"), "urn:r1");
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("F-1 running>done"));
  EXPECT_EQ(Fact("urn:docent:run:F-1", "usesRobot"), "");
  Start();
  Turn({}, {{RunRequest::Kind::kCancel, "F-2", {}}});
  EXPECT_EQ(Fact("urn:docent:run:F-2", "usesRobot"), "");
}

TEST_F(EngineTest, RunsAndNodesAreNamedBySegments) {
  Deploy("<flow name=\"Tour A/1\"><source name=\"s\"/>" +
         Node("Say &quot;hi&quot;", "", "<invoke operation=\"go\"/>") + "<sink name=\"t\"/>" +
         Link("s", "Say &quot;hi&quot;") + Link("Say &quot;hi&quot;", "t") + "</flow>");
  Turn({}, {{RunRequest::Kind::kStart, "W/Tour A/1", {}}});
  EXPECT_TRUE(Says("Tour%20A%2F1-1/Say%20%22hi%22 inactive>running"));
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_THAT(commands_[0].id.value(), HasSubstr("Tour%20A%2F1-1/Say%20%22hi%22/0/0.1/1/1@"));
  EXPECT_EQ(Fact("urn:docent:run:Tour%20A%2F1-1/Say%20%22hi%22", "nodeName"), "Say \"hi\"");
  EXPECT_EQ(Fact("urn:docent:run:Tour%20A%2F1-1/Say%20%22hi%22", "position"), "1");
}

TEST_F(EngineTest, RefusedFeedbackStandsInTheInvocationUntilItGoesOn) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"go\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  const CommandId command = commands_[0].id;
  Turn({{command, CommandReport::Outcome::kRefused, "it is about command somebody/else", 0, "i1", {}}});
  EXPECT_THAT(Fact("urn:docent:run:F-1/A/0", "reason"), HasSubstr("somebody/else"));
  EXPECT_EQ(Fact("urn:docent:run:F-1", "runState"), "running");
  Turn({Done(command)});
  EXPECT_TRUE(Says("F-1 running>done"));
  EXPECT_EQ(Fact("urn:docent:run:F-1/A/0", "reason"), "");
}

TEST_F(EngineTest, AVariableWithPartsIsCopiedWhole) {
  Deploy(
      "<message name=\"M\"><part name=\"x\"/><part name=\"y\"/></message>"
      "<variable name=\"a\" type=\"M\"><initialize part=\"x\"><from "
      "expression=\"1\"/></initialize></variable>" +
      Flow("<variable name=\"b\" type=\"M\"><initialize><from variable=\"a\"/></initialize></variable>" +
           Node("A", "", "") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Start();
  EXPECT_EQ(Fact("urn:docent:run:F-1/$b.x", "variableValue"), "1");
}

// A condition of nine rules, each of two alternatives: 2^9.
std::string TooManyAlternatives() {
  std::string rules;
  for (int i = 0; i < 9; ++i) {
    const auto constraint = [](const std::string& name, int object) {
      return "<constraint name=\"" + name + "\"><subject>?v</subject><verb>&lt;urn:at&gt;</verb><object>" +
             std::to_string(object) + "</object></constraint>";
    };
    rules += "<rule expression=\"a or b\">" + constraint("a", i) + constraint("b", i + 100) + "</rule>";
  }
  return "<condition><context name=\"C\">" + rules + "</context></condition>";
}

TEST_F(EngineTest, AnActivatorThatCanNeverBeAskedIsRefusedAndLeavesTheOneBefore) {
  const std::string flow = Flow(Node("A", "", "") + "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t"));
  Deploy("<activator name=\"a\"><activate flow=\"F\"/>" + Condition("before") + "</activator>" + flow);
  Turn();
  const std::string text = "<CAWL name=\"W\"><activator name=\"a\"><activate flow=\"F\"/>" +
                           TooManyAlternatives() + "</activator>" + flow + "</CAWL>";
  cawl::ParsedCawl parsed = cawl::ParseCawl(text, "w.xml");
  ASSERT_TRUE(parsed.ok());
  const absl::Status refused = engine_.Deploy(parsed.document);
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("the limit condition_alternatives is 256"));
  engine_.Rollback();
  conditions_.Set("before", {{{"s", Term::Iri("urn:s")}, {"o", Term::Iri("urn:o")}}});
  Turn();
  EXPECT_TRUE(Says("F-1 >running"));
}

TEST_F(EngineTest, ANodeWhoseConditionBecomesTooLongWithItsValuesFailsAlone) {
  Deploy(Flow("<variable name=\"v\"/>" +
              std::string("<node name=\"A\"><condition><context name=\"C\"><rule name=\"r\"><constraint "
                          "name=\"c\"><subject>?s</subject><verb>&lt;urn:p&gt;</verb><object>$v</object>"
                          "</constraint></rule></context></condition></node>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Turn({}, {{RunRequest::Kind::kStart, "W/F", {{"v", Term::Literal(std::string(1u << 20, 'x'))}}}});
  EXPECT_TRUE(Says("F-1 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"), HasSubstr("query_text_bytes"));
  EXPECT_EQ(conditions_.armed(), 0u);
}

TEST_F(EngineTest, CancelEndsTheRunAndItsCommands) {
  Deploy(Flow(Node("A", "", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  CommandId id = commands_[0].id;
  Turn({}, {{RunRequest::Kind::kCancel, "F-1", {}}});
  EXPECT_THAT(cancels_, ElementsAre(id));
  EXPECT_TRUE(Says("F-1 running>cancelled"));
  ASSERT_EQ(engine_.OpenCommands().size(), 1u);
  EXPECT_TRUE(engine_.OpenCommands()[0].ending);
  Turn({Done(id)});
  EXPECT_THAT(transitions_, ElementsAre("F-1/A/0 ending>ended"));
  EXPECT_THAT(engine_.OpenCommands(), IsEmpty());
  Turn({Done(id)});  // repeated: nothing happens
  EXPECT_THAT(transitions_, IsEmpty());
}

TEST_F(EngineTest, RollbackPutsEverythingBack) {
  Deploy(Flow(Node("A", "one", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Start();
  conditions_.Set("urn:one", {{{"s", Term::Iri("urn:x")}}});
  std::vector<CommandReport> reports;
  std::vector<RunRequest> requests = {{RunRequest::Kind::kStart, "W/F", {}}};
  EngineInput input{now_us_, Revision(9), false, &reports, &requests, nullptr, &conditions_, &robots_};
  EngineOutput first = engine_.Step(input);
  EXPECT_EQ(engine_.live_runs(), 2u);
  engine_.Rollback();
  EXPECT_EQ(engine_.live_runs(), 1u);
  EXPECT_THAT(engine_.OpenCommands(), IsEmpty());
  EngineOutput again = engine_.Step(input);
  EXPECT_EQ(again.transitions, first.transitions);
  EXPECT_EQ(again.commands, first.commands);
  EXPECT_EQ(again.add, first.add);
}

TEST_F(EngineTest, RollbackPutsBackWhichBindingsAnActivatorHas) {
  Deploy("<activator name=\"act\"><activate flow=\"F\"/>" + Condition("arrived") + "</activator>" +
         Flow(Node("A", "go", "<invoke operation=\"a\"/>") + "<sink name=\"t\"/>" + Link("s", "A") +
              Link("A", "t")));
  Turn();
  const TermBinding john = {{"s", Term::Iri("urn:john")}, {"o", Term::Iri("urn:hall")}};
  EngineInput input{now_us_, Revision(9), false, nullptr, nullptr, nullptr, &conditions_, &robots_};
  conditions_.Set("urn:arrived", {john});
  EXPECT_THAT(engine_.Step(input).transitions, Not(IsEmpty()));
  engine_.Rollback();
  EXPECT_EQ(engine_.live_runs(), 0u);
  const EngineOutput again = engine_.Step(input);
  EXPECT_THAT(again.transitions, Not(IsEmpty()));
  conditions_.Take(again);
  engine_.Commit();
  EXPECT_EQ(engine_.live_runs(), 1u);
  conditions_.Set("urn:arrived", {});
  engine_.Step(input);
  engine_.Rollback();  // the binding is still there
  conditions_.Take({});
  conditions_.Set("urn:arrived", {john});
  engine_.Step(input);
  engine_.Commit();
  EXPECT_EQ(engine_.live_runs(), 1u);
}

TEST_F(EngineTest, AServiceIsInvokedWithoutAWorkflow) {
  std::string text =
      "<rsel name=\"S\" namespace=\"urn:s\" version=\"1\"><process name=\"Tour\"><invoke operation=\"go\"/>"
      "<invoke operation=\"show\"/></process></rsel>";
  rsel::ParsedRsel parsed = rsel::ParseRsel(text, "s.xml");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  EXPECT_THAT(engine_.PutServices(parsed.document), IsEmpty());
  Turn({}, {{RunRequest::Kind::kInvokeService, "Tour", {}}});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "go");
  Turn({Done(commands_[0].id)});
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, "show");
  EXPECT_EQ(Fact("urn:docent:run:Tour-1/Tour/0", "step"), "2/2 show");
  Turn({Done(commands_[0].id)});
  EXPECT_TRUE(Says("Tour-1 running>done"));
}

}  // namespace
}  // namespace docent::engine
