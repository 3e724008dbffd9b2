#include "workflow/cawl/check/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/vocabulary.h"
#include "tests/workflow/cawl/documents.h"
#include "workflow/cawl/parser.h"

namespace docent::cawl {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(CheckDocument, WithoutEnvironmentOnlyTheTextCounts) {
  CheckReport report = CheckDocument(
      WithNode("<invoke operation=\"anything\"/><invoke subflow=\"Elsewhere\"/>"), "f", nullptr);
  EXPECT_TRUE(report.ok());
  EXPECT_THAT(report.diagnostics, IsEmpty());
}

TEST(CheckDocument, AFreeNameThatTheRunHasIsWorthAWarning) {
  const auto document = [](const std::string& activator, const std::string& variable,
                           const std::string& node) {
    return "<CAWL name=\"D\" xmlns:expo=\"https://w3id.org/docent/expo#\"><activator name=\"a\"><activate "
           "flow=\"F\"/>" +
           ConditionOf(ConstraintText("c", activator, "docent:isAt", "expo:door")) +
           "</activator><flow name=\"F\">" + variable + "<source name=\"s\"/><node name=\"n\">" +
           ConditionOf(ConstraintText("c", node, "docent:isAt", "expo:B03")) +
           "</node><sink name=\"t\"/><link from=\"s\" to=\"n\"/><link from=\"n\" to=\"t\"/></flow></CAWL>";
  };
  const std::string declared = "<variable name=\"v\"/>";
  const std::string text = document("?v", declared, "?v");
  const CheckReport report = CheckDocument(text, "f", nullptr);
  EXPECT_TRUE(report.ok()) << "it may be meant";
  ASSERT_THAT(report.diagnostics, SizeIs(1));
  EXPECT_THAT(report.diagnostics[0].message,
              HasSubstr("?v may match another value than the one that the activator bound"));
  EXPECT_EQ(report.diagnostics[0].hint, "write $v for the run's own");
  EXPECT_EQ(report.diagnostics[0].span.offset, text.rfind("?v"));
  EXPECT_THAT(CheckDocument(document("?v", "", "?v"), "f", nullptr).diagnostics[0].hint,
              HasSubstr("<variable name=\"v\"/> in the flow"));
  EXPECT_THAT(CheckDocument(document("?v", declared, "$v"), "f", nullptr).diagnostics, IsEmpty());
  EXPECT_THAT(CheckDocument(document("?v", declared, "?robot"), "f", nullptr).diagnostics, IsEmpty());
  const std::string begun =
      "<variable name=\"w\"><initialize><from expression=\"expo:R01\"/></initialize></variable>";
  EXPECT_THAT(CheckDocument(document("?v", begun, "?w"), "f", nullptr).diagnostics, SizeIs(1));
}

TEST(CheckDocument, InputTypesAreThoseInWhichTheOperationsOfAClassAgree) {
  const std::string speech = "https://w3id.org/docent#SpeechSynthesis", text_type = Concat(kXsdNs, "string"),
                    number = Concat(kXsdNs, "integer");
  const std::string document =
      "<CAWL name=\"D\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F\"><variable "
      "name=\"text\" "
      "type=\"xsd:integer\"/><variable name=\"times\" type=\"xsd:string\"/><source name=\"s\"/><node "
      "name=\"n\"><invoke ext:capability=\"docent:SpeechSynthesis\"/></node><sink name=\"t\"/><link "
      "from=\"s\" "
      "to=\"n\"/><link from=\"n\" to=\"t\"/></flow></CAWL>";
  QuadEnvironment environment;
  environment.AddDescribed({"say", {speech}, {{"text", text_type}, {"times", number}}});
  CheckReport report = CheckDocument(document, "f", &environment);
  ASSERT_THAT(report.diagnostics, SizeIs(2));
  EXPECT_EQ(
      report.diagnostics[0].message,
      "each operation of class docent:SpeechSynthesis takes text of xsd:string, and variable text is of "
      "xsd:integer");
  environment.AddDescribed({"talk", {speech}, {{"text", text_type}, {"times", text_type}}});
  report = CheckDocument(document, "f", &environment);
  ASSERT_THAT(report.diagnostics, SizeIs(1)) << "of the times they do not agree";
  EXPECT_EQ(report.diagnostics[0].rule, "type-clash");
  environment.AddDescribed({"hum", {speech}, {}});
  EXPECT_THAT(CheckDocument(document, "f", &environment).diagnostics, IsEmpty());
}

// A limit of new texts: those of a log are parsed again when it is replayed.
TEST(CheckDocument, AFlowHasSoManyNodes) {
  const auto chain = [](size_t nodes) {
    std::string text = "<CAWL name=\"D\"><flow name=\"F\"><source name=\"s\"/>",
                links = "<link from=\"s\" to=\"n0\"/>";
    for (size_t i = 0; i < nodes; ++i) {
      const std::string name = absl::StrCat("n", i);
      absl::StrAppend(&text, "<node name=\"", name, "\"/>");
      absl::StrAppend(&links, "<link from=\"", name, "\" to=\"",
                      i + 1 < nodes ? absl::StrCat("n", i + 1) : "t", "\"/>");
    }
    return absl::StrCat(text, "<sink name=\"t\"/>", links, "</flow></CAWL>");
  };
  EXPECT_TRUE(CheckDocument(chain(kWorkflowLimits.flow_nodes), "f", nullptr).ok());
  const std::string text = chain(kWorkflowLimits.flow_nodes + 1);
  const CheckReport report = CheckDocument(text, "f", nullptr);
  ASSERT_FALSE(report.ok());
  ASSERT_THAT(report.diagnostics, SizeIs(1));
  EXPECT_EQ(report.diagnostics[0].message, "flow F has 4001 nodes; the limit flow_nodes is 4000");
  EXPECT_EQ(report.diagnostics[0].span.offset, text.find("F\""));
  EXPECT_TRUE(ParseCawl(text, "f").ok());
}

TEST(CheckDocument, AnEmptyEnvironmentOffersNothing) {
  QuadEnvironment environment;
  std::string text = WithNode("<invoke operation=\"anything\"/>");
  CheckReport report = CheckDocument(text, "f", &environment);
  ASSERT_THAT(report.diagnostics, SizeIs(1));
  EXPECT_THAT(report.diagnostics[0].hint, HasSubstr("no robot offers anything"));
  EXPECT_EQ(text.substr(report.diagnostics[0].span.offset, report.diagnostics[0].span.length), "anything");
  EXPECT_THAT(report.conditions, IsEmpty());
}

TEST(CheckDocument, InputsOfUnknownShapeAreNotChecked) {
  QuadEnvironment environment;
  environment.AddOperation({"move", {}, false});
  environment.AddOperation({"lead", {"user"}, true});
  environment.AddOperation({"show", {"page"}, true});
  EXPECT_TRUE(
      CheckDocument(WithNode("<invoke operation=\"move\"/><invoke operation=\"lead\"/>"), "f", &environment)
          .ok());
  EXPECT_FALSE(CheckDocument(WithNode("<invoke operation=\"show\"/>"), "f", &environment).ok());
  std::string bound = ConditionOf(ConstraintText("c", "?page", "docent:isAt", "$user"));
  EXPECT_TRUE(CheckDocument(WithNode(bound + "<invoke operation=\"show\"/>"), "f", &environment).ok());
}

// What the results of a robot's own operation are may be described or not: a later node may use any.
TEST(CheckDocument, ARobotsOperationMayGiveWhatIsNotDescribed) {
  const std::string text =
      "<CAWL name=\"D\"><flow name=\"F\"><variable name=\"level\"/><source name=\"s\"/>"
      "<node name=\"a\"><invoke operation=\"measure\"/></node>"
      "<node name=\"b\"><invoke operation=\"show\"/></node><sink name=\"t\"/><link from=\"s\" to=\"a\"/>"
      "<link from=\"a\" to=\"b\"/><link from=\"b\" to=\"t\"/></flow></CAWL>";
  QuadEnvironment environment;
  environment.AddOperation({"show", {"level"}, true});
  OperationSignature measure{"measure", {}, true};
  measure.of_robot = true;
  environment.AddOperation(measure);
  EXPECT_THAT(CheckDocument(text, "f", &environment).diagnostics, IsEmpty());
}

TEST(CheckDocument, WordsOfUndescribedNamespacesAreLeftAlone) {
  QuadEnvironment environment;
  environment.AddOntology({{Term::Iri("https://w3id.org/docent#isAt"),
                            Term::Iri("http://www.w3.org/1999/02/22-rdf-syntax-ns#type"),
                            Term::Iri("http://www.w3.org/2002/07/owl#ObjectProperty"), Term()}});
  std::string text = WithNode(ConditionOf(ConstraintText("a", "?x", "schema:name", "?n") +
                                          ConstraintText("b", "?x", "docent:isAtt", "expo:B03")));
  CheckReport report = CheckDocument(text, "f", &environment);
  EXPECT_TRUE(report.ok()) << "unknown words are warnings";
  ASSERT_THAT(report.diagnostics, SizeIs(1));
  EXPECT_THAT(report.diagnostics[0].hint, HasSubstr("did you mean docent:isAt?"));
  EXPECT_THAT(report.conditions, SizeIs(1));
}

}  // namespace
}  // namespace docent::cawl
