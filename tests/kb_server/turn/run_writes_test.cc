// Facts that runs of workflows tell and withdraw: what the graph has after the turn, and what is refused.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/workflow_limits.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Start;
using test::Tell;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using RunWrites = RunActionsTest;

const std::vector<std::string> kOfRun1 = {"urn:docent:run:F-1"};

TEST_F(RunWrites, ATellIsAFactOfTheRun) {
  DeployOne("<ext:tell>$x w:sees w:Door</ext:tell>");
  const TurnResult turn = Run({{"x", test::Iri("John")}});
  EXPECT_EQ(Sources(Fact("John", "sees", "Door")), kOfRun1);
  EXPECT_THAT(Said(turn),
              Contains("F-1/A running>running: told 1 fact: <urn:w:John> <urn:w:sees> <urn:w:Door>"));
  EXPECT_THAT(Said(turn), Contains(HasSubstr("F-1 running>done")));
}

TEST_F(RunWrites, ConstraintsAndLinesMaySayIt) {
  DeployOne(
      "<ext:tell>\n w:it w:p \"x y\"@en\n\n   w:b w:p 7 \n</ext:tell>"
      "<ext:tell "
      "ext:at=\"open\"><constraint><subject>w:c</subject><verb>a</verb><object>w:D</object></constraint></"
      "ext:tell>");
  Run();
  EXPECT_TRUE(Has(Fact("it", "p", Term::LangString("x y", "en"))));
  EXPECT_TRUE(Has(Fact("b", "p", Term::Integer(7))));
  EXPECT_TRUE(Has(Fact("c", "a", "D")));
}

TEST_F(RunWrites, AFactThatStandsAlreadyIsToldByTwo) {
  WriteBatch other = Tell({Fact("it", "p", "b")});
  other.source = "urn:w:Camera";
  Must(other);
  DeployOne("<ext:tell>w:it w:p w:b</ext:tell>");
  Run();
  EXPECT_EQ(Sources(Fact("it", "p", "b")), (std::vector<std::string>{"urn:docent:run:F-1", "urn:w:Camera"}));
}

TEST_F(RunWrites, AStatePropertyHasOneValueOfEachSource) {
  Must(Tell({Fact("docent:isAt", "a", "docent:StateProperty")}));
  WriteBatch other = Tell({Fact("John", "docent:isAt", "Hall")});
  other.source = "urn:w:Camera";
  Must(other);
  Deploy(
      "<node name=\"A\"><ext:tell>w:John docent:isAt w:Cellar</ext:tell></node>"
      "<node name=\"B\"><ext:tell>w:John docent:isAt w:Garden</ext:tell></node>",
      {"A", "B"});
  Run();
  EXPECT_FALSE(Has(Fact("John", "docent:isAt", "Cellar")));
  EXPECT_EQ(Sources(Fact("John", "docent:isAt", "Garden")), kOfRun1);
  EXPECT_TRUE(Has(Fact("John", "docent:isAt", "Hall")));
}

// Not that of ids, which are others after a start: a replay would say something else.
TEST_F(RunWrites, WhatIsWithdrawnIsInTermOrder) {
  Must(Tell({Fact("it", "p", "z"), Fact("it", "p", "b"), Fact("it", "p", "m")}));
  Must(Tell({Fact("it", "p", "Ant")}));
  DeployOne("<ext:withdraw source=\"any\">w:it w:p ?what</ext:withdraw>");
  EXPECT_THAT(Said(Run()),
              Contains(HasSubstr("withdrew 4 facts, the first: <urn:w:it> <urn:w:p> <urn:w:Ant>")));
}

TEST_F(RunWrites, RulesAndConditionsSeeItInTheSameTurn) {
  Must(Put(Document::Kind::kRules, "r.rules",
           "PREFIX w: <urn:w:>\nRULE { ?a w:knows ?b } WHERE { ?a w:met ?b }"));
  Deploy("<node name=\"A\"><ext:tell>w:it w:met w:b</ext:tell></node><node name=\"B\">" +
             When("w:it", "w:knows", "?y") + "<ext:tell>w:it w:greeted ?y</ext:tell></node>",
         {"A", "B"});
  Run();
  EXPECT_TRUE(Has(Fact("it", "greeted", "b")));
}

TEST_F(RunWrites, AtDoneIsAfterTheInvokes) {
  Must(test::WorldFacts());
  DeployOne(
      "<invoke operation=\"greet\"/><ext:tell>w:it w:p w:open</ext:tell><ext:tell at=\"done\">w:it w:p "
      "w:done</ext:tell>");
  const TurnResult turn = Run();
  ASSERT_EQ(turn.record.commands.size(), 1u);
  EXPECT_TRUE(Has(Fact("it", "p", "open")));
  EXPECT_FALSE(Has(Fact("it", "p", "done")));
  Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_TRUE(Has(Fact("it", "p", "done")));
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

constexpr char kTakesBack[] = "<ext:withdraw source=\"any\">w:it w:p ?any</ext:withdraw>";

TEST_F(RunWrites, WhatItWritesAtOpenDoesNotCloseItsOwnGuard) {
  Must(test::WorldFacts());
  Must(Tell({Fact("it", "p", "b")}));
  DeployOne(When("w:it", "w:p", "?y") + "<invoke operation=\"greet\"/>" + kTakesBack);
  EXPECT_EQ(Run().record.commands.size(), 1u);
}

TEST_F(RunWrites, NorWhereItWaitsForItsRobot) {
  Must(test::WorldFacts());
  Must(Tell({Fact("R1", "docent:status", "docent:Charging")}));
  Must(Tell({Fact("it", "p", "b")}));
  DeployOne(When("w:it", "w:p", "?y") + "<invoke operation=\"greet\"/>" + kTakesBack);
  EXPECT_TRUE(Run().record.commands.empty());
  EXPECT_EQ(Must(Tell({Fact("R1", "docent:status", "docent:Standby")})).record.commands.size(), 1u);
}

TEST_F(RunWrites, NorWhereAnEventOpensItToo) {
  Must(test::WorldFacts());
  Must(Tell({Fact("it", "p", "b")}));
  DeployOne(WhenRungAnd("w:it", "w:p", "?y") + "<invoke operation=\"greet\"/>" + kTakesBack);
  Run();
  EXPECT_EQ(Ring().record.commands.size(), 1u);
}

TEST_F(RunWrites, NorWhereItWaitsForADeliveryAndThenForItsRobot) {
  for (const bool by_event : {false, true}) {
    Must(test::WorldFacts());
    Must(Tell({Fact("R1", "docent:status", "docent:Charging")}));
    Must(Tell({Fact("it", "p", "b")}));
    DeployOne((by_event ? WhenRungAnd("w:it", "w:p", "?y") : When("w:it", "w:p", "?y")) +
              "<invoke operation=\"greet\"/>" + kTakesBack + "<ext:notify to=\"mqtt:a/b\" wait=\"true\"/>");
    const TurnResult run = Run();
    const TurnResult opened = by_event ? Ring() : run;
    ASSERT_EQ(opened.notifications.size(), 1u);
    EXPECT_THAT(opened.record.commands, IsEmpty());
    const TurnResult delivered =
        Must(test::Report(opened.notifications[0].id, CommandReport::Outcome::kSucceeded));
    EXPECT_THAT(delivered.record.commands, IsEmpty());
    const TurnResult charged = Must(Tell({Fact("R1", "docent:status", "docent:Standby")}));
    ASSERT_EQ(charged.record.commands.size(), 1u) << by_event;
    Must(test::Report(charged.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  }
}

TEST_F(RunWrites, NorWhereItMakesFallWhatHasToHold) {
  Must(test::WorldFacts());
  Must(Tell({Fact("it", "p", "b")}));
  Deploy("<node name=\"A\" ext:while-holds=\"w:it w:p ?y\"><invoke operation=\"greet\"/>" +
             std::string(kTakesBack) + "</node>",
         {"A"});
  EXPECT_TRUE(Run().record.commands.empty());
  EXPECT_EQ(Must(Tell({Fact("it", "p", "b")})).record.commands.size(), 1u);
}

TEST_F(RunWrites, NorWhereAParallelNodeDoes) {
  Must(test::WorldFacts());
  Must(Tell({Fact("it", "p", "b")}));
  Deploy("<node name=\"A\">" + std::string(kTakesBack) + "</node><node name=\"B\">" +
             When("w:it", "w:p", "?y") + "<invoke operation=\"greet\"/></node>",
         {}, "",
         "<link from=\"s\" to=\"A\"/><link from=\"s\" to=\"B\"/><link from=\"A\" to=\"e\"/><link from=\"B\" "
         "to=\"e\"/>");
  EXPECT_TRUE(Run().record.commands.empty());
}

TEST_F(RunWrites, WhatItTellsDoesNotKeepItFromSending) {
  Must(test::WorldFacts());
  Must(Tell({Fact("it", "p", "b")}));
  DeployOne(When("w:it", "w:p", "?y") + "<invoke operation=\"greet\"/><ext:tell>w:it w:q ?y</ext:tell>");
  EXPECT_EQ(Run().record.commands.size(), 1u);
}

TEST_F(RunWrites, AnEventThatOpensANodeThatWritesSendsItsCommand) {
  Must(test::WorldFacts());
  DeployOne(
      "<condition><case><event operation=\"ring\"/></case></condition><invoke operation=\"greet\"/>"
      "<ext:tell>w:it w:q w:c</ext:tell>");
  Run();
  EXPECT_EQ(Ring().record.commands.size(), 1u);
}

TEST_F(RunWrites, WhatFailsIsNotToldAtDone) {
  Must(test::WorldFacts());
  DeployOne("<invoke operation=\"greet\"/><ext:tell at=\"done\">w:it w:p w:done</ext:tell>");
  const TurnResult turn = Run();
  Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kFailed));
  EXPECT_FALSE(Has(Fact("it", "p", "done")));
}

TEST_F(RunWrites, FactsStayAfterTheRunUnlessTheirLifetimeIsIt) {
  Must(test::WorldFacts());
  DeployOne(
      "<ext:tell>w:it w:p w:stays</ext:tell><ext:tell lifetime=\"run\">w:it w:p w:goes</ext:tell>"
      "<ext:tell ext:lifetime=\"2s\">w:it w:p w:ends</ext:tell><invoke operation=\"greet\"/>");
  const TurnResult turn = Run();
  EXPECT_TRUE(Has(Fact("it", "p", "stays")));
  EXPECT_TRUE(Has(Fact("it", "p", "goes")));
  EXPECT_TRUE(Has(Fact("it", "p", "ends")));
  Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
  EXPECT_TRUE(Has(Fact("it", "p", "stays")));
  EXPECT_FALSE(Has(Fact("it", "p", "goes")));
  EXPECT_TRUE(Has(Fact("it", "p", "ends")));
  now_us_ += 2'000'000;
  WriteBatch tick;
  tick.clock_tick = true;
  Must(tick);
  EXPECT_FALSE(Has(Fact("it", "p", "ends")));
}

TEST_F(RunWrites, ACancelledRunTakesItsFactsAlong) {
  DeployOne(When("w:never", "w:is", "w:so"));
  Deploy("<node name=\"A\"><ext:tell lifetime=\"run\">w:it w:p w:b</ext:tell></node><node name=\"B\">" +
             When("w:never", "w:is", "w:so") + "</node>",
         {"A", "B"});
  Run();
  EXPECT_TRUE(Has(Fact("it", "p", "b")));
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "F-1", {}});
  Must(cancel);
  EXPECT_FALSE(Has(Fact("it", "p", "b")));
}

// A resource that a run has told that it uses is not free before its robot stands.
TEST_F(RunWrites, FactsOfARunThatIsCancelledStayUntilItsCommandsHaveEnded) {
  Must(test::WorldFacts());
  DeployOne("<ext:tell lifetime=\"run\">w:Lift w:inUseBy $x</ext:tell><invoke operation=\"greet\"/>");
  const TurnResult turn = Run({{"x", test::Iri("John")}});
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "F-1", {}});
  Must(cancel);
  EXPECT_TRUE(Has(Fact("Lift", "inUseBy", "John"))) << "the robot still rides";
  Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kCancelled));
  EXPECT_FALSE(Has(Fact("Lift", "inUseBy", "John")));
}

TEST_F(RunWrites, AlsoThoseOfASubflowAndOfTheRunAroundIt) {
  Must(test::WorldFacts());
  Must(test::Put(
      Document::Kind::kCawl, "w.xml",
      "<CAWL name=\"W\" xmlns:w=\"urn:w:\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">"
      "<flow name=\"F\"><source name=\"s\"/><node name=\"A\"><ext:tell lifetime=\"run\">w:Lift w:inUseBy "
      "w:outer</ext:tell><invoke subflow=\"Sub\"/></node><sink name=\"e\"/><link from=\"s\" to=\"A\"/><link "
      "from=\"A\" to=\"e\"/></flow>"
      "<flow name=\"Sub\"><source name=\"s\"/><node name=\"A\"><ext:tell lifetime=\"run\">w:Door w:inUseBy "
      "w:inner</ext:tell><invoke operation=\"greet\"/></node><sink name=\"e\"/><link from=\"s\" "
      "to=\"A\"/><link "
      "from=\"A\" to=\"e\"/></flow></CAWL>"));
  const TurnResult turn = Run();
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "F-1", {}});
  Must(cancel);
  EXPECT_TRUE(Has(Fact("Lift", "inUseBy", "outer")));
  EXPECT_TRUE(Has(Fact("Door", "inUseBy", "inner")));
  Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kCancelled));
  EXPECT_FALSE(Has(Fact("Lift", "inUseBy", "outer")));
  EXPECT_FALSE(Has(Fact("Door", "inUseBy", "inner")));
}

TEST_F(RunWrites, AWithdrawTakesWhatTheRunTold) {
  WriteBatch other = Tell({Fact("it", "p", "b")});
  other.source = "urn:w:Camera";
  Must(other);
  Deploy(
      "<node name=\"A\"><ext:tell>w:it w:p w:b\nw:it w:p w:c</ext:tell></node>"
      "<node name=\"B\"><ext:withdraw>w:it w:p ?any</ext:withdraw></node>",
      {"A", "B"});
  const TurnResult turn = Run();
  EXPECT_EQ(Sources(Fact("it", "p", "b")), (std::vector<std::string>{"urn:w:Camera"}));
  EXPECT_FALSE(Has(Fact("it", "p", "c")));
  EXPECT_THAT(Said(turn), Contains(HasSubstr("withdrew 2 facts, the first: ")));
}

TEST_F(RunWrites, AWithdrawOfAnothersFactNeedsSourceAny) {
  Must(Tell({Fact("it", "p", "b")}));
  Deploy(
      "<node name=\"A\"><ext:withdraw>w:it w:p w:b</ext:withdraw><ext:tell>w:it w:still w:b</ext:tell></node>"
      "<node name=\"B\"><ext:withdraw source=\"any\">w:it w:p w:b</ext:withdraw></node>",
      {"A", "B"});
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn), Contains(HasSubstr("withdrew nothing: what matches was told by others")));
  EXPECT_TRUE(Has(Fact("it", "still", "b")));
  EXPECT_FALSE(Has(Fact("it", "p", "b")));
}

TEST_F(RunWrites, AWithdrawOfNothingIsNoFailure) {
  DeployOne("<ext:withdraw>w:it w:p w:b</ext:withdraw>");
  EXPECT_THAT(Said(Run()), Contains("F-1/A running>running: withdrew nothing"));
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

TEST_F(RunWrites, AnInferredFactCannotBeWithdrawn) {
  Must(Put(Document::Kind::kRules, "r.rules",
           "PREFIX w: <urn:w:>\nRULE { ?a w:knows ?b } WHERE { ?a w:met ?b }"));
  Must(Tell({Fact("it", "met", "b")}));
  DeployOne("<ext:withdraw source=\"any\">w:it w:knows ?who</ext:withdraw>");
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn), Contains(HasSubstr("F-1/A running>failed: it cannot withdraw: nothing told matches "
                                             "w:it w:knows ?who; rules derive it")));
  EXPECT_TRUE(Has(Fact("it", "knows", "b")));
}

TEST_F(RunWrites, OneNameTwiceIsOneValue) {
  Must(Tell({Fact("it", "p", "it"), Fact("it", "p", "b")}));
  DeployOne("<ext:withdraw source=\"any\">?t w:p ?t</ext:withdraw>");
  Run();
  EXPECT_FALSE(Has(Fact("it", "p", "it")));
  EXPECT_TRUE(Has(Fact("it", "p", "b")));
}

TEST_F(RunWrites, AMatchBindsWhatIsWithdrawn) {
  Must(Tell({Fact("it", "done", "x"), Fact("j", "p", "it"), Fact("j", "p", "b")}));
  DeployOne(When("?what", "w:done", "w:x") + "<ext:withdraw source=\"any\">w:j w:p ?what</ext:withdraw>");
  Run();
  EXPECT_FALSE(Has(Fact("j", "p", "it")));
  EXPECT_TRUE(Has(Fact("j", "p", "b")));
}

TEST_F(RunWrites, AVariableWithoutAValueFailsTheNodeAndNothingOfItIsTold) {
  DeployOne("<ext:tell>w:it w:p w:b\nw:it w:p $x</ext:tell>");
  EXPECT_THAT(Said(Run()), Contains("F-1/A running>failed: it cannot tell: variable $x has no value"));
  EXPECT_FALSE(Has(Fact("it", "p", "b")));
}

TEST_F(RunWrites, ALiteralAsSubjectFailsTheNode) {
  DeployOne("<ext:tell>$x w:p w:b</ext:tell>");
  EXPECT_THAT(Said(Run({{"x", Term::Literal("text")}})),
              Contains(HasSubstr("F-1/A running>failed: it cannot tell: subject: ")));
}

TEST_F(RunWrites, ALiteralOrABlankNodeAsVerbFailsTheNode) {
  DeployOne("<ext:tell>w:it $x w:b</ext:tell>");
  EXPECT_THAT(Said(Run({{"x", Term::Literal("text")}})), Contains(HasSubstr("it cannot tell: predicate: ")));
  EXPECT_THAT(Said(Run({{"x", Term::Blank("b0")}})), Contains(HasSubstr("it cannot tell: predicate: ")));
}

TEST_F(RunWrites, AFailureOfATellIsAFailureOfTheNodeAsAnyOther) {
  Deploy("<node name=\"A\" ext:retry=\"3\"><ext:tell>$x w:p w:b</ext:tell></node><node name=\"Sorry\"/>", {},
         "",
         "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/><link from=\"A\" to=\"Sorry\" "
         "ext:onFailure=\"true\"/>"
         "<link from=\"Sorry\" to=\"e\"/>");
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn), Contains(HasSubstr("F-1/Sorry running>done")));
  EXPECT_THAT(Said(turn), Contains(HasSubstr("F-1 running>done")));
}

TEST_F(RunWrites, BlankNodesTaggedTextAndNaNAreTerms) {
  Must(Tell({{Term::Blank("b1"), test::Iri("is"), test::Iri("here"), Term()}}));
  Deploy("<node name=\"A\">" + When("?thing", "w:is", "w:here") +
             "<ext:tell>?thing w:seen true\nw:it w:says $x\nw:it w:n $y</ext:tell></node>",
         {"A"});
  const Term nan = Term::Literal("NaN", std::string(kXsdNs) + "double");
  Run({{"x", Term::LangString("Grüezi", "de-CH")}, {"y", nan}});
  EXPECT_TRUE(Has(Fact("it", "says", Term::LangString("Grüezi", "de-CH"))));
  EXPECT_TRUE(Has(Fact("it", "n", nan)));
  size_t of_blank = 0;
  stages_.writer.current().ForEach({{}, *dictionary_.FindIri("urn:w:seen"), {}, {}}, [&](const Quad& quad) {
    of_blank += dictionary_.Decode(quad.subject).IsBlank();
    return true;
  });
  EXPECT_EQ(of_blank, 1u);
}

TEST_F(RunWrites, EachBindingOfForEachIsTold) {
  WriteBatch many = Tell({});
  for (int i = 0; i < 1000; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "a", "Thing")});
  Must(many);
  std::string lines;
  for (int i = 0; i < 10; ++i) absl::StrAppend(&lines, "?n w:p", i, " w:v\n");
  Deploy("<node name=\"A\" ext:forEach=\"?n\">" + When("?n", "a", "w:Thing") + "<ext:tell lifetime=\"run\">" +
             lines +
             "</ext:tell></node>"
             "<node name=\"B\"><ext:withdraw>?n w:p3 ?v</ext:withdraw></node><node name=\"C\">" +
             When("w:now", "w:end", "w:x") + "</node>",
         {"A", "B", "C"});
  const size_t before = Size();
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn), Contains(HasSubstr("told 10000 facts")));
  EXPECT_THAT(Said(turn), Contains(HasSubstr("withdrew 1000 facts")));
  EXPECT_TRUE(Has(Fact("n999", "p9", "v")));
  EXPECT_FALSE(Has(Fact("n999", "p3", "v")));
  Must(Tell({Fact("now", "end", "x")}));
  EXPECT_FALSE(Has(Fact("n999", "p9", "v")));
  EXPECT_LT(Size(), before + 200);
}

TEST_F(RunWrites, TenThousandRunsThatTellInOneTurn) {
  Deploy("<node name=\"A\"><ext:tell>$n w:seen true</ext:tell></node>", {"A"},
         "<variable name=\"n\"/><activator name=\"On\"><activate flow=\"F\"/>" + When("?n", "a", "w:Thing") +
             "</activator>");
  WriteBatch many = Tell({});
  for (int i = 0; i < 10000; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "a", "Thing")});
  Must(many);
  EXPECT_TRUE(Has(Fact("n0", "seen", Term::Boolean(true))));
  EXPECT_TRUE(Has(Fact("n9999", "seen", Term::Boolean(true))));
}

TEST_F(RunWrites, MoreFactsThanTheLimitOfATurnFailTheNode) {
  WriteBatch many = Tell({});
  for (int i = 0; i < 1000; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "a", "Thing")});
  Must(many);
  const auto of = [&](size_t facts) {
    std::string lines;
    for (size_t i = 0; i < facts; ++i) absl::StrAppend(&lines, "?n w:p", i, " w:v\n");
    return "<ext:tell>" + lines + "</ext:tell>";
  };
  const size_t most = kWorkflowLimits.facts_written_per_turn / 1000;
  Deploy("<node name=\"A\" ext:forEach=\"?n\">" + When("?n", "a", "w:Thing") + of(most) + "</node>", {"A"});
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("running>done")));
  Deploy("<node name=\"A\" ext:forEach=\"?n\">" + When("?n", "a", "w:Thing") + of(most + 1) + "</node>",
         {"A"});
  EXPECT_THAT(Said(Run()),
              Contains(HasSubstr("F-2/A running>failed: runs would tell and withdraw more than 100000 facts "
                                 "in one turn; the limit is facts_written_per_turn")));
}

TEST_F(RunWrites, ALoopThatTellsAndDoesNotWaitEnds) {
  Deploy("<node name=\"A\"><ext:tell>w:it w:p w:b</ext:tell></node>", {}, "",
         "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"A\" ext:while=\"w:it w:p w:b\"/><link from=\"A\" "
         "to=\"e\"/>");
  Run();
  EXPECT_EQ(stages_.engine.live_runs(), 1u) << "it goes on in later turns";
  EXPECT_THAT(Settle(), Contains(HasSubstr("F-1 running>failed: node A was entered 10000 times")));
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

// Each reads what the one before told: a round for each.
TEST_F(RunWrites, ALongRowOfNodesGoesOnInTheNextTurn) {
  std::string nodes;
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) {
    names.push_back(absl::StrCat("N", i));
    absl::StrAppend(&nodes, "<node name=\"", names.back(), "\">",
                    i == 0 ? "" : When("w:it", "w:at", absl::StrCat(i - 1)), "<ext:tell>w:it w:at ", i,
                    "</ext:tell></node>");
  }
  Deploy(nodes, names);
  EXPECT_THAT(Said(Run()), Not(Contains(HasSubstr("failed"))));
  EXPECT_THAT(Settle(), Contains(HasSubstr("F-1 running>done")));
  EXPECT_TRUE(Has(Fact("it", "at", Term::Integer(99))));
}

// The condition is asked again before each of them, and what they tell does not change it.
TEST_F(RunWrites, SubflowsOfEachValueThatTellAllBegin) {
  for (const char* way : {"<ext:tell>$n w:seen true</ext:tell>", "<ext:tell>$n a w:Seen</ext:tell>",
                          "<ext:tell at=\"done\">$n w:seen true</ext:tell>",
                          "<ext:withdraw source=\"any\">$n w:new true</ext:withdraw>"}) {
    WriteBatch many = Tell({});
    for (int i = 0; i < 1500; ++i) {
      many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "a", "Thing")});
      many.operations.push_back(
          {QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "new", Term::Boolean(true))});
    }
    Must(many);
    Deploy("<node name=\"A\" ext:forEach=\"?n\">" + When("?n", "a", "w:Thing") +
               "<invoke subflow=\"One\"/></node>",
           {"A"},
           absl::StrCat(
               "<flow name=\"One\"><variable name=\"n\"/><source name=\"s\"/><node name=\"T\">", way,
               "</node><sink name=\"e\"/><link from=\"s\" to=\"T\"/><link from=\"T\" to=\"e\"/></flow>"));
    Must(test::Start("W/F"));
    Settle();
    EXPECT_EQ(stages_.engine.live_runs(), 0u) << way;
  }
  EXPECT_TRUE(Has(Fact("n1499", "seen", Term::Boolean(true))));
  EXPECT_TRUE(Has(Fact("n1499", "a", "Seen")));
  EXPECT_FALSE(Has(Fact("n1499", "new", Term::Boolean(true))));
}

TEST_F(RunWrites, ALoopThatTellsAndWaitsGoesOn) {
  Deploy("<node name=\"A\">" + When("w:tick", "w:is", "?t") +
             "<ext:withdraw source=\"any\">w:tick w:is ?t</ext:withdraw><ext:tell>w:it w:saw "
             "?t</ext:tell></node>",
         {}, "",
         "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"A\" ext:while=\"w:go w:on true\"/><link "
         "from=\"A\" to=\"e\"/>");
  Must(Tell({Fact("go", "on", Term::Boolean(true))}));
  Run();
  for (int i = 0; i < 100; ++i) Must(Tell({Fact("tick", "is", Term::Integer(i))}));
  EXPECT_TRUE(Has(Fact("it", "saw", Term::Integer(0))));
  EXPECT_TRUE(Has(Fact("it", "saw", Term::Integer(99))));
  EXPECT_EQ(stages_.engine.live_runs(), 1u);
}

TEST_F(RunWrites, RunsThatStartThemselvesAgainEndAndTheTurnStands) {
  Deploy(
      "<node name=\"A\"><ext:withdraw source=\"any\">w:it w:on ?any</ext:withdraw></node><node name=\"B\">" +
          When("w:x", "w:is", "w:x") + "<ext:tell>w:it w:on true</ext:tell></node>",
      {"A", "B"},
      "<activator name=\"On\"><activate flow=\"F\"/>" + When("w:it", "w:on", "true") + "</activator>");
  const TurnResult turn = Must(Tell({Fact("x", "is", "x"), Fact("it", "on", Term::Boolean(true))}));
  EXPECT_THAT(Said(turn),
              Contains(HasSubstr("its own runs, or rules that read them, start it again; the limits are")));
  EXPECT_TRUE(Has(Fact("x", "is", "x"))) << "the turn is not refused";
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

TEST_F(RunWrites, ATurnThatIsRefusedTellsNothing) {
  DeployOne("<ext:tell>w:it w:p w:b</ext:tell>");
  WriteBatch bad = Start("W");
  bad.run_requests.push_back({RunRequest::Kind::kStart, "None", {}});
  bad.time_us = now_us_ += 1000;
  EXPECT_FALSE(RunTurn(&stages_, bad, head_ + 1).ok());
  EXPECT_FALSE(Has(Fact("it", "p", "b")));
  Run();
  EXPECT_TRUE(Has(Fact("it", "p", "b")));
}

}  // namespace
}  // namespace docent::server
