// Inputs of invocations that a node gives itself: ext:input.
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Tell;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

class RunInputs : public RunActionsTest {
 protected:
  using Arguments = decltype(RobotCommand::arguments);

  static std::vector<Arguments> Sent(const TurnResult& turn) {
    std::vector<Arguments> sent;
    for (const RobotCommand& command : turn.record.commands) sent.push_back(command.arguments);
    return sent;
  }
  TurnResult Report(const TurnResult& sent, CommandReport::Outcome outcome) {
    EXPECT_EQ(sent.record.commands.size(), 1u);
    if (sent.record.commands.empty()) return {};
    return Must(test::Report(sent.record.commands[0].id, outcome));
  }
};

// greet takes `user` (test_world.h).
constexpr char kGreetX[] = "<invoke operation=\"greet\"><ext:input part=\"user\" variable=\"x\"/></invoke>";

TEST_F(RunInputs, AVariableOfAnotherName) {
  Must(test::WorldFacts());
  DeployOne(kGreetX);
  EXPECT_THAT(Sent(Run({{"x", test::Iri("John")}})),
              ElementsAre(ElementsAre(Pair("user", test::Iri("John")))));
}

TEST_F(RunInputs, AnExpressionSetsNoVariable) {
  Must(test::WorldFacts());
  DeployOne(
      "<invoke operation=\"greet\"><ext:input part=\"user\" expression=\"CONCAT('Dr. ', $x)\"/></invoke>"
      "<ext:tell at=\"done\">w:out w:x $x</ext:tell>");
  const TurnResult sent = Run({{"x", Term::Literal("Kim")}, {"user", Term::Literal("nobody")}});
  EXPECT_THAT(Sent(sent), ElementsAre(ElementsAre(Pair("user", Term::Literal("Dr. Kim")))));
  Report(sent, CommandReport::Outcome::kSucceeded);
  EXPECT_TRUE(Has(Fact("out", "x", Term::Literal("Kim"))));
}

// With ext:assign, the second text would be in the variable when the robot is free for the first.
TEST_F(RunInputs, StepsBesideEachOtherKeepTheirOwn) {
  Must(test::WorldFacts());
  const auto node = [](const std::string& name) {
    return "<node name=\"" + name + "\"><invoke operation=\"greet\"><ext:input part=\"user\" expression=\"'" +
           name + "'\"/></invoke></node>";
  };
  Deploy(node("A") + node("B"), {}, "",
         "<link from=\"s\" to=\"A\"/><link from=\"s\" to=\"B\"/><link from=\"A\" to=\"e\"/><link from=\"B\" "
         "to=\"e\"/>");
  const TurnResult first = Run();
  EXPECT_THAT(Sent(first), ElementsAre(ElementsAre(Pair("user", Term::Literal("A")))));
  const TurnResult second = Report(first, CommandReport::Outcome::kSucceeded);
  EXPECT_THAT(Sent(second), ElementsAre(ElementsAre(Pair("user", Term::Literal("B")))));
}

TEST_F(RunInputs, EachValueOfForEachHasItsOwn) {
  Must(test::WorldFacts());
  Must(Tell({Fact("b", "p", Term::Literal("one")), Fact("c", "p", Term::Literal("two"))}));
  Deploy("<node name=\"A\" ext:forEach=\"?place\" ext:sequential=\"true\">" + When("?place", "w:p", "?any") +
             "<invoke operation=\"greet\"><ext:input part=\"user\" expression=\"STRAFTER(STR($place), "
             "'urn:w:')\"/></invoke></node>",
         {"A"}, "<variable name=\"place\"/>");
  const TurnResult first = Run();
  EXPECT_THAT(Sent(first), ElementsAre(ElementsAre(Pair("user", Term::Literal("b")))));
  EXPECT_THAT(Sent(Report(first, CommandReport::Outcome::kSucceeded)),
              ElementsAre(ElementsAre(Pair("user", Term::Literal("c")))));
}

TEST_F(RunInputs, SeesWhatItsNodeTold) {
  Must(test::WorldFacts());
  DeployOne(
      "<ext:tell>w:it w:is w:told</ext:tell><invoke operation=\"greet\"><ext:input part=\"user\" "
      "expression=\"EXISTS { w:it w:is w:told }\"/></invoke>");
  EXPECT_THAT(Sent(Run()), ElementsAre(ElementsAre(Pair("user", Term::Boolean(true)))));
}

TEST_F(RunInputs, ANewAttemptTakesItAnew) {
  Must(test::WorldFacts());
  DeployOne(
      "<invoke operation=\"greet\" ext:retry=\"1\"><ext:input part=\"user\" expression=\"EXISTS { w:it w:is "
      "w:told }\"/></invoke>");
  const TurnResult first = Run();
  EXPECT_THAT(Sent(first), ElementsAre(ElementsAre(Pair("user", Term::Boolean(false)))));
  Must(Tell({Fact("it", "is", "told")}));
  EXPECT_THAT(Sent(Report(first, CommandReport::Outcome::kFailed)),
              ElementsAre(ElementsAre(Pair("user", Term::Boolean(true)))));
}

TEST_F(RunInputs, WithoutAValueItFailsAndSaysWhichInput) {
  Must(test::WorldFacts());
  DeployOne(kGreetX);
  const TurnResult none = Run();
  EXPECT_THAT(Sent(none), IsEmpty());
  EXPECT_THAT(Said(none), Contains(HasSubstr("there is no value for input user: variable $x has no value")));
  DeployOne("<invoke operation=\"greet\"><ext:input part=\"user\" expression=\"$x + 1\"/></invoke>");
  EXPECT_THAT(Said(Run({{"x", Term::Literal("text")}})),
              Contains(HasSubstr("there is no value for input user: $x + 1 has none")));
}

TEST_F(RunInputs, TheRobotMayBeOne) {
  Must(test::WorldFacts());
  DeployOne("<invoke operation=\"greet\"><ext:input part=\"robot\" variable=\"x\"/></invoke>");
  EXPECT_THAT(Sent(Run({{"x", test::Iri("R9")}})), IsEmpty());
  EXPECT_THAT(Sent(Run({{"x", test::Iri("R1")}})), ElementsAre(IsEmpty()));
}

TEST_F(RunInputs, WhatIsNoRobotFailsAtOnce) {
  Must(test::WorldFacts());
  DeployOne("<invoke operation=\"greet\"><ext:input part=\"robot\" variable=\"x\"/></invoke>");
  EXPECT_THAT(Said(Run({{"x", Term::Literal("R1")}})),
              Contains(HasSubstr("it has \"R1\" as its robot, which is no robot")));
}

TEST_F(RunInputs, TheRobotSaysOfWhatTypeTheyAre) {
  Must(test::WorldFacts());
  const std::string greet = "urn:docent:operation:greet";
  WriteBatch described = Tell({Fact("R1", "docent:offers", greet),
                               Fact(greet, "docent:input", Term::Literal("user")),
                               Fact(greet, "docent:inputsKnown", Term::Boolean(true)),
                               Fact(greet, "docent:inputPart", "part"),
                               Fact("part", "docent:partName", Term::Literal("user")),
                               {test::Iri("part"), Term::Iri(DocentIri("partType")),
                                Term::Iri(std::string(kXsdNs) + "decimal"), Term()}});
  described.source = test::Name("R1");
  Must(described);
  DeployOne("<invoke operation=\"greet\" ext:retry=\"3\"><ext:input part=\"user\" variable=\"x\"/></invoke>");
  const TurnResult wrong = Run({{"x", Term::Literal("ninety")}});
  EXPECT_THAT(Sent(wrong), IsEmpty());
  EXPECT_THAT(Said(wrong), Contains(HasSubstr("greet cannot take \"ninety\" as user, which is of xsd:string, "
                                              "not of xsd:decimal")));
  EXPECT_THAT(Sent(Run({{"x", Term::Integer(90)}})),
              ElementsAre(ElementsAre(Pair("user", Term::Integer(90)))));
}

TEST_F(RunInputs, ASubflowBeginsWithIt) {
  Must(test::Put(Document::Kind::kCawl, "w.xml",
                 "<CAWL name=\"W\" xmlns:w=\"urn:w:\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">"
                 "<flow name=\"F\"><variable name=\"x\"/><source name=\"s\"/><node name=\"A\">"
                 "<invoke subflow=\"Sub\"><ext:input part=\"y\" variable=\"x\"/><ext:input part=\"x\" "
                 "expression=\"w:own\"/></invoke></node><sink name=\"e\"/>"
                 "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/></flow>"
                 "<flow name=\"Sub\"><variable name=\"x\"/><variable name=\"y\"/><source name=\"s\"/><node "
                 "name=\"A\"><ext:tell>$x w:y $y</ext:tell></node><sink name=\"e\"/>"
                 "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/></flow></CAWL>"));
  Run({{"x", test::Iri("John")}});
  EXPECT_TRUE(Has(Fact("own", "y", "John")));
}

TEST_F(RunInputs, WhatIsUndoneGetsThemToo) {
  Must(test::WorldFacts());
  const std::string greet = "urn:docent:operation:greet";
  WriteBatch described =
      Tell({Fact("R1", "docent:offers", greet), Fact(greet, "docent:input", Term::Literal("user")),
            Fact(greet, "docent:inputsKnown", Term::Boolean(true))});
  described.source = test::Name("R1");
  Must(described);
  Deploy(
      "<node name=\"A\" ext:compensate=\"greet\"><invoke operation=\"greet\"><ext:input part=\"user\" "
      "expression=\"'A'\"/></invoke></node><node name=\"B\"><ext:assign variable=\"x\" "
      "expression=\"$y\"/></node>",
      {"A", "B"});
  const TurnResult undone = Report(Run(), CommandReport::Outcome::kSucceeded);
  EXPECT_THAT(Sent(undone), ElementsAre(ElementsAre(Pair("user", Term::Literal("A")))));
}

}  // namespace
}  // namespace docent::server
