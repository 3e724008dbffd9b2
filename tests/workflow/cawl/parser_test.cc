#include "workflow/cawl/parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/workflow/cawl/documents.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(CawlParser, ReadsTheBoothGuide) {
  std::string text = RepositoryFile("scenarios/s01_booth_guide/booth_guide.cawl.xml");
  ParsedCawl parsed = ParseCawl(text, "booth_guide.cawl.xml");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  EXPECT_THAT(parsed.diagnostics, SizeIs(0));
  const Document& document = *parsed.document;
  EXPECT_EQ(document.name.value, "BoothGuide");
  EXPECT_EQ(document.activator->flow.value, "BoothGuide");
  const Flow& flow = *document.FindFlow("BoothGuide");
  ASSERT_THAT(flow.nodes, SizeIs(3));
  EXPECT_THAT(flow.links, SizeIs(4));
  EXPECT_EQ(flow.nodes[2].name.value, "InfoBooth");
  EXPECT_THAT(flow.nodes[2].invokes, SizeIs(2));
}

TEST(CawlParser, SpansAreTheBytesThatAChangeMustTouch) {
  std::string text = RepositoryFile("scenarios/s01_booth_guide/booth_guide.cawl.xml");
  ParsedCawl parsed = ParseCawl(text, "");
  ASSERT_TRUE(parsed.ok());
  auto bytes = [&](const SourceSpan& span) { return text.substr(span.offset, span.length); };
  const Flow& flow = parsed.document->flows[0];
  EXPECT_EQ(bytes(flow.nodes[1].name.span), "Move2Booth");
  EXPECT_EQ(bytes(flow.links[3].span), "<link from=\"InfoBooth\" to=\"Presented\"/>");
  EXPECT_EQ(bytes(flow.nodes[2].invokes[0].operation.span), "displayInformation");
  const Constraint& constraint = flow.nodes[0].condition->contexts[0].rules[0].constraints[0];
  EXPECT_EQ(bytes(constraint.subject.span), "$robot");
  EXPECT_EQ(bytes(constraint.subject.type.span), "docent:Robot");
  EXPECT_TRUE(bytes(constraint.span).starts_with("<constraint name=\"onStandby\">"));
  EXPECT_TRUE(bytes(constraint.span).ends_with("</constraint>"));
}

TEST(CawlParser, ExtensionsReachTheTree) {
  std::string text = RepositoryFile("tests/golden/cawl/extensions/input.xml");
  ParsedCawl parsed = ParseCawl(text, "");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  const Flow& flow = parsed.document->flows[0];
  const Node& node = flow.nodes[0];
  EXPECT_EQ(node.timeout_ms, 300000);
  EXPECT_EQ(node.retry, 2);
  EXPECT_EQ(node.compensate.value, "goHome");
  EXPECT_THAT(node.for_each, ElementsAre("booth"));
  EXPECT_EQ(node.condition->timeout_ms, 3600000);
  EXPECT_EQ(node.invokes[0].timeout_ms, 30000);
  EXPECT_EQ(node.invokes[0].retry, 1);
  EXPECT_TRUE(flow.links[1].while_constraint.has_value());
  EXPECT_TRUE(flow.links[3].on_failure);
  EXPECT_FALSE(flow.links[2].on_failure);
}

TEST(CawlParser, WordsKnowTheirKind) {
  std::string text = WithNode(ConditionOf(ConstraintText("c", "$user", "a", "&lt; $robot") +
                                          ConstraintText("d", "&lt;urn:x>", "?v", "!= \"a b\"@en")));
  ParsedCawl parsed = ParseCawl(text, "");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  const auto& constraints = parsed.document->flows[0].nodes[0].condition->contexts[0].rules[0].constraints;
  EXPECT_EQ(constraints[0].subject.kind, Word::Kind::kVariable);
  EXPECT_EQ(constraints[0].subject.name, "user");
  EXPECT_EQ(constraints[0].verb.term.lexical, "http://www.w3.org/1999/02/22-rdf-syntax-ns#type");
  EXPECT_EQ(constraints[0].object.comparison, Word::Comparison::kLess);
  EXPECT_EQ(text.substr(constraints[0].object.span.offset, constraints[0].object.span.length), "$robot");
  EXPECT_EQ(constraints[1].subject.term, Term::Iri("urn:x"));
  EXPECT_EQ(constraints[1].verb.kind, Word::Kind::kFree);
  EXPECT_EQ(constraints[1].object.comparison, Word::Comparison::kNotEqual);
  EXPECT_EQ(constraints[1].object.term, Term::LangString("a b", "en"));
}

TEST(CawlParser, AllMistakesAreToldInOrderOfTheText) {
  ParsedCawl parsed = ParseCawl(RepositoryFile("tests/golden/cawl/names/input.xml"), "f");
  EXPECT_FALSE(parsed.ok());
  ASSERT_GT(parsed.diagnostics.size(), 10u);
  for (size_t i = 1; i < parsed.diagnostics.size(); ++i) {
    EXPECT_LE(parsed.diagnostics[i - 1].span.offset, parsed.diagnostics[i].span.offset);
  }
}

TEST(CawlParser, ManyMistakesAreCounted) {
  std::string nodes;
  for (int i = 0; i < 1000; ++i) nodes += "<unknown/>";
  ParsedCawl parsed = ParseCawl("<CAWL name=\"A\">" + nodes + "</CAWL>", "f");
  ASSERT_THAT(parsed.diagnostics, SizeIs(xml::ElementReader::kMaxDiagnostics + 1));
  EXPECT_THAT(parsed.diagnostics.back().message, HasSubstr("further mistakes"));
}

// What is only a warning hides no error, and makes none.
TEST(CawlParser, ManyWarningsHideNoMistake) {
  const size_t most = xml::ElementReader::kMaxDiagnostics;
  const std::string text = "<CAWL name=\"A\"/>", file = "f";
  xml::ElementReader reader(text, file, "urn:x");
  for (size_t i = 0; i < most + 3; ++i) reader.Warning(reader.Span(0, 1), "doubtful");
  EXPECT_TRUE(reader.full(Diagnostic::Severity::kWarning));
  EXPECT_FALSE(reader.full(Diagnostic::Severity::kError));
  reader.Error(reader.Span(1, 1), "wrong");
  const Diagnostics told = reader.TakeDiagnostics();
  ASSERT_THAT(told, SizeIs(most + 2));
  EXPECT_EQ(told[most].message, "wrong");
  EXPECT_EQ(told[most + 1].message, "3 further warnings are not shown");

  for (size_t i = 0; i < most + 3; ++i) reader.Warning(reader.Span(0, 1), "doubtful");
  EXPECT_FALSE(HasErrors(reader.TakeDiagnostics()));
}

TEST(CawlParser, AnotherRootIsRefused) {
  ParsedCawl parsed = ParseCawl("<rsel name=\"A\"/>", "f");
  EXPECT_EQ(parsed.document, nullptr);
  ASSERT_THAT(parsed.diagnostics, SizeIs(1));
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("not a CAWL document"));
}

TEST(CawlParser, NestingOfExpressionsIsLimited) {
  Limits limits;
  limits.query_nesting = 10;
  auto nested = [](int depth) {
    return WithNode(ConditionOf(ConstraintText("c", "?a", "?b", "?c"),
                                std::string(depth, '(') + "c" + std::string(depth, ')')));
  };
  EXPECT_TRUE(ParseCawl(nested(10), "f", limits).ok());
  ParsedCawl deep = ParseCawl(nested(11), "f", limits);
  ASSERT_FALSE(deep.ok());
  EXPECT_THAT(deep.diagnostics[0].message, HasSubstr("query_nesting"));
}

TEST(SymbolTable, InnerScopesSeeOuterOnes) {
  std::string text = RepositoryFile("tests/golden/cawl/messages_good/input.xml");
  ParsedCawl parsed = ParseCawl(text, "");
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  Scope cawl(*parsed.document);
  Scope flow(cawl, parsed.document->flows[0]);
  Scope node(flow, parsed.document->flows[0].nodes[0]);
  ASSERT_NE(node.FindVariable("request"), nullptr);
  EXPECT_EQ(cawl.FindVariable("request"), nullptr);
  EXPECT_THAT(node.Keys(*node.FindVariable("request")), ElementsAre("request.user", "request.booth"));
  EXPECT_THAT(node.Keys(*node.FindVariable("booth")), ElementsAre("booth"));
  std::vector<InitialValue> values = InitialValues(flow);
  ASSERT_THAT(values, SizeIs(3));
  EXPECT_EQ(values[0].key, "request.booth");
  EXPECT_EQ(values[0].value, Term::Iri("https://w3id.org/docent/expo#B03"));
  EXPECT_EQ(values[1].key, "booth");
  EXPECT_EQ(values[1].copy_of, "request.booth");
}

}  // namespace
}  // namespace docent::cawl
