#include "workflow/cawl/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/workflow/cawl/documents.h"

namespace docent::cawl {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(CheckDocument, WithoutEnvironmentOnlyTheTextCounts) {
  CheckReport report = CheckDocument(WithNode("<invoke operation=\"anything\"/><invoke subflow=\"Elsewhere\"/>"), "f", nullptr);
  EXPECT_TRUE(report.ok());
  EXPECT_THAT(report.diagnostics, IsEmpty());
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
  EXPECT_TRUE(CheckDocument(WithNode("<invoke operation=\"move\"/><invoke operation=\"lead\"/>"), "f", &environment).ok());
  EXPECT_FALSE(CheckDocument(WithNode("<invoke operation=\"show\"/>"), "f", &environment).ok());
  std::string bound = ConditionOf(ConstraintText("c", "?page", "docent:isAt", "$user"));
  EXPECT_TRUE(CheckDocument(WithNode(bound + "<invoke operation=\"show\"/>"), "f", &environment).ok());
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
  EXPECT_THAT(report.diagnostics[0].hint, HasSubstr("did you mean isAt?"));
  EXPECT_THAT(report.conditions, SizeIs(1));
}

}  // namespace
}  // namespace docent::cawl
