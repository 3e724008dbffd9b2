// Variables that nodes set from a SELECT or an expression.
#include <string>
#include <vector>

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
using ::testing::Not;

using RunAssignments = RunActionsTest;

Term Integer(int64_t value) {
  return Term::Integer(value);
}

// What the run's variables became stands in the graph.
constexpr char kTellXY[] = "<ext:tell>w:out w:x $x</ext:tell>";

TEST_F(RunAssignments, ASelectSetsTheVariablesOfItsColumns) {
  Must(Tell({Fact("it", "p", "b"), Fact("it", "q", Integer(7))}));
  DeployOne(
      "<ext:assign>SELECT ?x ?y WHERE { w:it w:p ?x ; w:q ?y }</ext:assign><ext:tell>$x w:is $y</ext:tell>");
  const TurnResult turn = Run();
  EXPECT_TRUE(Has(Fact("b", "is", Integer(7))));
  EXPECT_THAT(Said(turn), Contains("F-1/A running>running: assigned x = <urn:w:b>, y = 7"));
}

TEST_F(RunAssignments, ARunThatItEndsBeginsNoOtherNode) {
  Deploy(
      "<node name=\"A\"><ext:assign>SELECT ?x WHERE { ?x w:none ?x }</ext:assign></node><node name=\"B\">" +
          When("w:it", "w:p", "?y") + "</node>",
      {}, "",
      "<link from=\"s\" to=\"A\"/><link from=\"s\" to=\"B\"/><link from=\"A\" to=\"e\"/><link from=\"B\" "
      "to=\"e\"/>");
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn), Contains(HasSubstr("F-1 running>failed")));
  EXPECT_THAT(Said(turn), Not(Contains(HasSubstr("F-1/B"))));
}

TEST_F(RunAssignments, OfSeveralSolutionsTheFirstInTermOrderCounts) {
  Must(Tell({Fact("it", "p", "c"), Fact("it", "p", "b"), Fact("it", "p", Integer(1))}));
  DeployOne(std::string("<ext:assign>SELECT ?x WHERE { w:it w:p ?x }</ext:assign>") + kTellXY);
  Run();
  EXPECT_TRUE(Has(Fact("out", "x", "b")));
}

TEST_F(RunAssignments, TheOrderOfAPartIsNotThatOfTheWhole) {
  Must(Tell({Fact("it", "p", "b"), Fact("it", "p", "c"), Fact("b", "q", "b"), Fact("c", "q", "c")}));
  DeployOne(std::string(
                "<ext:assign>SELECT ?x WHERE { { SELECT ?x WHERE { w:it w:p ?x } ORDER BY DESC(?x) } ?x w:q "
                "?any }</ext:assign>") +
            kTellXY);
  Run();
  EXPECT_TRUE(Has(Fact("out", "x", "b")));
}

TEST_F(RunAssignments, OrOfOrderBy) {
  Must(Tell({Fact("it", "p", Integer(2)), Fact("it", "p", Integer(10))}));
  DeployOne(std::string("<ext:assign>SELECT ?x WHERE { w:it w:p ?x } ORDER BY DESC(?x)</ext:assign>") +
            kTellXY);
  Run();
  EXPECT_TRUE(Has(Fact("out", "x", Integer(10))));
}

TEST_F(RunAssignments, AnExpressionHasTheValuesOfTheRun) {
  Deploy(
      "<node name=\"A\"><ext:assign variable=\"x\" expression=\"$y + 1\"/></node>"
      "<node name=\"B\"><ext:assign variable=\"y\" expression=\"CONCAT(STR($x), '!')\"/><ext:tell>w:out w:x "
      "$x\nw:out w:y $y</ext:tell></node>",
      {"A", "B"});
  Run({{"y", Integer(41)}});
  EXPECT_TRUE(Has(Fact("out", "x", Integer(42))));
  EXPECT_TRUE(Has(Fact("out", "y", Term::Literal("42!"))));
}

TEST_F(RunAssignments, AValueIsATermAndNoTextOfTheQuery) {
  const Term evil = Term::Literal("\" } UNION { ?s ?p ?x } #");
  Must(Tell({Fact("it", "p", evil), Fact("b", "p", Term::Literal("other"))}));
  DeployOne("<ext:assign>SELECT ?x WHERE { ?x w:p $y }</ext:assign>" + std::string(kTellXY));
  Run({{"y", evil}});
  EXPECT_TRUE(Has(Fact("out", "x", "it")));
}

TEST_F(RunAssignments, ABlankNodeAndTaggedTextAreValues) {
  Must(Tell({{Term::Blank("b1"), test::Iri("p"), Term::LangString("Gruß", "de"), Term()},
             {Term::Blank("b2"), test::Iri("p"), Term::LangString("Gruß", "en"), Term()}}));
  Deploy(
      "<node name=\"A\"><ext:assign>SELECT ?x WHERE { ?x w:p ?t FILTER(LANG(?t) = 'de') }</ext:assign></node>"
      "<node name=\"B\"><ext:assign>SELECT ?y WHERE { $x w:p ?y }</ext:assign><ext:tell>w:out w:y "
      "$y</ext:tell></node>",
      {"A", "B"});
  Run();
  EXPECT_TRUE(Has(Fact("out", "y", Term::LangString("Gruß", "de"))));
}

TEST_F(RunAssignments, NaNIsANumberOfDouble) {
  DeployOne("<ext:assign variable=\"x\" expression=\"'NaN'^^xsd:double\"/>" + std::string(kTellXY));
  Run();
  EXPECT_TRUE(Has(Fact("out", "x", Term::Literal("NaN", std::string(kXsdNs) + "double"))));
}

TEST_F(RunAssignments, ATextIsAsLongAsATermMayBe) {
  DeployOne("<ext:assign variable=\"x\" expression=\"CONCAT($y, $y)\"/>");
  EXPECT_THAT(
      Said(Run({{"y", Term::Literal(std::string(600000, 'y'))}})),
      Contains(HasSubstr("variable x: the literal has 1200000 bytes, the limit term_bytes is 1048576")));
}

TEST_F(RunAssignments, WithoutASolutionTheNodeFails) {
  DeployOne("<ext:assign>SELECT ?x WHERE { w:it w:p ?x }</ext:assign>");
  EXPECT_THAT(Said(Run()), Contains("F-1/A running>failed: it cannot assign: the SELECT has no solution"));
}

TEST_F(RunAssignments, OrTheVariableIsUnset) {
  DeployOne("<ext:assign none=\"unset\">SELECT ?x WHERE { w:it w:p ?x }</ext:assign>" + std::string(kTellXY));
  EXPECT_THAT(Said(Run({{"x", Integer(1)}})), Contains(HasSubstr("variable $x has no value")));
}

TEST_F(RunAssignments, OrItHasTheDefault) {
  DeployOne("<ext:assign default=\"w:nobody\">SELECT ?x WHERE { w:it w:p ?x }</ext:assign>" +
            std::string(kTellXY));
  Run();
  EXPECT_TRUE(Has(Fact("out", "x", "nobody")));
}

TEST_F(RunAssignments, AnExpressionWithoutAValueFailsTheNode) {
  DeployOne("<ext:assign variable=\"x\" expression=\"$y + 1\"/>");
  EXPECT_THAT(Said(Run({{"y", Term::Literal("text")}})),
              Contains(HasSubstr("there is no value for variable x")));
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("it cannot assign: variable $y has no value")));
}

TEST_F(RunAssignments, WhatTheRunToldBeforeIsSeenWithWhatRulesDerive) {
  Must(Put(Document::Kind::kRules, "r.rules",
           "PREFIX w: <urn:w:>\nRULE { ?a w:knows ?b } WHERE { ?a w:met ?b }"));
  DeployOne(
      "<ext:tell>w:it w:met w:b</ext:tell><ext:assign>SELECT ?x WHERE { w:it w:knows ?x }</ext:assign>" +
      std::string(kTellXY));
  Run();
  EXPECT_TRUE(Has(Fact("out", "x", "b")));
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
}

TEST_F(RunAssignments, AValueOfAnotherTypeThanDeclaredFailsTheNode) {
  const std::string n =
      "<variable name=\"n\" type=\"xsd:integer\"/><variable name=\"c\" type=\"docent:Robot\"/>";
  Deploy("<node name=\"A\"><ext:assign variable=\"n\" expression=\"'7'\"/></node>", {"A"}, n);
  EXPECT_THAT(Said(Run()), Contains("F-1/A running>failed: it cannot assign: $n is of type "
                                    "xsd:integer, and \"7\" is of type xsd:string"));
  Deploy("<node name=\"A\"><ext:assign variable=\"c\" expression=\"7\"/></node>", {"A"}, n);
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("$c is of type docent:Robot, and 7 is a literal")));
  Deploy("<node name=\"A\"><ext:assign variable=\"n\" expression=\"7\"/></node>", {"A"}, n);
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("running>done")));
}

TEST_F(RunAssignments, ForEachOfTheNextNodeTakesEverySolution) {
  Must(Tell({Fact("it", "p", "b"), Fact("it", "p", "c"), Fact("it", "p", "d")}));
  Deploy(
      "<node name=\"A\"><ext:assign>SELECT ?x WHERE { w:it w:p ?x }</ext:assign></node>"
      "<node name=\"B\" ext:forEach=\"?x\"><ext:tell>$x w:seen true</ext:tell></node>",
      {"A", "B"});
  Run();
  for (const char* thing : {"b", "c", "d"})
    EXPECT_TRUE(Has(Fact(thing, "seen", Term::Boolean(true)))) << thing;
}

TEST_F(RunAssignments, ForEachOfTooManyPairsTellsNothing) {
  WriteBatch many = Tell({});
  for (int i = 0; i < 101; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact("it", "p", absl::StrCat("n", i))});
  Must(many);
  const auto deploy = [this](const std::string& second) {
    Deploy(
        "<node name=\"A\"><ext:assign>SELECT ?x WHERE { w:it w:p ?x }</ext:assign></node><node "
        "name=\"B\"><ext:assign>" +
            second +
            "</ext:assign></node><node name=\"C\" ext:forEach=\"?x ?y\"><ext:tell>$x w:met "
            "$y</ext:tell></node>",
        {"A", "B", "C"});
  };
  deploy("SELECT ?y WHERE { w:it w:p ?y }");  // 101 times 101, without an invoke
  EXPECT_THAT(Said(Run()),
              Contains(HasSubstr("F-1/C running>failed: ext:forEach has more than 10000 matches")));
  EXPECT_FALSE(Has(Fact("n1", "met", "n2")));
  deploy("SELECT ?y WHERE { w:it w:p ?y } LIMIT 99");
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("running>done")));
}

TEST_F(RunAssignments, ForEachOfNoSolutionIsDoneAtOnce) {
  Deploy(
      "<node name=\"A\"><ext:assign none=\"unset\">SELECT ?x WHERE { w:it w:p ?x }</ext:assign></node>"
      "<node name=\"B\" ext:forEach=\"?x\"><ext:tell>$x w:seen true</ext:tell><invoke "
      "operation=\"greet\"/></node>",
      {"A", "B"});
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn), Contains(HasSubstr("F-1 running>done")));
}

#ifndef __SANITIZE_THREAD__  // it would take minutes
TEST_F(RunAssignments, ASelectThatTakesTooLongFailsTheNodeAndNotTheTurn) {
  WriteBatch many = Tell({});
  for (int i = 0; i < 400; ++i)
    many.operations.push_back(
        {QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "p", absl::StrCat("m", i))});
  Must(many);
  DeployOne(
      "<ext:assign>SELECT (COUNT(*) AS ?x) WHERE { ?a w:p ?b . ?c w:p ?d . ?e w:p ?f . ?g w:p ?h "
      "}</ext:assign>");
  const TurnResult turn = Run();
  EXPECT_THAT(Said(turn),
              Contains(HasSubstr("F-1/A running>failed: it cannot assign: its query takes too long: it was "
                                 "stopped after 20000000 steps; the limit assign_steps is 20000000")));
}
#endif

// Two million rows to be sorted, which takes few steps a row.
TEST_F(RunAssignments, ASelectThatNeedsTooMuchMemoryNamesTheLimitOfAssignments) {
  WriteBatch many = Tell({});
  for (int i = 0; i < 1500; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "p", "m")});
  Must(many);
  DeployOne("<ext:assign>SELECT ?x WHERE { ?x w:p ?a . ?y w:p ?b } ORDER BY ?y ?x ?a ?b</ext:assign>");
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("the limit assign_memory_bytes is 67108864")));
}

TEST_F(RunAssignments, MoreSolutionsThanTheLimitFailTheNode) {
  WriteBatch many = Tell({});
  for (int i = 0; i < 10001; ++i)
    many.operations.push_back({QuadOperation::Kind::kAdd, Fact(absl::StrCat("n", i), "p", "m")});
  Must(many);
  DeployOne("<ext:assign>SELECT ?x WHERE { ?x w:p w:m }</ext:assign>");
  EXPECT_THAT(Said(Run()),
              Contains(HasSubstr("its SELECT has more than 10000 solutions; the limit is assign_solutions")));
  Must(Tell({}, {Fact("n0", "p", "m")}));
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("F-2 running>done")));
}

TEST_F(RunAssignments, TheSameSeedGivesTheSameRandomValues) {
  DeployOne("<ext:assign variable=\"x\" expression=\"RAND()\"/>" + std::string(kTellXY));
  EXPECT_THAT(Said(Run()), Contains(HasSubstr("F-1 running>done")));
}

}  // namespace
}  // namespace docent::server
