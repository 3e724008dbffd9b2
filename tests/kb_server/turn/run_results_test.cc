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

TEST_F(RunResults, AResultOfAWrongTypeIsRefusedAndRecorded) {
  Must(test::WorldFacts());
  Deploy("<node name=\"A\"><invoke operation=\"greet\"/></node>", {"A"},
         "<variable name=\"n\" type=\"xsd:decimal\"/>");
  const TurnResult done = Succeed(Run(), {{"n", Term::Literal("warm")}});
  EXPECT_THAT(Said(done), Contains("F-1/A/0 running>running: the result for variable n is refused: $n is "
                                   "of type xsd:decimal, and \"warm\" is of type xsd:string"));
  EXPECT_THAT(Said(done), Contains(HasSubstr("F-1 running>done")));
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
