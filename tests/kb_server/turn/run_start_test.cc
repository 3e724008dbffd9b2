// Values that a run has to have from its beginning on: a start without them is refused, and names them.
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;
using ::testing::Contains;
using ::testing::HasSubstr;

class RunStartTest : public RunActionsTest {
 protected:
  // A workflow that a chosen ?user and ?place start, with one node.
  void DeployChosen(const std::string& node, const std::string& variables = "") {
    Must(Put(
        Document::Kind::kCawl, "w.xml",
        absl::StrCat(
            "<CAWL name=\"W\" xmlns:w=\"urn:w:\" "
            "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><activator name=\"A\"><activate "
            "flow=\"F\"/>",
            When("?user", "w:chose", "?place"), "</activator><flow name=\"F\">", variables,
            "<variable name=\"user\"/><variable name=\"place\"/><source name=\"s\"/><node name=\"N\">", node,
            "</node><sink name=\"e\"/><link from=\"s\" to=\"N\"/><link from=\"N\" "
            "to=\"e\"/></flow></CAWL>")));
  }
  std::string Asks(std::vector<std::pair<std::string, Term>> variables = {}) {
    const absl::Status status =
        stages_.engine.CheckRequest({RunRequest::Kind::kStart, "W", std::move(variables)}, &stages_.robots);
    if (!status.ok()) {
      EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    }
    return std::string(status.message());
  }
};

TEST_F(RunStartTest, WhatTheActivatorGivesAndTheFlowTellsIsAskedFor) {
  DeployChosen("<ext:tell>$user w:goesTo $place</ext:tell>");
  EXPECT_THAT(Asks(),
              HasSubstr("a run of flow F needs a value of $user and $place; docent run W --var user=…"));
  EXPECT_THAT(Asks({{"user", test::Iri("John")}}), HasSubstr("a value of $place;"));
  EXPECT_EQ(Asks({{"user", test::Iri("John")}, {"place", test::Iri("Hall")}}), "");
  EXPECT_THAT(Said(Must(Tell({Fact("John", "chose", "Hall")}))), Contains("F-1 running>done: "));
}

TEST_F(RunStartTest, SoIsAnInputOfWhatItInvokes) {
  std::vector<TermQuad> facts = test::FreeRobots({"R1"}, "drive");
  for (TermQuad fact : {Fact("urn:docent:operation:drive", "docent:input", Term::Literal("place")),
                        Fact("urn:docent:operation:drive", "docent:inputsKnown", Term::Boolean(true))}) {
    fact.graph = test::Iri("R1");
    facts.push_back(fact);
  }
  Must(Tell(facts));
  DeployChosen("<invoke operation=\"drive\"/>");
  const std::string asked = Asks();
  if (!asked.empty()) {
    EXPECT_THAT(asked, HasSubstr("a value of $place;"));
  }
  DeployChosen(
      "<invoke operation=\"drive\"><ext:input part=\"place\" expression=\"&lt;urn:w:Hall&gt;\"/></invoke>");
  EXPECT_EQ(Asks(), "");
}

TEST_F(RunStartTest, WhatTheFlowFindsItselfIsNotAskedFor) {
  DeployChosen(When("$user", "w:isAt", "?place") + "<ext:tell>$user w:goesTo $place</ext:tell>");
  EXPECT_EQ(Asks(), "") << "a $name without a value is matched";
  DeployChosen(
      "<ext:assign>SELECT ?place WHERE { ?place a w:Hall }</ext:assign><ext:tell>w:it w:goesTo "
      "$place</ext:tell>");
  EXPECT_EQ(Asks(), "");
  DeployChosen("<ext:tell>$user w:goesTo w:Hall</ext:tell>",
               "<variable name=\"other\"><initialize><from expression='\"x\"'/></initialize></variable>");
  EXPECT_THAT(Asks(), HasSubstr("a value of $user;"));
  DeployChosen("");
  EXPECT_EQ(Asks(), "");
}

TEST_F(RunStartTest, ARequiredVariableHasAValueWhoeverStartsTheRun) {
  DeployChosen("", "<variable name=\"floor\" ext:required=\"true\"/>");
  EXPECT_THAT(Asks(), HasSubstr("a run of flow F needs a value of $floor"));
  EXPECT_EQ(Asks({{"floor", Term::Integer(2)}}), "");
  EXPECT_THAT(Said(Must(Tell({Fact("John", "chose", "Hall")}))),
              Contains("F-1 running>failed: a run of flow F needs a value of $floor"));
  DeployChosen("",
               "<variable name=\"floor\" ext:required=\"true\"><initialize><from "
               "expression=\"1\"/></initialize></variable>");
  EXPECT_EQ(Asks(), "") << "it has one from its beginning on";
}

TEST_F(RunStartTest, ASubFlowWithoutItFails) {
  Must(Put(Document::Kind::kCawl, "w.xml",
           "<CAWL name=\"W\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F\"><source "
           "name=\"s\"/><node name=\"N\"><invoke subflow=\"G\"/></node><sink name=\"e\"/><link from=\"s\" "
           "to=\"N\"/><link from=\"N\" to=\"e\"/></flow><flow name=\"G\"><variable name=\"floor\" "
           "ext:required=\"true\"/><source name=\"s\"/><node name=\"N\"/><sink name=\"e\"/><link from=\"s\" "
           "to=\"N\"/><link from=\"N\" to=\"e\"/></flow></CAWL>"));
  EXPECT_THAT(Said(Run()),
              Contains("F-1 running>failed: node N: subflow G-2: a run of flow G needs a value of "
                       "$floor"));
  EXPECT_THAT(Said(Run({{"floor", Term::Integer(2)}})), Contains("F-3 running>done: "));
}

}  // namespace
}  // namespace docent::server
