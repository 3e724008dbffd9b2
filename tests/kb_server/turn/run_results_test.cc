// Results of what nodes invoke, and what flows give back.
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class RunResults : public RunActionsTest {
 protected:
  // R1 offers the operations, which take `input`.
  void Describe(const std::vector<std::string>& operations, const std::string& input) {
    WriteBatch described = test::Tell({});
    for (const std::string& operation : operations) {
      const std::string iri = "urn:docent:operation:" + operation;
      for (const TermQuad& fact :
           {Fact("R1", "docent:offers", iri), Fact(iri, "docent:input", Term::Literal(input)),
            Fact(iri, "docent:inputsKnown", Term::Boolean(true))})
        described.operations.push_back({QuadOperation::Kind::kAdd, fact});
    }
    described.source = test::Name("R1");
    Must(described);
  }
  TurnResult Succeed(const TurnResult& sent, std::vector<std::pair<std::string, Term>> results) {
    EXPECT_EQ(sent.record.commands.size(), 1u);
    if (sent.record.commands.empty()) return {};
    WriteBatch report = test::Report(sent.record.commands[0].id, CommandReport::Outcome::kSucceeded);
    report.reports[0].results = std::move(results);
    return Must(report);
  }
};

TEST_F(RunResults, AResultOfAnOperationBecomesTheVariableOfItsName) {
  Must(test::WorldFacts());
  DeployOne("<invoke operation=\"greet\"/><ext:tell at=\"done\">w:out w:x $x</ext:tell>");
  Succeed(Run(), {{"x", Term::LangString("hallo", "de")}, {"robot", Term::Literal("R9")}});
  EXPECT_TRUE(Has(Fact("out", "x", Term::LangString("hallo", "de"))));
}

TEST_F(RunResults, AnOutputMapsIt) {
  Must(test::WorldFacts());
  DeployOne(
      "<invoke operation=\"greet\"><ext:output part=\"mood\" variable=\"y\"/></invoke>"
      "<ext:tell at=\"done\">w:out w:y $y</ext:tell><ext:assign at=\"done\" variable=\"y\" "
      "expression=\"BOUND($x)\"/>");
  const TurnResult done =
      Succeed(Run(), {{"mood", Term::Literal("glad")}, {"x", Term::Literal("not named")}});
  EXPECT_TRUE(Has(Fact("out", "y", Term::Literal("glad"))));
  EXPECT_THAT(Said(done), Contains(HasSubstr("variable $x has no value")));
}

TEST_F(RunResults, OfANamedOneThatIsNotGivenTheVariableHasNoValue) {
  Must(test::WorldFacts());
  DeployOne(
      "<invoke operation=\"greet\"><ext:output part=\"mood\" variable=\"x\"/></invoke>"
      "<ext:tell at=\"done\">w:out w:x $x</ext:tell>");
  const TurnResult done = Succeed(Run({{"x", Term::Literal("of before")}}), {});
  EXPECT_THAT(Said(done), Contains("F-1/A/0 running>done: there is no result mood: variable x has no value"));
  EXPECT_THAT(Said(done), Contains(HasSubstr("it cannot tell: variable $x has no value")));
}

TEST_F(RunResults, EachValueOfForEachHasItsOwnWhereFactsAreTold) {
  Must(test::WorldFacts());
  Must(test::Tell({Fact("b", "p", "b"), Fact("c", "p", "c"), Fact("d", "p", "d")}));
  Deploy("<node name=\"A\" ext:forEach=\"?place\" ext:sequential=\"true\">" + When("?place", "w:p", "?any") +
             "<invoke operation=\"greet\"><ext:output part=\"mood\" variable=\"x\"/></invoke><ext:tell "
             "at=\"done\">?place w:x $x</ext:tell></node>",
         {"A"});
  TurnResult turn = Run();
  for (const int64_t mood : {10, 20, 30}) turn = Succeed(turn, {{"mood", Term::Integer(mood)}});
  EXPECT_TRUE(Has(Fact("b", "x", Term::Integer(10))));
  EXPECT_TRUE(Has(Fact("c", "x", Term::Integer(20))));
  EXPECT_TRUE(Has(Fact("d", "x", Term::Integer(30))));
  EXPECT_FALSE(Has(Fact("b", "x", Term::Integer(30))));
}

TEST_F(RunResults, OneOfForEachThatIsNotGivenIsNotThatOfAnother) {
  Must(test::WorldFacts());
  Must(test::Tell({Fact("b", "p", "b"), Fact("c", "p", "c")}));
  Deploy("<node name=\"A\" ext:forEach=\"?place\" ext:sequential=\"true\">" + When("?place", "w:p", "?any") +
             "<invoke operation=\"greet\"><ext:output part=\"mood\" variable=\"x\"/></invoke><ext:tell "
             "at=\"done\">?place w:x $x</ext:tell></node>",
         {"A"});
  TurnResult turn = Succeed(Run(), {});
  turn = Succeed(turn, {{"mood", Term::Integer(20)}});
  EXPECT_THAT(Said(turn), Contains(HasSubstr("it cannot tell: variable $x has no value")));
}

TEST_F(RunResults, NamesThatNoVariableCanHaveAreRefused) {
  Must(test::WorldFacts());
  DeployOne("<invoke operation=\"greet\"/><ext:tell at=\"done\">w:out w:x $x</ext:tell>");
  const TurnResult done = Succeed(Run(), {{"x", Term::Integer(1)},
                                          {"a b", Term::Integer(2)},
                                          {"$x", Term::Integer(3)},
                                          {"1", Term::Integer(4)}});
  EXPECT_TRUE(Has(Fact("out", "x", Term::Integer(1))));
  EXPECT_THAT(Said(done), Contains(HasSubstr("3 results are refused, the first is \"$x\"")));
}

TEST_F(RunResults, ASubflowGivesNothingBackOfItsInputs) {
  Must(test::WorldFacts());
  Must(test::Put(
      Document::Kind::kCawl, "w.xml",
      "<CAWL name=\"W\" xmlns:w=\"urn:w:\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">"
      "<flow name=\"F\"><variable name=\"x\"/><variable name=\"y\"/><source name=\"s\"/>"
      "<node name=\"A\"><invoke subflow=\"Sub\"><ext:input part=\"x\" expression=\"w:own\"/></invoke></node>"
      "<node name=\"B\"><ext:tell>w:out w:y $y</ext:tell><ext:tell>w:out w:x $x</ext:tell></node><sink "
      "name=\"e\"/>"
      "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/><link from=\"B\" to=\"e\"/></flow>"
      "<flow name=\"Sub\"><variable name=\"x\"/><variable name=\"y\"/><source name=\"s\"/><node "
      "name=\"A\"><ext:assign variable=\"y\" expression=\"$x\"/></node><sink name=\"e\"/>"
      "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/></flow></CAWL>"));
  const TurnResult turn = Run();
  EXPECT_TRUE(Has(Fact("out", "y", "own")));
  EXPECT_THAT(Said(turn), Contains(HasSubstr("variable $x has no value")));
}

TEST_F(RunResults, AResultOfAWrongTypeIsRefusedAndRecorded) {
  Must(test::WorldFacts());
  Deploy("<node name=\"A\"><invoke operation=\"greet\"/></node>", {"A"},
         "<variable name=\"n\" type=\"xsd:decimal\"/>");
  const TurnResult done = Succeed(Run(), {{"n", Term::Literal("warm")}});
  EXPECT_THAT(Said(done), Contains("F-1/A/0 running>done: the result for variable n is refused: $n is "
                                   "of type xsd:decimal, and \"warm\" is of type xsd:string"));
  EXPECT_THAT(Said(done), Contains(HasSubstr("F-1 running>done")));
}

TEST_F(RunResults, WhatIsUndoneGetsThoseOfItsOwnValue) {
  Must(test::WorldFacts());
  Describe({"greet", "unbook"}, "slot");
  Must(test::Tell({Fact("b", "p", "b"), Fact("c", "p", "c")}));
  Deploy("<node name=\"A\" ext:forEach=\"?place\" ext:sequential=\"true\" ext:compensate=\"unbook\">" +
             When("?place", "w:p", "?any") +
             "<invoke operation=\"greet\"/></node><node name=\"B\"><ext:assign "
             "variable=\"x\" expression=\"$y\"/></node>",
         {"A", "B"});
  TurnResult turn = Run({{"slot", Term::Integer(0)}});
  turn = Succeed(turn, {{"slot", Term::Integer(1)}});
  turn = Succeed(turn, {{"slot", Term::Integer(2)}});
  for (const int64_t slot : {2, 1}) {
    ASSERT_EQ(turn.record.commands.size(), 1u) << slot;
    EXPECT_EQ(turn.record.commands[0].arguments.begin()->second, Term::Integer(slot));
    turn = Succeed(turn, {});
  }
  EXPECT_THAT(Said(turn), Contains(HasSubstr("what it did was undone")));
}

// The others of its forEach are undone though their node is not done.
TEST_F(RunResults, WhatIsDoneOfANodeThatFailsIsUndone) {
  Must(test::WorldFacts());
  Describe({"greet", "unbook"}, "slot");
  Must(test::Tell({Fact("b", "p", "b"), Fact("c", "p", "c")}));
  Deploy("<node name=\"A\" ext:forEach=\"?place\" ext:sequential=\"true\" ext:compensate=\"unbook\">" +
             When("?place", "w:p", "?any") + "<invoke operation=\"greet\"/></node>",
         {"A"});
  TurnResult turn = Succeed(Run({{"slot", Term::Integer(0)}}), {{"slot", Term::Integer(1)}});
  turn = Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kFailed));
  ASSERT_EQ(turn.record.commands.size(), 1u);
  EXPECT_EQ(turn.record.commands[0].operation, "unbook");
  EXPECT_EQ(turn.record.commands[0].arguments.begin()->second, Term::Integer(1));
  EXPECT_THAT(Said(Succeed(turn, {})), Contains(HasSubstr("what it did was undone")));
}

TEST_F(RunResults, OfAPartThatWasDoneItIsSaidThatItStays) {
  Must(test::WorldFacts());
  Describe({"greet", "unbook"}, "slot");
  DeployOne("<invoke operation=\"greet\"/><invoke operation=\"wave\" ext:timeout=\"1s\"/>");
  Deploy(
      "<node name=\"A\" ext:compensate=\"unbook\"><invoke operation=\"greet\"/><invoke operation=\"wave\" "
      "ext:timeout=\"1s\"/></node>",
      {"A"});
  Succeed(Run({{"slot", Term::Integer(0)}}), {});
  now_us_ += 2'000'000;
  WriteBatch tick;
  tick.clock_tick = true;
  EXPECT_THAT(Said(Must(tick)), Contains(HasSubstr("not undone: A: only a part of it was done")));
}

TEST_F(RunResults, ASubflowGivesBackWhatItSays) {
  Must(test::Put(
      Document::Kind::kCawl, "w.xml",
      "<CAWL name=\"W\" xmlns:w=\"urn:w:\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">"
      "<flow name=\"F\"><variable name=\"x\"><initialize><from "
      "expression=\"w:old\"/></initialize></variable><variable name=\"secret\"/><source name=\"s\"/>"
      "<node name=\"A\"><invoke subflow=\"Sub\"/></node><node name=\"B\"><ext:tell>w:out w:x "
      "$x</ext:tell></node>"
      "<node name=\"C\"><ext:tell>w:out w:secret $secret</ext:tell></node><sink name=\"e\"/>"
      "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/><link from=\"B\" to=\"C\"/><link from=\"C\" "
      "to=\"e\"/></flow>"
      "<flow name=\"Sub\"><variable name=\"y\"/><variable name=\"secret\"/><source name=\"s\"/>"
      "<node name=\"A\"><ext:assign variable=\"y\" expression=\"w:new\"/><ext:assign variable=\"secret\" "
      "expression=\"1\"/></node><sink name=\"e\"/>"
      "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/><ext:output part=\"x\" "
      "variable=\"y\"/></flow></CAWL>"));
  const TurnResult turn = Run();
  EXPECT_TRUE(Has(Fact("out", "x", "new")));
  EXPECT_THAT(Said(turn), Contains(HasSubstr("variable $secret has no value")));
  EXPECT_TRUE(Has(Fact("urn:docent:run:Sub-2", "docent:hasResult", "urn:docent:run:Sub-2/=x")));
}

}  // namespace
}  // namespace docent::server
